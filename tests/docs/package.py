#!/usr/bin/python3
"""pip install src/python without a network gives program, library and Python. make deb: the package has what make
install installs, names the libraries that it needs, and unpacked its program, its Python and its library work;
CITATION.cff has the program's version. Skipped without dpkg-dev."""
import glob
import importlib.util
import os
import re
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

USE = """import isph
run = isph.run("/{root}/share/isph/cases/ink_drop/case.opts", output="ink", steps_max=2, spacing=2.5e-6)
print(run.series["step"][-1], isph.program())
with isph.Simulation("{root}/share/isph/cases/ink_drop/case.opts", spacing=2.5e-6) as now:
    now.step()
    print(now.steps, len(now.position) > 10)
"""


def output(*words, **more):
    return subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **more)


version = runs.start("-version").stdout.split()[1].rstrip(",")
with open(os.path.join(runs.ROOT, "options", "CITATION.cff"), encoding="utf-8") as file:
    runs.check(f"\nversion: {version}\n" in file.read(), "version_of_the_citation", version)
if importlib.util.find_spec("pip"):
    there = runs.scratch("pip")
    made = output(sys.executable, "-m", "pip", "install", "--no-index", "--no-deps", "--target", there,
                  os.path.join(runs.ROOT, "src", "python"))
    found = {name: value for name, value in runs.environment().items() if name not in ("ISPH", "ISPH_LIBRARY")}
    done = output(sys.executable, "-c", USE.format(root=there), cwd=runs.scratch(""), env=dict(found, PYTHONPATH=there))
    runs.check(made.returncode == 0 and done.stdout.split() == ["2.0", f"{there}/bin/isph", "1", "True"], "pip_install",
               made.stdout[-300:] + done.stdout[-300:])
    helped = output(os.path.join(there, "bin", "isph-answer"), "--help", cwd=runs.scratch(""))
    runs.check(helped.returncode == 0 and "--quantity" in helped.stdout, "tools_of_pip", helped.stdout[-300:])
if not shutil.which("dpkg-shlibdeps") or not shutil.which("strip"):
    print("skipped: dpkg-dev is not installed")
    runs.done()
place = runs.scratch("deb")
made = output("make", "-s", "deb", "PORTABLE=", "BUILD=output/build", f"DEB={place}", cwd=runs.ROOT)
packages = glob.glob(os.path.join(place, "isph_*.deb"))
if runs.check(made.returncode == 0 and len(packages) == 1, "make_deb", made.stdout[-400:]):
    told = output("dpkg-deb", "-f", packages[0]).stdout
    needs = re.search("^Depends: (.*)$", told, re.M)[1]
    runs.check(f"\nVersion: {version}\n" in told and all(one in needs for one in (
        "libpetsc-real", "libslepc-real", "libopenmpi3", "libhdf5-openmpi", "libmetis5", "openmpi-bin",
        "python3-numpy")),
        "control", told)
    there = runs.scratch("there")
    output("dpkg-deb", "-x", packages[0], there)
    root = os.path.join(there, "usr")
    names = ("bin/isph", "bin/isph-answer", "include/isph.h", "lib/isph/libisph.so",
             "lib/python3/dist-packages/isph/running.py", "share/man/man1/isph.1.gz",
             "share/bash-completion/completions/isph", "share/doc/isph/copyright",
             "share/isph/cases/couette/case.opts", "share/isph/pictures/solids.py")
    missing = [name for name in names if not os.path.exists(os.path.join(root, name))]
    runs.check(not missing, "contents", str(missing))
    found = dict(runs.environment(), PYTHONPATH=os.path.join(root, "lib/python3/dist-packages"),
                 PATH=f"{root}/bin:{os.environ['PATH']}")
    found.pop("ISPH", None)
    done = output(sys.executable, "-c", USE.format(root=root), cwd=there, env=found)
    runs.check(done.returncode == 0 and done.stdout.split() == ["2.0", f"{root}/bin/isph", "1", "True"],
               "program_and_python_of_the_package", done.stdout[-400:])
runs.done()
