# isph: incompressible SPH on PETSc
#   make                the program ./isph and its library; PORTABLE=1: for any processor, ARCH=-march=...: for one; STRICT=1: warnings stop it
#   make run            the main case, its spacing following the liquid: two minutes on two cores, pictures in output/
#   make run-axisymmetric   the main case as rings around its axis: seconds
#   make check          whether a change is right, in three minutes; CHANGED=1: only what watches the files of `git diff`,
#                       a minute; BASE=HEAD~3: of the changes since then
#   make test           eight minutes on two cores, some tests on one date of five; ONLY=tension: all with this in their
#                       names; JOBS=1: one a time
#   make test-ci        the same with the compiler's sanitizers besides; make test-long: what takes hours, too
#   make lint           format, floors, circles, tables, figures that documents quote; where each feature is named
#   make verify         the cases against exact solutions: a table; CASE=couette: one case; verify-long: all of them
#   make pictures       of a run: RUN=output/my FLAGS="--color speed"; film, mesh, report: other views of it
#   make tradeoff       what each choice costs in a scene of your own: SCENE=my.opts GAUGES=a,b
#   make bench          speed; SIZE=full: of a million particles too
#   make answer         a value with its error bar: SCENE=my.opts QUANTITY=highest:max ACCURACY=5; make study: VARY too
#   make fit            values of options from a measured curve: SCENE=my.opts CURVE=lab.csv FREE="drop_tension=0.02,0.1"
#   make install        PREFIX=$HOME/isph: program, library, manual page, completion, options, cases, pictures, Python;
#                       make uninstall removes them
#   make deb            a Debian package of the same: output/deb/isph_*.deb; make gallery: a static site of all cases
#   make clean          removes what was built
#   make targets        all others: studies, tables of the documents, sweeps; each is in the rules.mk of its folder
#   CC=mpicc OMPI_CC=clang; PETSC_DIR, PETSC_ARCH, SLEPC_DIR: another compiler, another PETSc than Debian's
CC        = mpicc
PYTHON    = /usr/bin/python3
BUILD     = output/build
PROGRAM   = isph
PKG_PATH  = $(if $(PETSC_DIR),$(PETSC_DIR)/$(PETSC_ARCH)/lib/pkgconfig:)$(if $(SLEPC_DIR),$(SLEPC_DIR)/$(PETSC_ARCH)/lib/pkgconfig:)
PKG       = PKG_CONFIG_PATH=$(PKG_PATH)$$PKG_CONFIG_PATH pkg-config
PACKAGES  = SLEPc PETSc hdf5-openmpi zlib
ARCH      = $(if $(PORTABLE),,-march=native)
PIC       = -fPIC -fvisibility=hidden
CFLAGS    = -O3 $(ARCH) -g
WARNINGS  = -Wall -Wextra $(if $(STRICT),-Werror) -Wno-unknown-warning-option -Wstrict-prototypes -Wmissing-prototypes -Wshadow -Wno-unused-parameter -Wno-missing-field-initializers -Wno-pass-failed -Wno-psabi
ALL_FLAGS = -std=c11 -D_POSIX_C_SOURCE=200809L $(CFLAGS) $(PIC) -fno-math-errno -fno-trapping-math -ffp-contract=fast -fopenmp-simd $(WARNINGS) -MMD -MP $(shell $(PKG) --cflags $(PACKAGES))
LIBS      = $(shell $(PKG) --libs $(PACKAGES)) -lmetis -lm

SOURCES   = $(filter-out src/main.c,$(wildcard src/*.c src/*/*.c))
OBJECTS   = $(SOURCES:src/%.c=$(BUILD)/%.o)
LIBRARY   = $(BUILD)/lib/libisph.so

all: $(PROGRAM) $(LIBRARY)

# The library has all but main(). PORTABLE=1 on x86: once for each level of the architecture, of which the loader takes
# the highest that the processor has from lib/glibc-hwcaps; the program is linked with it. Else the program has it within.
ifeq ($(if $(PORTABLE),$(shell uname -m)),x86_64)
LIBRARIES = $(LIBRARY) $(patsubst %,$(BUILD)/lib/glibc-hwcaps/%/libisph.so,x86-64-v3 x86-64-v4)
LEVEL     = $(or $(filter x86-64-v%,$(subst /, ,$@)),x86-64)
$(LIBRARIES): force
	@mkdir -p $(@D); $(MAKE) --no-print-directory PORTABLE= BUILD=$(BUILD)/$(LEVEL) ARCH=-march=$(LEVEL) LIBRARY=$@ $@

$(PROGRAM): $(BUILD)/main.o $(LIBRARIES)
	@echo LD $@; $(CC) $(CFLAGS) -o $@ $< -L$(BUILD)/lib -lisph -Wl,-rpath,'$$ORIGIN/$(BUILD)/lib:$$ORIGIN/../lib/isph' $(LIBS)
