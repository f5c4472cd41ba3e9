# Whether the tests notice. Included by the makefile above.
# make mutants          small bugs put in one at a time: which ones the tests see; MUTANT=NAME, JOBS=1
# make mutants-readme   the table of tests/mutants/README.md from the last run
.PHONY: mutants mutants-readme

# Small bugs put into a copy of the program one at a time: which ones make test sees; mutants-readme: the table of
# tests/mutants/README.md from the last run of all. MUTANT="pressure growth_limit": those of a file, folder or name
MUTANT =
mutants: isph $(UNIT)
	@set -f; $(PYTHON) tests/mutants/mutants.py --jobs "$$JOBS" $$MUTANT

mutants-readme:
	@$(PYTHON) tests/mutants/mutants.py --readme
