#!/usr/bin/env bash
# The unit tests and a short impact on 1 to 3 ranks, continued once, built with the address and undefined-behaviour
# sanitizers (make sanitized) and with PETSc's check that all its memory is given back.
cd "$(dirname "$0")/../.." || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1
export OMPI_MCA_mpi_yield_when_idle=1
# leaks of Open MPI and HDF5 are not ours; ours are PETSc's, which -malloc_dump shows
export ASAN_OPTIONS=detect_leaks=0:abort_on_error=0 UBSAN_OPTIONS=print_stacktrace=1:halt_on_error=1
build=output/sanitized
bad=0
scratch=$(mktemp -d); trap 'rm -rf "$scratch"' EXIT

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

[ -x $build/isph ] || { echo "FAIL sanitizers: $build/isph is not built; make sanitized"; exit 1; }
for program in $build/tests/unit/*; do
  [ -f "$program" ] && [ -x "$program" ] && clean "$(basename "$program")" "$program" -malloc_dump
done
for ranks in 1 2 3; do
  folder=$scratch/run_$ranks
  run="mpiexec -n $ranks $build/isph -options_file tests/sanitizers/scene.opts -output_dir $folder"
  run="$run -malloc_dump"
  # shellcheck disable=SC2086
  clean "impact_$ranks" $run -steps_max 6
  # shellcheck disable=SC2086
  clean "continued_$ranks" $run -steps_max 2 -restart "$(ls "$folder"/checkpoint_*.h5 | tail -n 1)"
done
exit $bad
