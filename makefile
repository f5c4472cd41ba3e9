# isph: incompressible SPH on PETSc.   make | make run | make test | make test-long | make lint | make clean
#   make verify, make verify-long   runs of cases/ against exact solutions, a table; CASE=couette: of one case; JOBS=1
#   make convergence CASE=couette   a case at several spacings; writes the tables of its README
#   make verify-readme              writes the tables of cases/README.md and of the cases from the last runs
#   make reference CASE=thin_film   the volume-of-fluid computations that some checks compare with, anew (needs gerris)
#   make extremes                   the limits of scenes, steps, solvers: table and map; extremes-readme: in tests/extremes/
#   make long-run                   a million steps of a small scene: nothing drifts
#   make mutants                    small bugs put in one at a time: which ones the tests see; MUTANT=NAME, JOBS=1
#   make test-ci                    make test with the compiler's sanitizers besides
#   make faults, make fuzz          kills, signals, full disks, damaged files; mutated options: how many tried, survived, refused
#   make paper, make paper-printed  the main case at the paper's spacing, with its figures: default scheme, scheme as
#                                   printed; SPEED=242: slower; BOX=whole: the whole box.  make seeds: five packings;
#                                   paper-figures: what of these runs the case's README shows
#   make bench                      speed: 16 k and 128 k particles, SIZE=full: 1 M too; other scenes and builds; bench-readme: in tests/bench/
#   make bench-results              what a result costs: time and error of the impact computed in other ways; FLAGS=--all: the slow ones too
#   make tradeoff SCENE=my.opts GAUGES=a,b  what each choice costs in a scene, and which to take; CASE=central_force: in
#                                           a case, against its solution; tradeoff-readme: in tests/tradeoff/
#   make solver-sweep               every solver of PETSc's: right or refused in a sentence; table in tests/solvers/
#   make compare-solvers STATE=FILE.h5      every solver on a state of a run of your own (RANKS=2), and which to take
#   PORTABLE=1   code for any processor of the architecture, which takes what a machine has when it starts; ARCH=-march=...  for one
#   STRICT=1     warnings are errors, as in .ci/run
#   CC=mpicc     the MPI compiler; OMPI_CC=clang mpicc builds with clang
#   PETSC_DIR, PETSC_ARCH, SLEPC_DIR   another PETSc than Debian's
CC        = mpicc
PYTHON    = /usr/bin/python3
BUILD     = output/build
PROGRAM   = isph
PKG_PATH  = $(if $(PETSC_DIR),$(PETSC_DIR)/$(PETSC_ARCH)/lib/pkgconfig:)$(if $(SLEPC_DIR),$(SLEPC_DIR)/$(PETSC_ARCH)/lib/pkgconfig:)
PKG       = PKG_CONFIG_PATH=$(PKG_PATH)$$PKG_CONFIG_PATH pkg-config
PACKAGES  = SLEPc PETSc hdf5-openmpi
ARCH      = $(if $(PORTABLE),,-march=native)
PIC       =
CFLAGS    = -O3 $(ARCH) -g
WARNINGS  = -Wall -Wextra $(if $(STRICT),-Werror) -Wno-unknown-warning-option -Wstrict-prototypes -Wmissing-prototypes -Wshadow -Wno-unused-parameter -Wno-pass-failed -Wno-psabi
ALL_FLAGS = -std=c11 -D_POSIX_C_SOURCE=200809L $(CFLAGS) $(PIC) -fno-math-errno -fno-trapping-math -ffp-contract=fast -fopenmp-simd $(WARNINGS) -MMD -MP $(shell $(PKG) --cflags $(PACKAGES))
LIBS      = $(shell $(PKG) --libs $(PACKAGES)) -lmetis -lm

