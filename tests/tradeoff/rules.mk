# What each choice costs. Included by the makefile above.
# make tradeoff          what each choice costs in a scene, and which to take; SCENE=my.opts GAUGES=a,b BUDGET=600 TARGET=5; CASE=central_force
# make tradeoff-steps    what longer and shorter steps cost, with the spread of five packings; CASE="dam"
# make tradeoff-readme   the tables of tests/tradeoff/README.md
.PHONY: tradeoff tradeoff-steps tradeoff-readme

# With SCENE also advice in words and advice.opts. BUDGET=600: CPU seconds for it; TARGET=5: per cent; WAYS="rings.opts": other ways to compute the scene
BUDGET = 600
TARGET = 5
WAYS   =
tradeoff: isph
ifdef SCENE
	@set -f; $(MPI) $(PYTHON) tests/tradeoff/scene.py "$$SCENE" --gauges="$$GAUGES" --budget="$$BUDGET" \
	  --target="$$TARGET" --ways $$WAYS
else
	@$(MPI) $(PYTHON) tests/tradeoff/tradeoff.py --case="$$CASE"
endif

tradeoff-steps: isph
	@$(MPI) $(PYTHON) tests/tradeoff/steps.py --case="$$CASE"

# The table of the case and, once the five scenes have been swept, the summary in tests/tradeoff/README.md.
tradeoff-readme:
	@$(PYTHON) tests/tradeoff/tradeoff.py --case="$$CASE" --readme
	@$(PYTHON) tests/tradeoff/summary.py