else
LIBRARIES = $(LIBRARY)
$(LIBRARY): $(OBJECTS)
	@mkdir -p $(@D); echo LD $@; $(CC) $(CFLAGS) -shared -Wl,-soname,libisph.so -o $@ $^ $(LIBS)

$(PROGRAM): $(BUILD)/main.o $(OBJECTS)
	@echo LD $@; $(CC) $(CFLAGS) -o $@ $^ $(LIBS)
endif

$(BUILD)/%.o: src/%.c $(BUILD)/flags
	@mkdir -p $(dir $@)
	@echo CC $<; $(CC) $(ALL_FLAGS) -c -o $@ $<

# Objects depend on the compiler and its flags, so that a switch of either rebuilds.
$(BUILD)/flags: force
	@mkdir -p $(BUILD); echo '$(CC) $(OMPI_CC) $(ALL_FLAGS)' | cmp -s - $@ || echo '$(CC) $(OMPI_CC) $(ALL_FLAGS)' > $@

-include $(shell find $(BUILD) -name '*.d' 2>/dev/null)

UNIT = $(patsubst tests/unit/%.c,$(BUILD)/tests/unit/%,$(wildcard tests/unit/*.c))
MPI  = OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1 OMPI_MCA_mpi_yield_when_idle=1
RUN  = output/drop_impact

# The programs of the tests: with the gold linker, where there is one, each takes a fifth of the time to link; a function
# of the test stands for one of the program with its name.
GOLD       = $(if $(shell command -v ld.gold),-fuse-ld=gold)
TEST_FLAGS = $(subst -O3,-O1,$(ALL_FLAGS)) $(GOLD) -Isrc -Wl,-z,muldefs
$(BUILD)/tests/unit/%: tests/unit/%.c $(OBJECTS) $(BUILD)/flags
	@mkdir -p $(dir $@); echo LD $@; $(CC) $(TEST_FLAGS) -o $@ $< $(OBJECTS) $(LIBS)

# Studies, tables of the documents and sweeps stand in the folders that they belong to.
RULES = $(wildcard cases/*/rules.mk options/rules.mk src/*/rules.mk tests/*/rules.mk)
include $(RULES)

# Processes that run at a time; the tests choose their number themselves, unless it is given.
JOBS   := $(shell env -u OMP_NUM_THREADS nproc)
BASE   := HEAD
ONLY   :=
NUMBER := $(if $(filter command,$(origin JOBS)),--jobs "$$JOBS")

# What users give reaches the shell in the environment and is never read by it: recipes say "$$RUN". Lists of words are
# split at blanks and nothing else: set -f; $$FLAGS. The values are kept as they are typed, also before make.
GIVEN = ACCURACY BASE BUDGET CASE COMMIT CURVE FLAGS FREE FROM GAUGES JOBS MUTANT ONLY QUANTITY RANKS RUN SCENE SIZE STATE TARGET VARY \
  WAYS
$(foreach name,$(GIVEN),$(eval override $(name) := $$(value $(name))))
export $(GIVEN) DESTDIR PREFIX

packages:
	@tests/packages.sh build pictures

# A quarter of the main case, 0.25 mm where the surface is curved: three quarters of a minute on two cores, then figures.
run: packages
	$(MAKE) -j"$$JOBS" isph
	$(MPI) ./isph -ranks 2 -options_file cases/drop_impact/case.opts -options_file options/quarter.opts \
	  -options_file cases/drop_impact/following.opts -output_dir "$$RUN" -output_overwrite
	$(PYTHON) cases/drop_impact/figures.py "$$RUN"
	$(PYTHON) src/pictures/report.py "$$RUN"
	$(PYTHON) cases/drop_impact/compare.py "$$RUN"

# The main case as rings around its axis (-dimension axisymmetric): ten seconds on one core, then its figures.
run-axisymmetric: packages
	$(MAKE) -j"$$JOBS" isph
	$(MPI) ./isph -options_file cases/drop_impact/axisymmetric.opts -output_dir "$$RUN"_axisymmetric -output_overwrite
	$(PYTHON) cases/drop_impact/figures.py "$$RUN"_axisymmetric
	$(PYTHON) src/pictures/report.py "$$RUN"_axisymmetric
	$(PYTHON) cases/drop_impact/compare.py "$$RUN"_axisymmetric

# PORTABLE=1 for a cluster of mixed machines
PREFIX = /usr/local
SHARE  = "$$DESTDIR$$PREFIX"/share/isph
PYTHON_PLACE = lib/$(if $(filter /usr,$(PREFIX)),python3,$(shell $(PYTHON) -c 'import sys; print(f"python{sys.version_info[0]}.{sys.version_info[1]}")'))/dist-packages
TOOLS = pictures/pictures pictures/film pictures/mesh pictures/report answers/answer answers/study answers/fit \
  answers/reduce
install: $(PROGRAM) $(LIBRARIES)
	install -D -m 755 $(PROGRAM) "$$DESTDIR$$PREFIX"/bin/isph
	for library in $(LIBRARIES:$(BUILD)/lib/%=%); do \
	  install -D -m 755 $(BUILD)/lib/$$library "$$DESTDIR$$PREFIX"/lib/isph/$$library || exit 1; done
	install -D -m 644 src/isph.h "$$DESTDIR$$PREFIX"/include/isph.h
	install -d "$$DESTDIR$$PREFIX"/lib/pkgconfig
	printf 'prefix=%s\nName: isph\nDescription: incompressible smoothed particle hydrodynamics\nVersion: %s\n' "$$PREFIX" \
	  "$$(sed -n 's/^#define ISPH_VERSION "\(.*\)"/\1/p' src/base/base.h)" > "$$DESTDIR$$PREFIX"/lib/pkgconfig/isph.pc
	printf '%s\n' 'Cflags: -I$${prefix}/include' 'Libs: -L$${prefix}/lib/isph -lisph -Wl,-rpath,$${prefix}/lib/isph' \
	  >> "$$DESTDIR$$PREFIX"/lib/pkgconfig/isph.pc
	install -d $(SHARE)/pictures $(SHARE)/answers $(SHARE)/options/cluster
	install -m 644 src/answers/*.py $(SHARE)/answers
	install -m 644 options/*.opts options/form.html $(SHARE)/options
	install -m 644 options/cluster/* $(SHARE)/options/cluster
	install -m 644 src/pictures/*.py src/pictures/report.html src/pictures/*.js $(SHARE)/pictures
	install -m 644 -Dt $(SHARE)/pictures/uplot src/pictures/uplot/*
	install -m 644 -Dt $(SHARE)/python/isph src/python/isph/*.py
	install -m 644 -Dt "$$DESTDIR$$PREFIX"/$(PYTHON_PLACE)/isph src/python/isph/*.py
	cd cases && find . -name '*.opts' -exec install -D -m 644 {} $(SHARE)/cases/{} \;
	install -d "$$DESTDIR$$PREFIX"/share/man/man1 "$$DESTDIR$$PREFIX"/share/bash-completion/completions
	$(PYTHON) options/manual.py > "$$DESTDIR$$PREFIX"/share/man/man1/isph.1
	$(PYTHON) options/manual.py --completion > "$$DESTDIR$$PREFIX"/share/bash-completion/completions/isph
	for tool in $(TOOLS); do \
	  name="$$DESTDIR$$PREFIX"/bin/isph-$${tool#*/}; \
	  printf '#!/bin/sh\nexec %s "$$(dirname "$$(readlink -f "$$0")")/../share/isph/%s.py" "$$@"\n' $(PYTHON) $$tool > "$$name" && \
	  chmod 755 "$$name"; done