SOURCES   = $(filter-out src/main.c,$(wildcard src/*/*.c))
OBJECTS   = $(SOURCES:src/%.c=$(BUILD)/%.o)

all: $(PROGRAM)

# The portable program on x86: all but main() is a library, once for each level of the architecture, and the loader takes
# the highest that the processor has from lib/glibc-hwcaps. Elsewhere, and without PORTABLE=1, it is one program.
ifeq ($(if $(PORTABLE),$(shell uname -m)),x86_64)
LIBRARY   = libisph.so
LIBRARIES = $(LIBRARY:%=$(BUILD)/lib/%) $(patsubst %,$(BUILD)/lib/glibc-hwcaps/%/$(LIBRARY),x86-64-v3 x86-64-v4)
LEVEL     = $(or $(filter x86-64-v%,$(subst /, ,$@)),x86-64)
$(LIBRARIES): force
	@mkdir -p $(@D); $(MAKE) --no-print-directory PORTABLE= BUILD=$(BUILD)/$(LEVEL) ARCH=-march=$(LEVEL) \
	  PIC="-fPIC -fno-semantic-interposition" SHARED=$@ $@

$(PROGRAM): $(BUILD)/main.o $(LIBRARIES)
	@echo LD $@; $(CC) $(CFLAGS) -o $@ $< -L$(BUILD)/lib -lisph -Wl,-rpath,'$$ORIGIN/$(BUILD)/lib:$$ORIGIN/../lib/isph' $(LIBS)
else
$(PROGRAM): $(BUILD)/main.o $(OBJECTS)
	@echo LD $@; $(CC) $(CFLAGS) -o $@ $^ $(LIBS)
endif

ifdef SHARED
$(SHARED): $(OBJECTS)
	@echo LD $@; $(CC) $(CFLAGS) -shared -Wl,-Bsymbolic -o $@ $^ $(LIBS)
endif

$(BUILD)/%.o: src/%.c $(BUILD)/flags
	@mkdir -p $(dir $@)
	@echo CC $<; $(CC) $(ALL_FLAGS) -c -o $@ $<

# The names of the program's options: some are read after the packing only.
$(BUILD)/names.h: $(SOURCES)
	@mkdir -p $(BUILD); grep -oh '"-[a-z][a-z0-9_]*"' $(SOURCES) | sort -u | sed 's/"-/"/; s/$$/,/' > $@

$(BUILD)/sim/option_check.o: $(BUILD)/names.h
$(BUILD)/sim/option_check.o: ALL_FLAGS += -I$(BUILD)

# Objects depend on the compiler and its flags, so that a switch of either rebuilds.
$(BUILD)/flags: force
	@mkdir -p $(BUILD); echo '$(CC) $(OMPI_CC) $(ALL_FLAGS)' | cmp -s - $@ || echo '$(CC) $(OMPI_CC) $(ALL_FLAGS)' > $@

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

UNIT = $(patsubst tests/unit/%.c,$(BUILD)/tests/unit/%,$(wildcard tests/unit/*.c))
MPI  = OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1 OMPI_MCA_mpi_yield_when_idle=1
RUN  = output/drop_impact

$(BUILD)/tests/unit/%: tests/unit/%.c $(OBJECTS) $(BUILD)/flags
	@mkdir -p $(dir $@); echo LD $@; $(CC) $(ALL_FLAGS) -Isrc -o $@ $< $(OBJECTS) $(LIBS)

COMPARE = $(BUILD)/tests/solvers/compare

$(COMPARE): tests/solvers/compare.c $(OBJECTS) $(BUILD)/flags
	@mkdir -p $(dir $@); echo LD $@; $(CC) $(filter-out -D_POSIX_C_SOURCE%,$(ALL_FLAGS)) -D_GNU_SOURCE -Isrc -o $@ $< $(OBJECTS) $(LIBS)

TYPES = $(BUILD)/tests/solvers/types

$(TYPES): tests/solvers/types.c $(OBJECTS) $(BUILD)/flags
	@mkdir -p $(dir $@); echo LD $@; $(CC) $(ALL_FLAGS) -Isrc -o $@ $< $(OBJECTS) $(LIBS)

packages:
	@tests/packages.sh build pictures

# The main case at quick resolution (options/quick.opts), a quarter of the box: a minute on two cores, then its figures.
run: packages
	$(MAKE) isph
	$(MPI) mpiexec -n 2 ./isph -options_file cases/drop_impact/case.opts -options_file options/quarter.opts \
	  -options_file options/quick.opts -output_dir $(RUN) -output_overwrite
	$(PYTHON) cases/drop_impact/figures.py $(RUN)
	$(PYTHON) src/pictures/report.py $(RUN)
	$(PYTHON) cases/drop_impact/compare.py $(RUN)

# The main case as rings around its axis (-dimension axisymmetric): ten seconds on one core, then its figures.
run-axisymmetric: packages
	$(MAKE) isph
	$(MPI) ./isph -options_file cases/drop_impact/axisymmetric.opts -output_dir $(RUN)_axisymmetric -output_overwrite
	$(PYTHON) cases/drop_impact/figures.py $(RUN)_axisymmetric
	$(PYTHON) src/pictures/report.py $(RUN)_axisymmetric
	$(PYTHON) cases/drop_impact/compare.py $(RUN)_axisymmetric

# The main case at the paper's spacing, 60 ms, then its figures: a quarter of the box (some ten minutes on two cores) or
# with BOX=whole all of it (an hour or two); SPEED=242: the slower impact; paper-printed: the scheme as printed (hours).
# FLAGS="-wall_clock_limit 3600" ends it with a checkpoint, FLAGS="-restart FILE" continues from that.
SPEED = 313
BOX   = quarter
PAPER = $(if $(filter-out 313 242,$(SPEED)),$(error SPEED=$(SPEED): 313 or 242 (cm/s)))$(if $(filter-out quarter whole,$(BOX)),$(error \
  BOX=$(BOX): quarter or whole))-options_file cases/drop_impact/case.opts $(if $(filter 242,$(SPEED)),-options_file cases/drop_impact/speed_242.opts) \
  $(if $(filter quarter,$(BOX)),-options_file options/quarter.opts)
PLACE = $(if $(filter 242,$(SPEED)),_242)$(if $(filter whole,$(BOX)),_whole)
paper: PRESET = paper
paper-printed: PRESET = printed
paper paper-printed: packages
	$(MAKE) isph
	$(MPI) mpiexec -n 2 ./isph $(PAPER) $(if $(filter printed,$(PRESET)),-options_file options/paper.opts) \
	  -output_dir $(RUN)_$(PRESET)$(PLACE) $(if $(findstring -restart,$(FLAGS)),,-output_overwrite) $(FLAGS)
	$(PYTHON) cases/drop_impact/figures.py $(RUN)_$(PRESET)$(PLACE)
	$(PYTHON) cases/drop_impact/compare.py $(RUN)_$(PRESET)$(PLACE)

# What the README of the case shows of these runs: each one's series (a row in five), options and log go into
# cases/drop_impact/runs/, the pictures of the whole box and of the printed scheme beside the README.
CASE_DIR = cases/drop_impact
paper-figures:
	@tests/packages.sh pictures
	@for run in $(wildcard $(RUN)_paper* $(RUN)_printed*); do kept=$(CASE_DIR)/runs/$${run##*impact_}; mkdir -p $$kept && \
	  awk 'NR == 1 || NR % 5 == 2' $$run/series.csv >$$kept/series.csv && grep -v '^t = ' $$run/log.txt >$$kept/log.txt && \
	  cp $$run/options.opts $$kept || exit 1; done
	$(PYTHON) $(CASE_DIR)/figures.py $(RUN)_paper_whole $(RUN)_printed $(RUN)_paper_242_whole $(RUN)_printed_242 \
	  --labels "default scheme, whole box" "as printed, quarter" "default scheme, whole box" "as printed, quarter"
	for run in paper_whole printed paper_242_whole printed_242; do test $$run = paper_whole || \
	  $(PYTHON) $(CASE_DIR)/figures.py --only 1 $(RUN)_$$run; $(PYTHON) -c "from PIL import Image; \
	  Image.open('$(RUN)_$$run/figures/figure_1.png').convert('RGB').save('$(CASE_DIR)/$$run.jpg', quality=85)" || exit 1; done
	cp $(RUN)_paper_whole/figures/figure_2.png $(CASE_DIR)/curves.png

# The main case from five packings at 0.5 and 0.35 mm, both speeds: mean and spread, half an hour on two cores.
seeds: isph
	@$(PYTHON) cases/drop_impact/seeds.py --readme --jobs $(JOBS)

# Speed of the step over sizes, ranks, states and preconditioners, each event beside what the machine can do, then other
# scenes and builds: tables and chart in output/bench/.
SIZE = quick
bench: isph
	@$(PYTHON) tests/bench/bench.py --size $(SIZE)
	@$(PYTHON) tests/bench/variants.py

bench-readme:
	@$(PYTHON) tests/bench/bench.py --readme
	@$(PYTHON) tests/bench/variants.py --readme

# Processor time and errors of the whole impact in different ways, into output/bench_results/, five minutes of one core;
# FLAGS=--all: the slow ones too; FLAGS=--readme: puts the last table into tests/bench/README.md
bench-results: isph
	@$(PYTHON) tests/bench/results.py $(FLAGS)

# make pictures RUN=output/my FLAGS="--color speed"   sections, surface, view from above, curves in output/my/figures;
#                                                     FLAGS=--help lists the others, here and with film, report, mesh
# make film RUN=output/my                             figures/film.mp4, a frame a snapshot
# make report RUN=output/my                           report.html: one page that shows the run, its surface to turn and play
# make mesh RUN=output/my                             mesh/surface_*.vtp and surface.pvd; FLAGS="--format ply --particles"
FLAGS =
pictures:
	@tests/packages.sh pictures
	@$(PYTHON) src/pictures/pictures.py "$(RUN)" $(FLAGS)

film:
	@tests/packages.sh pictures film
	@$(PYTHON) src/pictures/film.py "$(RUN)" $(FLAGS)

mesh:
	@tests/packages.sh pictures
	@$(PYTHON) src/pictures/mesh.py "$(RUN)" $(FLAGS)

report:
	@tests/packages.sh pictures
	@$(PYTHON) src/pictures/report.py "$(RUN)" $(FLAGS)

# make install PREFIX=$HOME/isph   program, manual page, completion, options, cases and pictures; PORTABLE=1 for a cluster of mixed machines
PREFIX = /usr/local
SHARE  = $(DESTDIR)$(PREFIX)/share/isph
install: isph
	install -D -m 755 isph $(DESTDIR)$(PREFIX)/bin/isph
	for library in $(LIBRARIES:$(BUILD)/lib/%=%); do \
	  install -D -m 755 $(BUILD)/lib/$$library $(DESTDIR)$(PREFIX)/lib/isph/$$library || exit 1; done
	install -d $(SHARE)/pictures $(SHARE)/options/cluster
	install -m 644 options/*.opts $(SHARE)/options
	install -m 644 options/cluster/* $(SHARE)/options/cluster
	install -m 644 src/pictures/*.py src/pictures/report.html src/pictures/viewer.js $(SHARE)/pictures
	cd cases && find . -name '*.opts' -exec install -D -m 644 {} $(SHARE)/cases/{} \;
	install -d $(DESTDIR)$(PREFIX)/share/man/man1 $(DESTDIR)$(PREFIX)/share/bash-completion/completions
	$(PYTHON) options/manual.py > $(DESTDIR)$(PREFIX)/share/man/man1/isph.1
	$(PYTHON) options/manual.py --completion > $(DESTDIR)$(PREFIX)/share/bash-completion/completions/isph
	for tool in pictures film mesh report; do printf '#!/bin/sh\nexec %s %s/share/isph/pictures/%s.py "$$@"\n' $(PYTHON) $(PREFIX) $$tool \
	  > $(DESTDIR)$(PREFIX)/bin/isph-$$tool && chmod 755 $(DESTDIR)$(PREFIX)/bin/isph-$$tool; done

test: isph $(UNIT) $(COMPARE) $(TYPES)
	@PYTHON=$(PYTHON) tests/run.sh

# As make test, and the same unit tests and an impact with the compiler's sanitizers.
test-ci: isph $(UNIT) $(COMPARE) $(TYPES) sanitized
	@PYTHON=$(PYTHON) tests/run.sh --sanitizers

SANITIZED = output/sanitized
sanitized:
	@$(MAKE) -j2 BUILD=$(SANITIZED) PROGRAM=$(SANITIZED)/isph LDFLAGS="$(LDFLAGS)" \
	  CFLAGS="-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined" sanitized-programs

sanitized-programs: $(PROGRAM) $(UNIT)

test-long: isph $(UNIT) $(COMPARE) $(TYPES)
	@PYTHON=$(PYTHON) TEST_TIMEOUT=7200 tests/run.sh --long

VERIFY = $(MPI) $(PYTHON) tests/verify/runner.py
JOBS   = 2
CASE   =
FROM   =

# FROM="ID=FOLDER ...": judge runs that exist instead of running these entries; IDs: tests/verify/runner.py --list
verify: isph
	@$(VERIFY) --size short --case "$(CASE)" --jobs $(JOBS) $(addprefix --from ,$(FROM))

verify-long: isph
	@$(VERIFY) --size long --case "$(CASE)" --jobs $(JOBS) $(addprefix --from ,$(FROM))

convergence: isph
	@$(VERIFY) --convergence --case "$(CASE)" --jobs $(JOBS) $(addprefix --from ,$(FROM))

verify-readme:
	@$(VERIFY) --readme

# Independent computations by volume of fluid that the checks read, cases/*/reference*.csv: ten minutes each; Debian's gerris
reference:
	@tests/packages.sh reference
	@$(PYTHON) tests/verify/reference.py $(CASE)

# Runs stopped, disks filled, files damaged, options mutated: all of it; make test has a short part of each.
faults: isph $(BUILD)/tests/unit/test_errors
	@$(PYTHON) tests/faults/faults.py --kills 50 --damages 200 --disks 40
	@$(PYTHON) tests/faults/signals.py --all
	@$(PYTHON) tests/faults/options.py --all
	@$(PYTHON) tests/faults/crafted.py --checkpoints 200 --packings 40 --scenes 30
	@$(PYTHON) tests/faults/stl.py --number 100 --triangles 1000000

extremes: isph
	@$(PYTHON) tests/extremes/extremes.py --all

extremes-readme:
	@$(PYTHON) tests/extremes/extremes.py --readme

long-run: isph
	@$(PYTHON) tests/long/long_run.py 1000000

fuzz: isph
	@$(PYTHON) tests/faults/fuzz.py --number 2000

# Small bugs put into a copy of the program one at a time: which ones make test sees; mutants-readme: the table of
# tests/mutants/README.md from the last run of all. MUTANT="pressure growth_limit": those of a file, folder or name
MUTANT =
mutants: isph $(UNIT)
	@$(PYTHON) tests/mutants/mutants.py --jobs $(JOBS) $(MUTANT)

mutants-readme:
	@$(PYTHON) tests/mutants/mutants.py --readme
# make compare-solvers STATE=output/my/snapshot_0010.h5   every solver on the user's own state, and which to take
STATE =
RANKS = 1
compare-solvers: $(COMPARE)
	@$(MPI) $(PYTHON) tests/solvers/compare.py --ranks $(RANKS) "$(STATE)"

# make solver-sweep   every solver, preconditioner and matrix type: right, or refused in a sentence; tests/solvers/README.md
solver-sweep: isph $(TYPES)
	@$(PYTHON) tests/solvers/sweep.py --readme

# make tradeoff CASE=central_force   error and CPU time of each choice: table, CSV and chart in output/tradeoff/
# make tradeoff SCENE=my.opts GAUGES=crater_depth,force_zmin   the same for a scene of your own, with advice in words and
#   advice.opts; BUDGET=600: CPU seconds for it; TARGET=5: per cent; WAYS="rings.opts": other ways to compute the scene
BUDGET = 600
TARGET = 5
WAYS   =
tradeoff: isph
ifdef SCENE
	@$(MPI) $(PYTHON) tests/tradeoff/scene.py "$(SCENE)" --gauges "$(GAUGES)" --budget $(BUDGET) --target $(TARGET) \
	  --ways $(WAYS)
else
	@$(MPI) $(PYTHON) tests/tradeoff/tradeoff.py --case "$(CASE)"
endif

# The table of the case and, once the five scenes have been swept, the summary in tests/tradeoff/README.md.
tradeoff-readme:
	@$(PYTHON) tests/tradeoff/tradeoff.py --case "$(CASE)" --readme
	@$(PYTHON) tests/tradeoff/summary.py

# make identical COMMIT=HEAD~3   whether the results are those of that commit, to the last bit
COMMIT = HEAD
identical: isph
	@$(PYTHON) tests/identical/identical.py $(COMMIT)

# options/README.md: the list of all options, from ./isph -help
options-reference: isph
	@$(PYTHON) tests/docs/options.py --write

lint:
	@tests/run.sh tests/lint

clean:
	rm -rf $(BUILD) $(SANITIZED) output/clang output/portable output/mutants output/bench/builds isph

.PHONY: solver-sweep paper paper-printed paper-figures seeds bench bench-readme bench-results all packages run run-axisymmetric test test-long verify verify-long convergence verify-readme reference \
  faults fuzz lint clean force pictures film mesh report install extremes extremes-readme long-run test-ci \
  sanitized sanitized-programs mutants mutants-readme compare-solvers tradeoff tradeoff-readme identical options-reference
