# A value with its error bar, and studies. Included by the makefile above.
# make answer   a value with its error bar: SCENE=my.opts QUANTITY=crater_depth:max ACCURACY=5 BUDGET=600 JOBS=2
# make study    a table: SCENE=my.opts VARY="drop_velocity=0,-1;0,-2" QUANTITY=highest:max; ACCURACY=5: with bars
# make fit      values of options from a measured curve: SCENE=my.opts CURVE=lab.csv FREE="drop_tension=0.02,0.1"; FLAGS=--help
# make reduce   the scene as rings, a quarter or a half: SCENE=my.opts > reduced.opts
.PHONY: answer study fit reduce

QUANTITY =
VARY     =
answer: isph
	@tests/packages.sh pictures
	@$(MPI) $(PYTHON) src/answers/answer.py "$$SCENE" --quantity="$$QUANTITY" --accuracy="$${ACCURACY:-5}" \
	  --budget="$$BUDGET" --jobs="$$JOBS"

study: isph
	@tests/packages.sh pictures
	@$(MPI) $(PYTHON) src/answers/study.py "$$SCENE" --vary="$$VARY" --quantity="$$QUANTITY" \
	  --accuracy="$${ACCURACY:-0}" --budget="$$BUDGET" --jobs="$$JOBS"

fit: isph
	@tests/packages.sh pictures
	@set -f; $(MPI) $(PYTHON) src/answers/fit.py --jobs="$$JOBS" "$$SCENE" "$$CURVE" "$$FREE" $$FLAGS

reduce:
	@$(MAKE) -s --no-print-directory isph >&2
	@$(MPI) $(PYTHON) src/answers/reduce.py "$$SCENE"
