#!/usr/bin/env bash
# A folder of src/ includes its own headers and those of lower floors, nothing else; and no private header of another
# folder. LINT_ROOT: another tree than this repository, for a test of the test.
set -u
cd "${LINT_ROOT:-$(dirname "$0")/../..}" || exit 1
declare -A floor=(
  [base]=0 [twolevel]=1 [solver]=1 [kernel]=1 [domain]=1 [scene]=1 [storage]=1 [particles]=2 [neighbors]=3 [operators]=4
  [tension]=5 [pressure]=5 [stepper]=6 [spectrum]=6 [gauges]=7 [bodies]=8 [lines]=8 [gas]=8 [heat]=8 [outlets]=8
  [elastic]=8 [resampling]=8 [following]=8 [interface]=8 [output]=8 [packing]=9 [emitters]=10 [sim]=11
)
allowed="scene:domain" # on one floor, yet allowed: a scene lies in a domain
# The headers a folder shows to the others; what it has besides is its own.
declare -A public=([neighbors]=cloud.h)
# Second public headers.
extra=" base/json.h base/shared.h base/simd.h domain/images.h gauges/columns.h neighbors/pairs.h "
extra+="neighbors/sorted_cells.h stepper/edge.h packing/samples.h scene/body.h tension/lines.h operators/liquid_row.h "
bad=0
fail() { echo "FAIL layers: $*"; bad=$((bad + 1)); }

# The picture of the floors in CONTRIBUTING.md is this table: "[number]  folder, folder   what is there".
drawn=$(awk '/^    clients/, /^$/ {
  sub(/^ *(clients|edges|core)? *\|? */, "")
  if (match($0, /^[0-9]+ +/)) { at = $1; $0 = substr($0, RLENGTH + 1) }
  sub(/   .*/, "")
  n = split($0, name, ", *")
  for (k = 1; at != "" && k <= n; k++) print name[k] "=" at }' CONTRIBUTING.md 2>/dev/null)
for name in "${!floor[@]}"; do
  [ ! -f CONTRIBUTING.md ] || grep -qx "$name=${floor[$name]}" <<<"$drawn" ||
    fail "CONTRIBUTING.md does not draw src/$name on floor ${floor[$name]}"
done

count=0
for folder in src/*/; do
  name=$(basename "$folder")
  compgen -G "$folder*.[ch]" >/dev/null || continue # pictures: programs in Python
  [ -n "${floor[$name]:-}" ] || fail "src/$name is on no floor; give it one in tests/lint/layers.sh"
done
while IFS=: read -r file line text; do
  count=$((count + 1))
  from=$(dirname "${file#src/}")
  header=$(sed -E 's/^[^"]*"([^"]*)".*/\1/' <<<"$text")
  [ "$from" = . ] && continue # src/isph.c, src/main.c stand above all floors
  case $header in
    */*) ;;
    *) [ -f "src/$from/$header" ] || fail "$file:$line includes $header, which is not in src/$from"; continue ;;
  esac
  to=$(basename "$(dirname "$header")")
  [ "$to" = "$from" ] && continue
  if [ ! -f "src/$from/$header" ]; then
    fail "$file:$line includes $header, which does not exist"
  elif [ -z "${floor[$from]:-}" ] || [ -z "${floor[$to]:-}" ]; then
    fail "$file:$line includes $header: a folder without a floor"
  elif [ "${floor[$to]}" -ge "${floor[$from]}" ] && [[ " $allowed " != *" $from:$to "* ]]; then
    fail "$file:$line: $from (floor ${floor[$from]}) includes $header (floor ${floor[$to]}); only lower floors may be"
  elif [ "$(basename "$header")" != "${public[$to]:-$to.h}" ] && [[ "$extra" != *" $to/$(basename "$header") "* ]]; then
    fail "$file:$line includes $header, a private header of src/$to; its public one is ${public[$to]:-$to.h}"
  fi
done < <(grep -nE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' -r src --include='*.[ch]' | sort)

# One convention for private headers: <folder>_impl.h, and <file>.h beside <file>.c for what only a few files share.
while IFS= read -r header; do
  folder=$(basename "$(dirname "$header")") name=$(basename "$header" .h)
  [ "$name" = "$folder" ] || [ "$name" = "${folder}_impl" ] || [ "$name.h" = "${public[$folder]:-}" ] ||
    [[ "$extra" == *" $folder/$name.h "* ]] || [ -f "${header%.h}.c" ] ||
    fail "$header is neither the header of its folder, ${folder}_impl.h nor that of a file beside it"
done < <(find src -name '*.h' | sort)

# Options are rows: what reads one otherwise is unknown to -dump_options, scene.json and the refusal of unknown names.
while IFS= read -r place; do
  fail "$place reads an option that is no row of a table (base/option_rows.h)"
done < <(grep -nE 'PetscOptions(Real|Int|Bool|String|FList|EList|Enum|Viewer)(Array)?\(' -r src --include='*.c' |
         grep -vE '^src/(base/option_rows|domain/vectors)\.c:' | cut -d: -f1,2)

[ "$count" -gt 0 ] || fail "no include was found under src/"
[ "$bad" = 0 ] && echo "ok layers ($count includes)"
[ "$bad" = 0 ]
