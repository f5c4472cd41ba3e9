# How right the bars of make answer are. Included by the makefile above.
# make coverage   how often they contain a value that is known; writes the table of tests/answers/README.md; CASE=sessile
.PHONY: coverage

coverage: isph
	@$(MPI) $(PYTHON) tests/answers/coverage.py --case="$$CASE" $(if $(CASE),,--readme)