# Removes what install puts under the same PREFIX.
uninstall:
	cd "$$DESTDIR$$PREFIX" && rm -rf bin/isph $(addprefix bin/isph-,$(notdir $(TOOLS))) lib/isph include/isph.h \
	  lib/pkgconfig/isph.pc $(PYTHON_PLACE)/isph share/isph share/man/man1/isph.1 share/bash-completion/completions/isph

# The tests. All are built with as many processes as run at a time. ONLY=NAME: those with NAME in their name; after a
# change of the sources CHANGED=1 (and BASE=COMMIT) takes those that watch what changed since the commit, tests/table.txt.
CHANGED   =
SANITIZED = output/sanitized
PROGRAMS  = $(PROGRAM) $(LIBRARY) $(UNIT) $(COMPARE) $(TYPES)
TESTS     = @PYTHON=$(PYTHON) $(PYTHON) tests/run.py --only "$$ONLY" $(NUMBER)
.PHONY: check test test-ci test-long lint sanitized programs sanitized-programs
check: programs
	$(TESTS) --check $(if $(CHANGED),--changed "$$BASE")

test: programs $(if $(findstring sanitizers,$(ONLY)),sanitized)
	$(TESTS)

test-ci: programs sanitized
	$(TESTS) --sanitizers

test-long: programs
	$(TESTS) --long

lint: programs
	@$(PYTHON) tests/lint/features.py --print; $(PYTHON) tests/run.py --only lint/

programs:
	@$(MAKE) -s --no-print-directory -j"$$JOBS" $(PROGRAMS)

sanitized: programs
	@$(MAKE) -s --no-print-directory -j"$$JOBS" BUILD=$(SANITIZED) PROGRAM=$(SANITIZED)/isph LDFLAGS="$(LDFLAGS)" \
	  CFLAGS="-O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined" sanitized-programs

sanitized-programs: $(PROGRAM) $(UNIT)

clean:
	rm -rf $(BUILD) $(SANITIZED) output/clang output/portable output/mutants output/bench/builds isph

help:
	@sed -n '/^#/!q; s/^# \?//; p' makefile

targets:
	@for file in $(RULES); do echo "$$file"; sed -n 's/^# make/  make/p' "$$file"; done

.PHONY: all packages run run-axisymmetric install uninstall clean help targets force
