# Included by the makefile above.
# make options-reference   the list of options/README.md, from ./isph -options_json
# make deb                 a Debian package of what make install installs, for any processor: output/deb/isph_*.deb;
#                          apt install ./output/deb/isph_*.deb installs it
.PHONY: options-reference deb

# options/README.md: the list of all options, from ./isph -options_json
options-reference: isph
	@$(PYTHON) tests/docs/options.py --write

# PORTABLE= and BUILD=output/build take the build that is there: the package is then for this processor.
DEB       = output/deb
DEB_BUILD = $(if $(filter command line,$(origin BUILD)),,BUILD=$(DEB)/build PROGRAM=$(DEB)/program)
deb:
	rm -rf $(DEB)/root $(DEB)/debian
	$(MAKE) -j"$$JOBS" $(DEB_BUILD) PORTABLE=$(if $(filter command line,$(origin PORTABLE)),$(PORTABLE),1) install \
	  DESTDIR=$(abspath $(DEB))/root PREFIX=/usr
	options/deb.sh $(DEB)
