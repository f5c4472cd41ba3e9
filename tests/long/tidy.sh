#!/usr/bin/env bash
# clang-tidy over src/ with the checks of .clang-tidy, and a build with clang and all warnings.
cd "$(dirname "$0")/../.." || exit 1
command -v clang-tidy >/dev/null || { echo "ok clang_tidy (not installed, not run)"; exit 0; }
flags="-std=c11 -D_POSIX_C_SOURCE=200809L"
flags="$flags $(pkg-config --cflags SLEPc PETSc hdf5-openmpi) $(mpicc --showme:compile)"
# shellcheck disable=SC2086
log=$(printf '%s\n' src/*.c src/*/*.c | xargs -P 2 -I {} clang-tidy --quiet {} -- $flags 2>/dev/null |
  grep -E ': (error|warning):' | sort -u)
if [ -z "$log" ]; then echo "ok clang_tidy"; else echo "FAIL clang_tidy: $(wc -l <<<"$log") findings"; echo "$log"; fi
if STRICT=1 make -s CC="env OMPI_CC=clang mpicc" BUILD=output/clang PROGRAM=output/clang/isph output/clang/isph; then
  echo "ok clang_builds_without_warnings"
else
  echo "FAIL clang: warnings or errors"; exit 1
fi
[ -z "$log" ]
