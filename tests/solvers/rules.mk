# Solvers of the pressure, compared. Included by the makefile above.
# make compare-solvers   every solver on a state of a run, and which to take; STATE=output/my/snapshot_0010.h5 RANKS=2
# make solver-sweep      every solver of PETSc's: right or refused in a sentence; tests/solvers/README.md
.PHONY: compare-solvers solver-sweep

COMPARE = $(BUILD)/tests/solvers/compare

$(COMPARE): tests/solvers/compare.c $(OBJECTS) $(BUILD)/flags
	@mkdir -p $(dir $@); echo LD $@; $(CC) $(filter-out -D_POSIX_C_SOURCE%,$(TEST_FLAGS)) -D_GNU_SOURCE -o $@ $< $(OBJECTS) $(LIBS)

TYPES = $(BUILD)/tests/solvers/types

$(TYPES): tests/solvers/types.c $(OBJECTS) $(BUILD)/flags
	@mkdir -p $(dir $@); echo LD $@; $(CC) $(TEST_FLAGS) -o $@ $< $(OBJECTS) $(LIBS)

STATE =
RANKS = 1
compare-solvers: $(COMPARE)
	@$(MPI) $(PYTHON) tests/solvers/compare.py --ranks "$$RANKS" "$$STATE"

solver-sweep: isph $(TYPES)
	@$(PYTHON) tests/solvers/sweep.py --readme
