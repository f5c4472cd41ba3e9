# Results beside those of another commit. Included by the makefile above.
# make identical   whether the results are those of a commit, to the last bit; COMMIT=HEAD~3
.PHONY: identical

COMMIT = HEAD
identical: isph
	@$(PYTHON) tests/identical/identical.py "$$COMMIT"
