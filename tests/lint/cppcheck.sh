#!/usr/bin/env bash
# cppcheck over src/: warnings and what is not portable. Passed over where it is not installed.
cd "$(dirname "$0")/../.." || exit 1
command -v cppcheck >/dev/null || { echo "ok cppcheck (not installed, not run)"; exit 0; }
log=$(cppcheck --enable=warning,portability --std=c11 --suppressions-list=tests/lint/cppcheck.txt --quiet \
  --error-exitcode=1 -D'PetscFunctionBegin=' src 2>&1) && { echo "ok cppcheck"; exit 0; }
echo "FAIL cppcheck: $(grep -cE ': (error|warning|portability|style):' <<<"$log") findings"
echo "$log"
exit 1
