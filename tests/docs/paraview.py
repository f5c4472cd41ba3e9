#!/usr/bin/python3
"""The macro for ParaView: it opens the files and arrays that a run has. ParaView itself is rarely there, so a stand-in
for paraview.simple writes down what it is asked for. Tried with ParaView 5.11."""
import json
import os
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import h5py  # noqa: E402
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.05 -box_lower 0,0 -box_upper 1,1 -box_ymin wall -box_x wall -gravity 0,-9.81
 -bodies film -film_upper 1,0.4 -solids post -post_lower 0.4,0 -post_upper 0.6,0.3 -steps_max 4 -time_step 1e-3
 -snapshot_interval 1e-3 -checkpoint_interval 0 """
STAND_IN = '''
import json, sys
said = {"made": [], "arrays": [], "times": []}
class Any:
    TimestepValues, ViewSize = [0.0, 1e-3, 2e-3], (1200, 800)
    def __init__(self, **given): self.__dict__.update(given)
    def __getattr__(self, name): return lambda *a, **b: Any()
    def __setattr__(self, name, value):
        if name == "Scalars": said["arrays"].append(value[1])
        if name == "ViewTime": said["times"].append(value)
        self.__dict__[name] = value
    def GetDataInformation(self): return type("", (), {"GetBounds": lambda s: (0, 1, 0, 1, 0, 0)})()
def ColorBy(display, value): said["arrays"] += [value[1]] if value else []
def SaveScreenshot(path, *a, **b):
    said["picture"] = path
    json.dump(said, open(path + ".json", "w"))
def __getattr__(name):
    def make(*a, **given):
        said["made"].append([name, {k: v for k, v in given.items() if k == "FileName"}])
        return Any(**given)
    return make
'''
SCRIPT = os.path.join(runs.ROOT, "src", "pictures", "open_in_paraview.py")
folder = runs.run(SCENE, "run")
place = runs.scratch("stand_in")
os.makedirs(os.path.join(place, "paraview"))
for name, text in (("__init__.py", ""), ("simple.py", STAND_IN)):
    with open(os.path.join(place, "paraview", name), "w", encoding="utf-8") as file:
        file.write(text)
picture = os.path.join(place, "picture.png")
done = subprocess.run([sys.executable, SCRIPT, folder, picture, "1e-3"], capture_output=True, text=True, check=False,
                      env=dict(os.environ, PYTHONPATH=place))
runs.check(done.returncode == 0, "macro runs", done.stderr[-500:])
with open(picture + ".json", encoding="utf-8") as file:
    said = json.load(file)
opened = [given["FileName"][0] for _, given in said["made"] if given]
runs.check(opened and all(os.path.exists(path) for path in opened), "files that it opens", opened)
with h5py.File(runs.numbered(folder, "snapshot")[-1]) as file:
    there = set(file)
runs.check(set(said["arrays"]) == {"body", "velocity"} and set(said["arrays"]) <= there, "arrays that it uses", said)
runs.check(said["times"] == [1e-3], "the time asked for", said["times"])
runs.done()
