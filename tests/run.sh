#!/usr/bin/env bash
# Runs the tests:  tests/run.sh [--long] [--sanitizers] [NAME ...]
#   programs  output/build/tests/unit/*, built by the makefile
#   scripts   tests/input, tests/parallel, tests/restart, tests/faults, tests/extremes, tests/solvers,
#             tests/verify, tests/lint (*.sh, *.py), tests/long with --long, tests/sanitizers with --sanitizers
# With names, only the tests whose path contains one of them. Each test prints 'ok name' or 'FAIL name: why' a line, and
# whatever else it likes. One that exits non-zero without a FAIL line, is killed, runs out of time or prints neither
# counts as one failure.
# TEST_TIMEOUT: seconds a test may take (default 600). The last line is 'N passed, N failed'; the exit code tells
# whether any failed.
set -u
cd "$(dirname "$0")/.." || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1
timeout=${TEST_TIMEOUT:-600}
python=${PYTHON:-/usr/bin/python3}
folders="docs input parallel restart faults extremes solvers verify lint"
names=()
for argument in "$@"; do
  case $argument in
    --long)       folders="$folders long" ;;
    --sanitizers) folders="$folders sanitizers" ;;
    *)            names+=("$argument") ;;
  esac
done
log=$(mktemp) || exit 1
trap 'rm -f "$log"' EXIT
passed=0 failed=0

chosen() { # path: whether it is one of the names, or there are none
  local name
  [ ${#names[@]} -gt 0 ] || return 0
  for name in "${names[@]}"; do
    [[ $1 == *"$name"* ]] && return 0
  done
  return 1
}

run() { # title, command ...
  local title=$1 start=$SECONDS code ok bad
  shift
  timeout --kill-after=10 "$timeout" "$@" >"$log" 2>&1 </dev/null
  code=$?
  ok=$(grep -c '^ok ' "$log")
  bad=$(grep -c '^FAIL ' "$log")
  grep '^FAIL ' "$log" | sed 's/^/  /'
  if [ "$bad" = 0 ]; then
    case $code in
      0)       [ "$ok" -gt 0 ] || { bad=1; echo "  FAIL $title: it printed no result"; } ;;
      124|137) bad=1; echo "  FAIL $title: not done after $timeout s" ;;
      *)       bad=1; echo "  FAIL $title: exit code $code"; tail -n 15 "$log" | sed 's/^/    | /' ;;
    esac
  fi
  passed=$((passed + ok))
  failed=$((failed + bad))
  printf '%-44s %4d ok %3d failed %5d s\n' "$title" "$ok" "$bad" $((SECONDS - start))
}

while IFS= read -r program; do
  chosen "$program" && run "${program#output/build/tests/}" "./$program"
done < <(find output/build/tests/unit -type f -executable 2>/dev/null | sort)

for folder in $folders; do
  for script in tests/"$folder"/*.sh tests/"$folder"/*.py; do
    [ -x "$script" ] || continue
    chosen "$script" || continue
    case $script in
      *.py) run "${script#tests/}" "$python" "$script" ;;
      *)    run "${script#tests/}" "$script" ;;
    esac
  done
done

[ $((passed + failed)) -gt 0 ] || { echo "  FAIL run.sh: no test was found"; failed=1; }
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
