# What takes hours. Included by the makefile above.
.PHONY: long-run

# make long-run   a million steps of a small scene: nothing drifts
long-run: isph
	@$(PYTHON) tests/long/long_run.py 1000000
