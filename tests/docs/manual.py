#!/usr/bin/python3
"""options/manual.py: the manual page names every option of options/options.json and is sound roff; the completion finds
names, values and files."""
import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

TOOL = os.path.join(runs.ROOT, "options", "manual.py")


def output(*command):
    return subprocess.run(command, cwd=os.path.join(runs.ROOT, "cases"), check=True, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT).stdout


with open(os.path.join(runs.ROOT, "options", "options.json"), encoding="utf-8") as file:
    names = [option["name"] for option in json.load(file)["options"]]
page = output(sys.executable, TOOL)
missing = [name for name in names if name.replace("-", "\\-") not in page]
runs.check(len(names) > 100 and not missing, "manual_names_every_option", f"{len(names)} rows, without {missing}")
path = runs.scratch("isph.1")
with open(path, "w", encoding="utf-8") as file:
    file.write(page)
if shutil.which("groff"):
    complaints = output("groff", "-man", "-Tutf8", "-ww", "-z", path)
    runs.check(not complaints, "manual_is_sound", complaints[:500])
script = runs.scratch("completion")
with open(script, "w", encoding="utf-8") as file:
    file.write(output(sys.executable, TOOL, "--completion"))
for words, wanted in ((["-spacin"], "-spacing"), (["-scheme", "cons"], "consistent"),
                      (["-bodies", "a,b", "-b_ve"], "-b_velocity"), (["piston/case.opts", "-piston_m"], "-piston_mass"),
                      (["-options_file", "drop_impact/ca"], "drop_impact/case.opts"), (["README"], "README.md")):
    line = " ".join(f"'{word}'" for word in ["isph", *words])
    found = output("bash", "-c", f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words)}; _isph; "
                   "echo \"${COMPREPLY[@]}\"").split()
    runs.check(wanted in found, f"completes_{wanted}", " ".join(found))
runs.done()
