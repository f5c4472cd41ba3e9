# The physics: cases/ against exact solutions. Included by the makefile above.
# make verify, verify-long   the cases against exact solutions; CASE=couette, JOBS=1, FROM="ID=FOLDER ..."
# make convergence           a case at several spacings; writes its results.md; CASE=couette
# make verify-readme         the tables of cases/*/results.md from the last runs, and the figures that READMEs quote
# make reference             the volume-of-fluid computations that some checks compare with, anew (gerris); CASE=thin_film
.PHONY: verify verify-long convergence verify-readme reference

VERIFY = $(MPI) $(PYTHON) tests/verify/runner.py
CASE   =
FROM   =
EACH_FROM = set -f; for from in $$FROM; do set -- "$$@" --from "$$from"; done

# FROM="ID=FOLDER ...": judge runs that exist instead of running these entries; IDs: tests/verify/runner.py --list
verify: isph
	@$(EACH_FROM); $(VERIFY) --size short --case="$$CASE" --jobs "$$JOBS" "$$@"

verify-long: isph
	@$(EACH_FROM); $(VERIFY) --size long --case="$$CASE" --jobs "$$JOBS" "$$@"

convergence: isph
	@$(EACH_FROM); $(VERIFY) --convergence --case="$$CASE" --jobs "$$JOBS" "$$@"

verify-readme:
	@$(VERIFY) --readme
	@$(PYTHON) tests/lint/figures.py --mend > /dev/null; $(PYTHON) tests/lint/figures.py

# Independent computations by volume of fluid that the checks read, cases/*/reference*.csv: ten minutes each; Debian's gerris
reference:
	@tests/packages.sh reference
	@set -f; $(PYTHON) tests/verify/reference.py $$CASE
