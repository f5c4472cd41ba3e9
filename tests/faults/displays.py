#!/usr/bin/python3
"""A start of the program, alone, by -ranks and as Python's library, asks no X server: one that ended meanwhile would
end it."""
import contextlib
import os
import socket
import subprocess
import sys
import threading

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

NAME = "\0/tmp/.X11-unix/X9"  # the abstract socket of display :9, the last one that hwloc asks
MARK = b"ISPH_TEST_OF_DISPLAYS=1"
LIBRARY = """import ctypes
library, run = ctypes.CDLL("output/build/lib/libisph.so"), ctypes.c_void_p()
raise SystemExit(library.IsphCreate(b"cases/film_at_rest/case.opts", -1, ctypes.byref(run)))"""


def asked(command, ranks):
    """Whether a process of the command connects to the display, and the command's exit code. Another program may."""
    environment = dict(runs.environment(ranks), ISPH_TEST_OF_DISPLAYS="1")
    del environment["HWLOC_COMPONENTS"]
    found = []

    def serve():
        with contextlib.suppress(OSError):  # at the end the listener is shut down
            while True:
                client, _ = listener.accept()
                pid = int.from_bytes(client.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12)[:4], sys.byteorder)
                with open(f"/proc/{pid}/environ", "rb") as file:  # it waits for an answer
                    found.append(MARK in file.read())
                client.close()

    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(NAME)
        listener.listen()
        thread = threading.Thread(target=serve)
        thread.start()
        code = subprocess.run(command, cwd=runs.ROOT, env=environment, stdin=subprocess.DEVNULL, check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=60).returncode
        listener.shutdown(socket.SHUT_RDWR)
        thread.join()
    return any(found), code


if __name__ == "__main__":
    dry = ["./isph", "cases/film_at_rest/case.opts", "-dry_run"]
    for what, command, ranks in (("the program", dry, 1), ("-ranks", [*dry, "-ranks", "2"], 2),
                                 ("the library", [sys.executable, "-c", LIBRARY], 1)):
        displays, code = asked([*command, *(["-output_dir", runs.scratch("dry")] if command[0] == "./isph" else [])],
                               ranks)
        runs.check(code == 0, f"{what}: starts", f"code {code}")
        runs.check(not displays, f"{what}: asks no display")
    runs.done()
