#!/usr/bin/env bash
# The unit tests, some of them on two ranks too, and a short impact on 1 to 3 ranks, continued once, built with the
# address and undefined-behaviour sanitizers (make sanitized) and with PETSc's check that all its memory is given back.
cd "$(dirname "$0")/../.." || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1
# leaks of Open MPI and HDF5 are not ours; ours are PETSc's, which -malloc_dump shows
export ASAN_OPTIONS=detect_leaks=0:abort_on_error=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
build=output/sanitized
scratch=$(mktemp -d); trap 'rm -rf "$scratch"' EXIT

clean() { # name, command ...: exit code 0 and nothing said by a sanitizer or about memory not given back
  local name=$1 log code
  shift
  log=$("$@" 2>&1); code=$?
  if [ $code = 0 ] && ! grep -qE 'runtime error:|AddressSanitizer|^\[ ?[0-9]+\] ?[0-9]+ bytes|^FAIL ' <<<"$log"; then
    echo "ok sanitized_$name"
  else
    echo "FAIL sanitized_$name: exit code $code"
    tail -n 30 <<<"$log" | sed 's/^/  | /'
  fi
}

impact() { # ranks
  local folder=$scratch/run_$1
  local run=(mpiexec -n "$1" $build/isph -options_file tests/sanitizers/scene.opts -output_dir "$folder" -malloc_dump)
  clean "impact_$1" "${run[@]}" -steps_max 6
  clean "continued_$1" "${run[@]}" -steps_max 2 -restart "$(ls "$folder"/checkpoint_*.h5 | tail -n 1)"
}

[ -x $build/isph ] || { echo "FAIL sanitizers: $build/isph is not built; make sanitized"; exit 1; }
for program in $build/tests/unit/*; do # two at a time
  [ -f "$program" ] && [ -x "$program" ] || continue
  clean "$(basename "$program")" "$program" -malloc_dump >"$scratch/$(basename "$program").log" &
  [ "$(jobs -rp | wc -l)" -lt 2 ] || wait -n
done
wait
for name in packing operators points twolevel; do
  clean "test_${name}_2" mpiexec -n 2 $build/tests/unit/test_$name -malloc_dump >"$scratch/test_${name}_2.log"
done
export OMPI_MCA_mpi_yield_when_idle=1
for ranks in 1 2 3; do impact $ranks >"$scratch/$ranks.log"; done
export ISPH=$build/isph
clean crafted_files tests/faults/crafted.py --checkpoints 8 --packings 2 --scenes 2 >"$scratch/crafted.log"
clean stl_files tests/faults/stl.py --number 8 >"$scratch/stl.log"
cat "$scratch"/*.log
! grep -q '^FAIL ' "$scratch"/*.log
