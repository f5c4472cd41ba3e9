#!/usr/bin/env bash
# Text: at most 120 columns and 700 lines, no tabs, no trailing blanks in src/, tests/, cases/ and options/.
# LINT_ROOT: another tree, for a test of the test.
set -u
cd "${LINT_ROOT:-$(dirname "$0")/../..}" || exit 1
export LC_ALL=C.UTF-8
bad=0
fail() { echo "FAIL format: $*"; bad=$((bad + 1)); }

files=0
while IFS= read -r file; do
  files=$((files + 1))
  complaints=$(awk -v file="$file" '
    length($0) > 120   {print file ":" FNR ": " length($0) " columns, at most 120"}
    /\t/               {print file ":" FNR ": a tab"}
    /[ \t\r]$/         {print file ":" FNR ": a blank at the end of the line"}
    END {if (FNR > 700) print file ": " FNR " lines, at most 700"}' "$file")
  [ -z "$complaints" ] || while IFS= read -r line; do fail "$line"; done <<<"$complaints"
done < <(find src tests cases options -type f -regex '.*\.\([ch]\|sh\|py\|opts\)' 2>/dev/null | sort)
[ "$files" -gt 0 ] || fail "no file was found"
[ "$bad" = 0 ] && echo "ok format ($files files)"
[ "$bad" = 0 ]
