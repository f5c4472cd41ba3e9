#!/usr/bin/env bash
# Text: at most 120 columns and 700 lines, no tabs, no trailing blanks in src/, tests/, cases/ and options/; and every
# option of options/*.opts and cases/*/*.opts is one of the program's (its -help), if it is built. LINT_ROOT: another
# tree, for a test of the test.
set -u
cd "${LINT_ROOT:-$(dirname "$0")/../..}" || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 LC_ALL=C.UTF-8
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

# Options, one a line, as the program itself lists them for this case and preset.
names() {
  sed -E 's/#.*//' "$1" | grep -oE '^[[:space:]]*-[A-Za-z_][A-Za-z0-9_]*' | tr -d '[:blank:]' | sort -u
}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
check() { # file, the -options_file arguments that make it a scene
  local file=$1 option
  shift
  timeout 120 ./isph "$@" -help -output_dir "$scratch/run" -output_overwrite >"$scratch/help" 2>&1 </dev/null
  if ! grep -q -- '-spacing' "$scratch/help"; then
    fail "$file: ./isph -help lists no options: $(head -c 200 "$scratch/help" | head -n 1)"
    return
  fi
  for option in $(names "$file"); do
    # PETSc's own, known whatever the scene: logging, the options database, and the linear solver's.
    [[ $option =~ ^-([a-z0-9]+_)*(ksp|pc|mg|mat|log|options|malloc|info|tao)_ ]] && continue
    grep -qE -- "(^|[[:space:]])$option([^A-Za-z0-9_]|\$)" "$scratch/help" ||
      fail "$file: the program knows no option $option"
  done
}
if [ -x ./isph ]; then
  before=$bad checked=0
  for file in cases/*/*.opts options/*.opts; do
    [ -f "$file" ] || continue
    checked=$((checked + 1))
    case=$(dirname "$file")/case.opts
    # The case's own file, and others that say how many dimensions there are, are scenes; the rest adds to one.
    if [ "$file" = "$case" ] || grep -q '^-dimension' "$file"; then check "$file" -options_file "$file"
    elif [ -f "$case" ]; then check "$file" -options_file "$case" -options_file "$file"
    else check "$file" -options_file cases/drop_impact/case.opts -options_file "$file"
    fi
  done
  [ "$bad" = "$before" ] && echo "ok options ($checked files)"
fi
[ "$bad" = 0 ]
