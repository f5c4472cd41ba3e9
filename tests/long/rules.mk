# What takes hours. Included by the makefile above.
.PHONY: long-run roundings

# make roundings  whether a verdict hangs on rounding: other instructions, optimisation, seeds of packings; FLAGS=v2
# make long-run   a million steps of a small scene: nothing drifts
long-run: isph
	@$(PYTHON) tests/long/long_run.py 1000000

roundings: programs
	@set -f; $(PYTHON) tests/long/roundings.py $$FLAGS
