#!/usr/bin/python3
"""Options files and the environment with everything that one finds in them: encodings, endless lines, files within
files, numbers that fit nowhere. Each is read as it is meant, or refused in one sentence; on one rank and on two.

    tests/faults/options.py [--all]

Without --all each is tried on one rank, those that rank 0 alone can see also on two. The last line tells how many were
tried, ran and were refused."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

SCENE = """-dimension 2 -spacing 0.1 -box_lower 0,0 -box_upper 1,1 -gravity 0,-9.81 -box_x periodic -box_ymin wall
 -bodies film -film_upper 1,0.5 -time_end 10 -steps_max 2 -progress_interval 0 -output_overwrite
 -packing_cache ''""".replace("\n", " ")
LINES = SCENE.replace(" -", "\n-") + "\n"
SECONDS = 120
tally = {"ran": 0, "refused": 0, "failed": 0}
folder = runs.scratch("files")
os.mkdir(folder)
os.mkdir(os.path.join(folder, "home"))


def write(name, content):
    """A file in the folder of the tests; its path."""
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path


def attempt(name, options, words=None, environment=None, steps=2, ranks=(1,)):
    """A run that must come to its last step, or where there are words be refused in a sentence with them all."""
    before = dict(os.environ)
    os.environ["HOME"] = os.path.join(folder, "home")
    os.environ.update(environment or {})
    for n in (1, 2) if "--all" in sys.argv else ranks:
        out = runs.scratch("run")
        process = runs.start((runs.shlex.split(options) if isinstance(options, str) else options) +
                             ["-output_dir", out], n, SECONDS)
        lines = [line for line in process.stderr.splitlines() if line.startswith("isph: error: ")]
        ran = process.returncode == 0 and not process.stderr and \
            os.path.exists(os.path.join(out, f"checkpoint_{steps:06d}.h5"))
        refused = 0 < process.returncode < 126 and len(lines) == 1 and "PETSC ERROR" not in process.stderr
        good = refused and all(word in lines[0] for word in words) if words else ran
        tally["failed" if not good else "refused" if words else "ran"] += 1
        runs.check(good, f"{name}, {n} rank{'s' * (n > 1)}", f"code {process.returncode}: {process.stderr[:400]}")
    os.environ.clear()
    os.environ.update(before)


def file(name, content, words=None, **kwargs):
    """The same with an options file of this content."""
    attempt(name, [write(re.sub(r"\W", "_", name) + ".opts", content)], words, **kwargs)


BOM = b"\xef\xbb\xbf"
own, first, second = (os.path.join(folder, name) for name in ("own.opts", "first.opts", "second.opts"))
write("own.opts", LINES + f"-options_file {own}\n")
write("first.opts", LINES + f"-options_file {second}\n")
write("second.opts", f"-options_file {first}\n")
for depth in range(40):  # chain_0 reads chain_1 and so on; the last has the scene
    write(f"chain_{depth}.opts", f"-options_file {folder}/chain_{depth + 1}.opts\n" if depth < 39 else LINES)
os.symlink("loop.opts", os.path.join(folder, "loop.opts"))
os.mkfifo(os.path.join(folder, "pipe.opts"))
good = write("good.opts", LINES)


def contents():
    """What a file may look like."""
    file("plain file", LINES)
    file("no end of line at the end", LINES.rstrip())
    file("ends of line of Windows", LINES.replace("\n", "\r\n"))
    file("blanks and tabs around", LINES.replace("\n", " \t \n \t").replace(" 0.1", "\t 0.1"))
    file("comments in any encoding", "# \u00e9t\u00e9\n".encode() + b"# \xe9t\xe9\n" + LINES.encode() + b"# end")
    file("an endless comment", "#" + "x" * 1000000 + "\n" + LINES)
    file("many empty lines", "\n" * 100000 + LINES)
    file("an option twice", LINES + "-steps_max 7\n-steps_max 3\n", steps=3)
    file("a prefix", LINES + "-prefix_push film_\n-density 900\n-prefix_pop\n")
    file("empty file", "", ["no scene"])
    file("comments alone", "# nothing\n", ["no scene"])
    file("a byte-order mark", BOM + LINES.encode(), ["line 1"])
    file("sixteen bits a letter", LINES.encode("utf-16"), ["line 1"])
    file("a zero byte", LINES.replace("0.1", "0\0.1"), ["line 2"])
    file("ends of line of old", LINES.replace("\n", "\r"), ["-"])
    file("a value of 100000 letters", LINES + "-gravity " + "1" * 100000 + "\n", ["-gravity"])
    file("a name of 100000 letters", LINES + "-" + "x" * 100000 + " 1\n", ["x"])
    file("an open quotation", LINES + '-gravity "0,-1\n', ["-gravity"])
    file("an equals sign", LINES + "-spacing=0.1\n", ["-spacing=0.1"])
    file("a unit behind a blank", LINES + "-gravity 0,-9.81 m/s2\n", ["line", "m/s2", "no blanks"])
    file("units", LINES.replace("0.1\n", "10cm\n") + '-film_viscosity "3 cP"\n-time_end 10s\n')
    file("a word without a dash", LINES + "spacing 0.1\n", ["spacing"])
    file("a binary file", bytes(range(256)) * 100, ["line 1"])
    file("three thousand options", LINES + "".join(f"-option_{k} {k}\n" for k in range(3000)), ["more options"])
    attempt("a broken yaml file", ["-options_file", write("broken.yaml", "a: [1\nb: }")], ["yaml"], ranks=(1, 2))
    attempt("yaml", ["-options_file", write("good.yaml", "".join(
        f"{name}: {value}\n" for name, value in re.findall(r"-([a-z_]+) ([^\s-]\S*)", LINES) if value != "''"))] +
            ["-gravity", "0,-9.81", "-output_overwrite"])


def files():
    """Which files."""
    attempt("a file of itself", [own], [own], ranks=(1, 2))
    attempt("two of each other", [first], [first])
    attempt("40 within each other", [f"{folder}/chain_0.opts"], ["deep"])
    attempt("20 within each other", [f"{folder}/chain_20.opts"])
    attempt("the same file twice", [good, good])
    attempt("a link to itself", [f"{folder}/loop.opts"], ["loop.opts", "cannot be opened"])
    attempt("a pipe", [f"{folder}/pipe.opts"], ["pipe.opts", "regular"])
    attempt("a folder", [folder], [folder, "regular"], ranks=(1, 2))
    attempt("an empty device", ["/dev/null"], ["/dev/null", "regular"])
    attempt("no file", ["-options_file"], ["-options_file"], ranks=(1, 2))
    attempt("an empty name", ["-options_file", ""], ["-options_file", "name"], ranks=(1, 2))
    attempt("a file within that is missing", [write("outer.opts", "-options_file /nowhere.opts\n")], ["/nowhere.opts"],
            ranks=(1, 2))


def numbers():
    """Numbers that fit nowhere."""
    for option, value in (("-spacing", "1e400"), ("-spacing", "1e-400"), ("-spacing", "nan"), ("-spacing", "0x"),
                          ("-steps_max", "99999999999999999999"), ("-steps_max", "2147483648"), ("-steps_max", "1e3"),
                          ("-steps_max", "-1"), ("-box_upper", "1e999,1"), ("-box_upper", "1,,1"), ("-gravity", ",")):
        attempt(f"{option} {value}", runs.shlex.split(SCENE) + [option, value], [option])


def surroundings():
    """The environment."""
    attempt("options of the environment", [good], environment={"PETSC_OPTIONS": "-film_density 900"})
    attempt("a misspelt one of the environment", [good], ["-film_densty", "-film_density?"],
            {"PETSC_OPTIONS": "-film_densty 900"})
    attempt("a file of the environment", [], environment={"PETSC_OPTIONS": f"-options_file {good}"})
    attempt("a missing file of the environment", [good], ["/nowhere.opts"],
            {"PETSC_OPTIONS": "-options_file /nowhere.opts"}, ranks=(1, 2))
    attempt("a long environment", [good], environment={"PETSC_OPTIONS": "-film_density 900 " * 5000})
    attempt("a word of the environment", [good], ["nonsense"], {"PETSC_OPTIONS": "nonsense -film_density 900"})
    attempt("an open quotation of the environment", [good], environment={"PETSC_OPTIONS": '-film_density "900'})
    attempt("no home", [good], environment={"HOME": ""})
    attempt("a home that is a file", [good], environment={"HOME": good})
    for what, content, words in (("that is good", b"-film_density 900\n", None),
                                 ("of a misspelt option", b"-film_densty 900\n", ["-film_densty"]),
                                 ("that is a word", b"nonsense\n", ["nonsense"]),
                                 ("of any bytes", bytes(range(1, 256)), ["line 1"])):
        write("home/.petscrc", content)
        attempt(f"a .petscrc {what}", [good], words, ranks=(1, 2))
    os.remove(f"{folder}/home/.petscrc")
    os.mkdir(f"{folder}/home/.petscrc")
    attempt("a .petscrc that is a folder", [good], [".petscrc", "regular"], ranks=(1, 2))


PARTS = {part.__name__: part for part in (contents, files, numbers, surroundings)}
for chosen in runs.parts(*PARTS):
    PARTS[chosen]()
print(f"{sum(tally.values())} tried: {tally['ran']} ran, {tally['refused']} refused, {tally['failed']} failed")
runs.done()
