# Views of a run. Included by the makefile above.
.PHONY: pictures film mesh report gallery

# make pictures RUN=output/my FLAGS="--color speed"   sections, surface, view from above, curves in output/my/figures;
# FLAGS=--help: the others, here and with film, report, mesh
# make film RUN=output/my                             figures/film.mp4, a frame a snapshot
# make report RUN=output/my                           report.html: one page that shows the run, its surface to turn and play
# make mesh RUN=output/my                             mesh/surface_*.vtp and surface.pvd; FLAGS="--format ply --particles"
# make gallery                                        output/gallery/index.html: a static site of all cases, each with its page,
#                                                     tables, options, and a run to turn; FLAGS="--cases couette"
FLAGS =
pictures:
	@tests/packages.sh pictures
	@set -f; $(PYTHON) src/pictures/pictures.py "$$RUN" $$FLAGS

film:
	@tests/packages.sh pictures film
	@set -f; $(PYTHON) src/pictures/film.py "$$RUN" $$FLAGS

mesh:
	@tests/packages.sh pictures
	@set -f; $(PYTHON) src/pictures/mesh.py "$$RUN" $$FLAGS

report:
	@tests/packages.sh pictures
	@set -f; $(PYTHON) src/pictures/report.py "$$RUN" $$FLAGS

gallery: isph
	@tests/packages.sh pictures gallery
	@set -f; $(PYTHON) src/pictures/gallery.py --jobs "$$JOBS" $$FLAGS
