# Speed: tables of the step and of whole results. Included by the makefile above.
# make bench           16 k and 128 k particles, SIZE=full: 1 M too; other scenes and builds
# make bench-results   what a result costs: time and error of the impact computed in other ways; FLAGS=--all: the slow ones too
# make bench-counts    messages, bytes and collectives of a step on 1 to 32 ranks; FLAGS=--readme: the table
# make bench-readme    the tables of tests/bench/README.md
.PHONY: bench bench-counts bench-readme bench-results

# Speed of the step over sizes, ranks, states and preconditioners, each event beside what the machine can do, then other
# scenes and builds: tables and chart in output/bench/.
SIZE = quick
bench: isph
	@$(PYTHON) tests/bench/bench.py --size "$$SIZE"
	@$(PYTHON) tests/bench/variants.py
	@$(PYTHON) tests/bench/events.py

bench-readme:
	@$(PYTHON) tests/bench/bench.py --readme
	@$(PYTHON) tests/bench/variants.py --readme
	@$(PYTHON) tests/bench/events.py --readme

# Processor time and errors of the whole impact in different ways, into output/bench_results/, five minutes of one core;
# FLAGS=--all: the slow ones too; FLAGS=--readme: puts the last table into tests/bench/README.md
bench-results: isph
	@set -f; $(PYTHON) tests/bench/results.py $$FLAGS

bench-counts: isph
	@$(PYTHON) tests/bench/counts.py $$FLAGS
