# Limits of scenes, steps, solvers: table and map. Included by the makefile above.
# make extremes          the limits of scenes, steps, solvers: table and map
# make extremes-readme   them in tests/extremes/README.md
.PHONY: extremes extremes-readme

extremes: isph
	@$(PYTHON) tests/extremes/extremes.py --all

extremes-readme:
	@$(PYTHON) tests/extremes/extremes.py --readme
