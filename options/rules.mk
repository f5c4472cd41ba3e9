# Included by the makefile above.
# make options-reference   the list of options/README.md, from ./isph -help
.PHONY: options-reference

# options/README.md: the list of all options, from ./isph -help
options-reference: isph
	@$(PYTHON) tests/docs/options.py --write
