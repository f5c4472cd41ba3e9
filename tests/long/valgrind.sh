#!/usr/bin/env bash
# valgrind over ten steps of a small impact: no invalid access, no value used before it is set, by this program.
cd "$(dirname "$0")/../.." || exit 1
command -v valgrind >/dev/null || { echo "ok valgrind (not installed, not run)"; exit 0; }
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
scratch=$(mktemp -d); trap 'rm -rf "$scratch"' EXIT
make -s ARCH= BUILD=output/portable PROGRAM=output/portable/isph output/portable/isph || exit 1
valgrind --log-file="$scratch/log" output/portable/isph -options_file tests/sanitizers/scene.opts -steps_max 10 \
  -output_dir "$scratch/run" >"$scratch/out" 2>&1
code=$?
sources=$(cd src && ls -- */*.c | xargs -n 1 basename | tr '\n' '|')
# a report is a paragraph: it is ours if one of its frames but those of main and the calls down to a library is on top
ours=$(awk -v files="${sources%|}" '/ at 0x/ { if ($0 ~ "\\((" files "):") n++ } END {print n + 0}' "$scratch/log")
if [ "$code" = 0 ] && [ "$ours" = 0 ]; then echo "ok valgrind"; exit 0; fi
echo "FAIL valgrind: exit code $code, $ours reports in this program"
tail -n 40 "$scratch/log"
exit 1
