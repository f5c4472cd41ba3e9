"""pip install src/python: builds the program and its library with make, and packs what make install installs as a
wheel. It needs what make needs and no network (PEP 517; pyproject.toml names it)."""
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tempfile
import zipfile

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
TOLD = ("Metadata-Version: 2.1\nName: isph\nVersion: {}\nSummary: Drops, splashes and other free-surface flows by "
        "incompressible SPH on PETSc\nLicense: BSD-2-Clause\nRequires-Python: >=3.9\nRequires-Dist: numpy\n")


def version():
    with open(os.path.join(ROOT, "src", "base", "base.h"), encoding="utf-8") as file:
        return re.search('#define ISPH_VERSION "(.*)"', file.read())[1]


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """The name of the wheel: the package, and as its data the rest, which pip puts below the prefix of this Python.
    The library lies in the package."""
    head = f"isph-{version()}"
    tag = "py3-none-" + re.sub(r"[-.]", "_", sysconfig.get_platform())
    name = f"{head}-{tag}.whl"
    with tempfile.TemporaryDirectory() as stage, zipfile.ZipFile(os.path.join(wheel_directory, name), "w",
                                                                 zipfile.ZIP_DEFLATED) as wheel:
        make = ["make", "-s", "-C", ROOT, f"PYTHON={sys.executable}", f"PREFIX={stage}"]
        subprocess.run([*make, f"-j{os.cpu_count()}", "all"], check=True, stdout=sys.stderr)
        subprocess.run([*make, "install"], check=True, stdout=sys.stderr)
        record = []

        def put(place, data, mode=0o644):
            one = zipfile.ZipInfo(place, (2020, 1, 1, 0, 0, 0))
            one.external_attr, one.compress_type = (0o100000 | mode) << 16, zipfile.ZIP_DEFLATED
            wheel.writestr(one, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            record.append(f"{place},sha256={digest},{len(data)}\n")
        for folder, _, files in os.walk(stage):
            for file in files:
                path = os.path.join(folder, file)
                place = os.path.relpath(path, stage)
                inner = place.partition("-packages/")[2] or place.partition("lib/")[2] * place.endswith(".so")
                with open(path, "rb") as stream:
                    put(inner or f"{head}.data/data/{place}", stream.read(), os.stat(path).st_mode & 0o777)
        put(f"{head}.dist-info/METADATA", TOLD.format(version()).encode())
        put(f"{head}.dist-info/WHEEL", f"Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: {tag}\n".encode())
        wheel.writestr(f"{head}.dist-info/RECORD", "".join(record) + f"{head}.dist-info/RECORD,,\n")
    return name
