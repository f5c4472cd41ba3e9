# Included by the makefile above.
# make options-reference   the list of options/README.md, from ./isph -options_json
.PHONY: options-reference

# options/README.md: the list of all options, from ./isph -options_json
options-reference: isph
	@$(PYTHON) tests/docs/options.py --write
