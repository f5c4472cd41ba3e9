# Robustness. Included by the makefile above.
# make faults   kills, signals, full disks, damaged files: how many tried, survived, refused
# make fuzz     mutated options
.PHONY: faults fuzz

# Runs stopped, disks filled, files damaged, options mutated: all of it; make test has a short part of each.
faults: isph $(BUILD)/tests/unit/test_errors
	@$(PYTHON) tests/faults/faults.py --kills 50 --damages 200 --disks 40
	@$(PYTHON) tests/faults/signals.py --all
	@$(PYTHON) tests/faults/terminal.py --all
	@$(PYTHON) tests/faults/options.py --all
	@$(PYTHON) tests/faults/crafted.py --checkpoints 200 --packings 40 --scenes 30
	@$(PYTHON) tests/faults/stl.py --number 100 --triangles 1000000

fuzz: isph
	@$(PYTHON) tests/faults/fuzz.py --number 2000
