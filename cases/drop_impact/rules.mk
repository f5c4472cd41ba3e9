# The main case at the paper's resolution, and the tables and pictures of its README. Included by the makefile above.
# make paper, paper-printed   the main case at the paper's spacing with its figures: default scheme, scheme as printed; SPEED=242, BOX=whole
# make paper-figures          what of these runs the case's README shows
# make seeds                  five packings at 0.5 and 0.35 mm
.PHONY: paper paper-printed paper-figures seeds

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
	set -f; $(MPI) ./isph -ranks 2 $(PAPER) $(if $(filter printed,$(PRESET)),-options_file options/paper.opts) \
	  -output_dir "$$RUN"_$(PRESET)$(PLACE) $(if $(findstring -restart,$(FLAGS)),,-output_overwrite) $$FLAGS
	$(PYTHON) cases/drop_impact/figures.py "$$RUN"_$(PRESET)$(PLACE)
	$(PYTHON) cases/drop_impact/compare.py "$$RUN"_$(PRESET)$(PLACE)

# What the README of the case shows of these runs: each one's series (a row in five), options and log go into
# cases/drop_impact/runs/, the pictures of the whole box and of the printed scheme beside the README.
CASE_DIR = cases/drop_impact
paper-figures:
	@tests/packages.sh pictures
	@for run in "$$RUN"_paper* "$$RUN"_printed*; do test -d "$$run" || continue; \
	  kept=$(CASE_DIR)/runs/"$${run##*impact_}"; mkdir -p "$$kept" && \
	  awk 'NR == 1 || NR % 5 == 2' "$$run"/series.csv >"$$kept"/series.csv && \
	  grep -v '^t = ' "$$run"/log.txt >"$$kept"/log.txt && cp "$$run"/options.opts "$$kept" || exit 1; done
	$(PYTHON) $(CASE_DIR)/figures.py "$$RUN"_paper_whole "$$RUN"_printed "$$RUN"_paper_242_whole "$$RUN"_printed_242 \
	  --labels "default scheme, whole box" "as printed, quarter" "default scheme, whole box" "as printed, quarter"
	for run in paper_whole printed paper_242_whole printed_242; do test $$run = paper_whole || \
	  $(PYTHON) $(CASE_DIR)/figures.py --only 1 "$$RUN"_$$run; $(PYTHON) -c "import sys; from PIL import Image; \
	  Image.open(sys.argv[1]).convert('RGB').save(sys.argv[2], quality=85)" \
	  "$$RUN"_$$run/figures/figure_1.png $(CASE_DIR)/$$run.jpg || exit 1; done
	cp "$$RUN"_paper_whole/figures/figure_2.png $(CASE_DIR)/curves.png

# The main case from five packings at 0.5 and 0.35 mm, both speeds: mean and spread, half an hour on two cores.
seeds: isph
	@$(PYTHON) cases/drop_impact/seeds.py --readme --jobs "$$JOBS"
