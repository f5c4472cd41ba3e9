#!/usr/bin/env bash
# The portable build: installed, it takes the code for the processor that it runs on, and all three codes agree.
cd "$(dirname "$0")/../.." || exit 1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
[ "$(uname -m)" = x86_64 ] || { echo "ok portable (not on x86, not run)"; exit 0; }
scratch=$(mktemp -d); trap 'rm -rf "$scratch"' EXIT
build="$scratch/tree"
mkdir "$build" && cp -r makefile src options cases "$build" || exit 1
portable() { make -s -j2 -C "$build" PORTABLE=1 "$@" >"$scratch/log" 2>&1; }
{ portable && portable install PREFIX="$scratch/to"; } ||
  { tail -5 "$scratch/log"; echo "FAIL portable: it does not build"; exit 1; }
rm -rf "$build"
failed=0
loader=$(ldd "$scratch/to/bin/isph" | awk '/ld-linux/ { print $1 }')
levels="x86-64-v1 x86-64-v3 x86-64-v4" # no folder has the name of the first: it is the library for all
for level in $levels; do
  "$loader" --help | grep -q "$level (supported" || [ $level = x86-64-v1 ] || continue
  name=$("$loader" --glibc-hwcaps-mask $level "$scratch/to/bin/isph" --version)
  case "$level: $name" in
    x86-64-v1*"any processor"* | x86-64-v3*AVX2 | x86-64-v4*AVX-512) ;;
    *) echo "FAIL portable: with $level it says $name"; failed=1 ;;
  esac
  "$loader" --glibc-hwcaps-mask $level "$scratch/to/bin/isph" -options_file tests/sanitizers/scene.opts -steps_max 20 \
    -output_dir "$scratch/$level" >"$scratch/out" 2>&1 ||
    { tail -3 "$scratch/out"; echo "FAIL portable: run with $level"; failed=1; }
done
${PYTHON:-/usr/bin/python3} - "$scratch"/x86-64-v* <<'P' || failed=1
import csv, sys
energies = []
for folder in sys.argv[1:]:
    with open(folder + "/series.csv", encoding="utf-8") as file:
        energies.append([float(row["kinetic_energy_J"]) for row in csv.DictReader(file)])
worst = max(abs(a - b) / max(energies[0]) for other in energies for a, b in zip(energies[0], other))
word = "ok" if len(energies) > 1 and worst < 1e-5 else "FAIL"
print(f"{word} portable: {len(energies)} codes, energies differ by {worst:.1e}")
sys.exit(worst >= 1e-5)
P
exit $failed
