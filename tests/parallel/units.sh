#!/usr/bin/env bash
# The unit tests of what works across ranks, on 2 and 3 of them.
cd "$(dirname "$0")/../.." || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMP_NUM_THREADS=1
bad=0
for ranks in 2 3; do
  for name in packing neighbors operators tension pressure twolevel points ghosts coarse graded joining; do
    program=output/build/tests/unit/test_$name
    [ -x "$program" ] || { echo "FAIL $name on $ranks ranks: $program is not built"; bad=1; continue; }
    log=$(mpiexec -n "$ranks" "$program" 2>&1)
    code=$?
    if [ "$code" = 0 ] && ! grep -q '^FAIL ' <<<"$log"; then
      echo "ok $name on $ranks ranks ($(grep -c '^ok ' <<<"$log") checks)"
    else
      bad=1
      echo "FAIL $name on $ranks ranks: exit code $code; $(grep '^FAIL ' <<<"$log" | sort -u | head -n 3 | tr '\n' ';')"
    fi
  done
done
exit $bad
