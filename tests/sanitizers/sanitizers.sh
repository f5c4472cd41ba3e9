#!/usr/bin/env bash
# The unit tests, some of them on two ranks, and a short impact on 1 to 3 ranks, continued once, built with the address
# and undefined-behaviour sanitizers (make sanitized) and with PETSc's check that all its memory is given back.
#   sanitizers.sh [--parts | --part NAME]
set -u
cd "$(dirname "$0")/../.." || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1
# Leaks of Open MPI and HDF5 are not ours; ours are PETSc's, which -malloc_dump shows. A unit test that includes a
# source file of the library has its record twice.
export ASAN_OPTIONS=detect_leaks=0:abort_on_error=0:detect_odr_violation=0
export UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
export OMPI_MCA_mpi_yield_when_idle=1
build=output/sanitized
bad=0

clean() { # name, command ...: exit code 0 and nothing said by a sanitizer or about memory not given back
  local name=$1 log code
  shift
  log=$("$@" 2>&1); code=$?
  if [ $code = 0 ] && ! grep -qE 'runtime error:|AddressSanitizer|^\[ ?[0-9]+\] ?[0-9]+ bytes|^FAIL ' <<<"$log"; then
    echo "ok sanitized_$name"
  else
    bad=1
    echo "FAIL sanitized_$name: exit code $code"
    tail -n 30 <<<"$log" | sed 's/^/  | /'
  fi
}

impact() { # ranks
  local folder
  folder=$(mktemp -d)
  local run=(mpiexec -n "$1" $build/isph -options_file tests/sanitizers/scene.opts -output_dir "$folder/run"
    -malloc_dump)
  clean "impact_$1" "${run[@]}" -steps_max 6
  clean "continued_$1" "${run[@]}" -steps_max 2 -restart "$(ls "$folder"/run/checkpoint_*.h5 | tail -n 1)"
  rm -rf "$folder"
}

alone() { # command ...: on one rank, which need not look for networks
  local folder code
  folder=$(mktemp -d)
  env OMPI_MCA_pml=ob1 OMPI_MCA_btl=self OMPI_MCA_ess_singleton_isolated=1 OMPI_MCA_orte_tmpdir_base="$folder" "$@"
  code=$?
  rm -rf "$folder"
  return $code
}

programs=$(basename -s .c tests/unit/*.c)
on_two="test_packing_2 test_operators_2 test_points_2 test_twolevel_2"
parts="$programs $on_two impact_1 impact_2 impact_3 crafted_files stl_files"
case "${1:-}" in
  --parts) tr ' ' '\n' <<<"$parts"; exit 0 ;;
  --part)  parts=$2 ;;
esac
[ -x $build/isph ] || { echo "FAIL sanitizers: $build/isph is not built; make sanitized"; exit 1; }
for part in $parts; do
  case $part in
    impact_*)      impact "${part#impact_}" ;;
    crafted_files) ISPH=$build/isph clean $part tests/faults/crafted.py --checkpoints 8 --packings 2 --scenes 2 ;;
    stl_files)     ISPH=$build/isph clean $part tests/faults/stl.py --number 8 ;;
    *_2)           clean "$part" mpiexec -n 2 "$build/tests/unit/${part%_2}" -malloc_dump ;;
    *)             clean "$part" alone "$build/tests/unit/$part" -malloc_dump ;;
  esac
done
exit $bad
