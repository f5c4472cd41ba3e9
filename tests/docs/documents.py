#!/usr/bin/python3
"""What the READMEs, the pages beside them and CONTRIBUTING.md say is so: options, make targets, files and headings they
name exist, their commands are understood, the scene of the tutorial runs word for word (for fewer milliseconds), its
pictures and its film are made, the Python of the README runs on it, and `make install` gives programs that work."""
import glob
import os
import re
import shlex
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

PETSC = ("ksp_", "pc_", "mat_", "log_", "options_", "vec_", "help", "info", "malloc", "draw_", "eps_", "st_", "tao_",
         "memory_", "on_error", "fp_trap", "dm_", "sf_", "viscous_", "spectrum_", "packing_tao", "mg_", "packing_")
PROGRAMS = ("make", "mpiexec", "chrt", "git", "apt-get", "sbatch", "podman", "docker", "apptainer")


def texts():
    """(path, text) of the documents, without the tables that are generated."""
    for pattern in ("README.md", "CONTRIBUTING.md", "cases/*.md", "cases/*/*.md", "tests/*/README.md"):
        for path in sorted(glob.glob(os.path.join(runs.ROOT, pattern))):
            with open(path, encoding="utf-8") as file:
                yield os.path.relpath(path, runs.ROOT), re.sub(r"<!-- (?!chosen)([a-z_]+) -->.*?<!-- /\1 -->", "",
                                                               file.read(), flags=re.S)


def headings(path):
    """What a link into a document may name behind its #."""
    with open(path, encoding="utf-8") as file:
        titles = re.findall(r"^#+ (.*)$", file.read(), re.M)
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}


def known_options():
    """Names the sources read, those of bodies without the body's name."""
    names = set()
    for path in glob.glob(os.path.join(runs.ROOT, "src/*/*.[ch]")):
        with open(path, encoding="utf-8") as file:
            names |= set(re.findall(r'"-([a-z][a-z0-9_]*)"', file.read()))
    return names


def exists(option, names):
    """Whether an option is read by the program, is a body's, or is PETSc's."""
    parts = option.split("_")
    tails = {"_".join(parts[k:]) for k in range(len(parts))}
    box = re.fullmatch(r"box_[xyz](min|max)?(_velocity(_amplitude|_frequency)?|_level|_pressure)?", option)
    return bool(tails & names) or option.startswith(PETSC) or bool(box)


def commands(text):
    """Indented lines that start ./isph, joined over backslashes."""
    text = text.replace("\\\n", " ")
    return [line.strip() for line in text.splitlines() if re.match(r"    (mpiexec -n \d+ )?\./isph ", line)]


def unknown(text, targets):
    """Indented commands that are none: not ./isph, a target of make, or a script that can be run."""
    bad = []
    for line in re.findall(r"^    ((?:make|cases/|tests/|options/|\./)\S*.*)$", text, re.M):
        words = shlex.split(line, comments=True)
        if words[0] == "make":
            named = [w for w in words[1:] if "=" not in w and not w.startswith("-")]
            bad += [line] if set(named) - targets else []
        elif words[0] != "./isph" and not os.access(os.path.join(runs.ROOT, words[0]), os.X_OK):
            bad.append(line)
    return bad


readme = dict(texts())["README.md"]
names = known_options()


def written():
    for path, text in texts():
        spans = re.findall(r"`([^`\n]+)`", text)
        options = set()
        for span in spans:
            if not span.startswith(PROGRAMS):
                options |= set(re.findall(r"(?:^|\s)-([a-z][a-z0-9]*(?:_[a-z0-9]+)+)\b", span))
        missing = sorted(o for o in options if not exists(o, names) and not path.endswith("tried.md"))  # may be gone
        runs.check(not missing, f"options_{path}", f"nothing reads {missing}")
        targets = set()
        for rules in ["makefile"] + glob.glob("*/rules.mk", root_dir=runs.ROOT) + \
                glob.glob("*/*/rules.mk", root_dir=runs.ROOT):
            with open(os.path.join(runs.ROOT, rules), encoding="utf-8") as file:
                for line in re.findall(r"^([a-z][a-z -]*):(?!=)", file.read(), re.M):
                    targets |= set(line.split())
        wanted = {m for span in spans for m in re.findall(r"^make ([a-z][a-z-]*)", span)}
        runs.check(wanted <= targets, f"targets_{path}", f"the makefile has no {sorted(wanted - targets)}")
        bad = unknown(text.replace("\\\n", " "), targets)
        runs.check(not bad, f"commands_{path}", f"cannot be typed: {bad}")
        here = os.path.dirname(os.path.join(runs.ROOT, path))
        links = [(os.path.join(here, link) if link else os.path.join(runs.ROOT, path), part)
                 for link, part in re.findall(r"(?:\]\(|src=\")([^)\"#]*)#?([^)\"]*)[)\"]", text) if "://" not in link]
        broken = [link for link, part in links if not os.path.exists(link) or part and part not in headings(link)]
        runs.check(not broken, f"links_{path}", f"no file {broken}")
        gone = [p for p in re.findall(r"\b(?:src|tests|options|cases)/[\w./-]*\w", text)
                if "NAME" not in p and not glob.glob(os.path.join(runs.ROOT, p) + "*")]
        runs.check(not gone, f"paths_{path}", f"no file {gone}")
        page = re.fullmatch("cases/.*/README.md", path)
        runs.check(not page or text.count("\n") <= 150, f"length_{path}", f"{text.count(chr(10))} lines, at most 150")
        for k, command in enumerate(commands(text)):
            words = shlex.split(command, comments=True)
            words = words[words.index("./isph") + 1:]
            if "-ranks" in words:
                del words[words.index("-ranks"):words.index("-ranks") + 2]
            if "my.opts" in command or "coat.opts" in command or "-restart" in words:
                continue
            if "-output_dir" in words:
                del words[words.index("-output_dir"):words.index("-output_dir") + 2]
            dump = runs.scratch("dump.opts")
            process = runs.start(words + ["-dump_options", dump])
            others = []
            if process.returncode == 0:
                with open(dump, encoding="utf-8") as file:
                    tail = file.read().split("# --- PETSc's own options in use ---")[1]
                others = [o for o in re.findall(r"^-(\S+)", tail, re.M)
                          if not exists(o, set()) and not o.startswith(PETSC)]
            runs.check(process.returncode == 0 and not others, f"command_{path}_{k + 1}",
                       f"{command}: {others} {process.stderr.strip()[:300]}")


def tutorial():
    # the tutorial: its scene is the first indented block after its heading
    tutorial = readme.split("## Your own scene in ten minutes")[1].split("\n## ")[0]
    blocks = re.findall(r"(?:^    .*\n)+", tutorial, re.M)
    scene = runs.scratch("my.opts")
    with open(scene, "w", encoding="utf-8") as file:
        file.write(next(b for b in blocks if "-bodies" in b))
    folder = runs.scratch("my")
    process = runs.start(f"-options_file {scene} -dry_run -output_dir {folder}")
    estimated = process.returncode == 0 and "time:" in process.stdout and os.path.exists(folder + ".svg")
    runs.check(estimated, "tutorial_dry_run", process.stderr[:300])
    # the drop's diameter 2 mm, 1 m/s: rho U D/mu, rho U2 D/sigma, U2/(g D), rho g D2/sigma, mu/sqrt(rho sigma D)
    runs.check("20 spacings, Re 2e+03, We 27.8, Fr 51, Bo 0.545, Oh 0.00264" in process.stdout, "tutorial_numbers",
               process.stdout[:2000])
    runs.check("warning" not in process.stdout, "tutorial_without_warning", process.stdout[:2000])
    with open(scene, encoding="utf-8") as file:
        good = file.read()
    for name, text, words in (("in_mm", good.replace("e-3", ""), "lengths not in m"),
                              ("coarse", good + "-spacing 0.5e-3\n", "only 4 spacings across"),
                              ("short_waves",
                               good + "-film_shape wave\n-film_wave_amplitude 1e-5\n-film_wave_length 1e-3\n",
                               "waves of film are only 10 spacings long"),
                              ("no_rim", good + "-drop_type emitter\n-drop_velocity 0,-0.02\n", "no solid on whose"),
                              ("radians", good + "-wall_contact_angle 1.9\n", "1.9 radians are 108.9 degrees")):
        with open(runs.scratch(name + ".opts"), "w", encoding="utf-8") as file:
            file.write(text)
        doubtful = runs.start(f"-options_file {file.name} -time_end 1e-4 -dry_run -output_dir {runs.scratch(name)}")
        runs.check(words in doubtful.stdout, "tutorial_" + name + "_warns",
                   doubtful.stdout[:2000] + doubtful.stderr[:300])
    # -dump_options: with every default typed out the scene is the same
    everything, typed = runs.scratch("all.opts"), runs.scratch("typed.opts")
    runs.start(f"-options_file {scene} -dump_options {everything}")
    with open(everything, encoding="utf-8") as file, open(typed, "w", encoding="utf-8") as out:
        lines = [re.sub(r"^# (?=-[a-z][a-z0-9_]* \S)", "", line) for line in file]
        out.write("".join(line for line in lines if re.match(r"-\S+ \S", line)))
    again = runs.start(f"-options_file {typed} -dry_run -output_dir {folder}")
    wanted = re.findall(r"^ .*(?:m2|bound|speed|force|viscosity|tension).*$", process.stdout, re.M)
    runs.check(again.returncode == 0 and wanted and wanted == re.findall(
        r"^ .*(?:m2|bound|speed|force|viscosity|tension).*$", again.stdout, re.M), "dump_options_typed_out",
               again.stderr[:300] or again.stdout[-600:])
    process = runs.start(f"-options_file {scene} -output_dir {folder} -time_end 0.6e-3 -snapshot_interval 0.2e-3")
    runs.check(process.returncode == 0, "tutorial_run", process.stderr[:300])
    # as a shell reads it, but for the times
    typed = next(c for c in commands(tutorial) if "-restart" in c)
    typed = typed.replace("my.opts", scene).replace("output/my", folder)
    process = subprocess.run(typed.replace("15e-3", "0.8e-3").replace("./isph", runs.PROGRAM), shell=True, text=True,
                             cwd=runs.ROOT, env=runs.environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, check=False)
    runs.check(process.returncode == 0 and "Restart: " + folder in process.stdout, "tutorial_restart",
               process.stderr[:300])
    drawn = subprocess.run([sys.executable, os.path.join(runs.ROOT, "src/pictures/pictures.py"), folder, "--count",
                            "2"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    made = [os.path.join(folder, "figures", name) for name in ("section.png", "curves.png")]
    runs.check(drawn.returncode == 0 and all(os.path.exists(p) and os.path.getsize(p) > 10000 for p in made),
               "tutorial_pictures", drawn.stdout[-300:])
    if shutil.which("ffmpeg"):
        drawn = subprocess.run([sys.executable, os.path.join(runs.ROOT, "src/pictures/film.py"), folder,
                                "--color", "speed"],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True, check=False)
        film = os.path.join(folder, "figures", "film.mp4")
        runs.check(drawn.returncode == 0 and os.path.getsize(film) > 10000, "tutorial_film", drawn.stdout[-300:])
    else:
        print("skipped tutorial_film: ffmpeg is not installed")

    # the README's Python, on the run of the tutorial
    recipe = "".join(line[4:] for line in next(b for b in blocks if "import isph" in b).splitlines(True))
    recipe = recipe.replace("output/my", folder)
    done = subprocess.run([sys.executable, "-c", recipe], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, check=False, cwd=runs.ROOT)
    runs.check(done.returncode == 0 and re.match(r"\S+ \(\d+, 3\) \S+ \S+ m$", done.stdout), "readme_python",
               done.stdout[-300:])


def question():
    """The third tutorial, of cases/README.md, word for word: its values are within the bars that it prints."""
    section = dict(texts())["cases/README.md"].split("## From a question to an answer")[1].split("\n## ")[0]
    commands = re.findall(r"^    make (.*)$", section, re.M)
    runs.check(len(commands) == 2, "question_commands", str(commands))
    said = ""
    for command in commands:
        done = subprocess.run(f"make -s -o isph {command}", shell=True, cwd=runs.ROOT, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)
        runs.check(done.returncode == 0, "question " + command.split()[0], done.stdout[-400:])
        said += done.stdout
    answer = r"contact_diameter_ymin:at=10e-6 = (\S+) \+- (\S+) m"
    row = r"\| (0,-\d) \| (\S+) \| (\S+) \|"
    (value, bar), (now, _) = (re.search(answer, text).groups() for text in (section, said))
    runs.check_within(float(now), float(value) - float(bar), float(value) + float(bar), "question_answer")
    table = {speed: float(now) for speed, now, _ in re.findall(row, said)}
    for speed, value, bar in re.findall(row, section):
        low, high = float(value) - float(bar), float(value) + float(bar)
        runs.check_within(table.get(speed, 0), low, high, f"question {speed}")


def coating():
    # the second tutorial, of cases/README.md, as written but for times: the run ends early
    coating = dict(texts())["cases/README.md"].split("## A nozzle coats a moving plate")[1].split("\n## ")[0]
    blocks = re.findall(r"(?:^    .*\n)+", coating, re.M)
    sheet, coat = runs.scratch("coat.opts"), runs.scratch("coat")
    with open(sheet, "w", encoding="utf-8") as file:
        file.write(next(b for b in blocks if "-bodies" in b))
    commands = [c.strip() for b in blocks for c in b.splitlines() if c.strip().startswith(("./isph", "make"))]
    runs.check(len(commands) == 6, "coating_commands", str(commands))
    for k, command in enumerate(commands):
        words = command.replace("coat.opts", sheet).replace("output/coat", coat).replace("0.02 0.05 0.1 0.2", "0 0.01")
        if words.startswith("./isph"):
            words += " -time_end 1e-3" if "fast" in words or "fine" in words else " -time_end 20e-3"
            process = runs.start(words[len("./isph "):])
            runs.check(process.returncode == 0 and "warning" not in process.stdout, f"coating_{k + 1}",
                       f"{command}: {process.stdout[-600:]} {process.stderr[:300]}")
        else:
            process = subprocess.run(words, shell=True, cwd=runs.ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                     text=True, check=False)
            runs.check(process.returncode == 0, f"coating_{k + 1}", process.stdout[-400:])
    made = [coat + ".svg"] + [os.path.join(coat, name) for name in ("figures/section.png", "report.html")]
    runs.check(all(os.path.exists(path) and os.path.getsize(path) > 10000 for path in made), "coating_pictures",
               str(made))
    # figures for a paper, of a run whose folder has a blank in its name
    os.symlink(coat, runs.scratch("my coat"))
    for flags, good in (("--format pdf svg --width 8.5 --curves height kinetic --count 2", True),
                        ("--curves hight", False)):
        process = subprocess.run(["make", "pictures", f"RUN={runs.scratch('my coat')}", f"FLAGS={flags}"],
                                 cwd=runs.ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                 check=False)
        runs.check((process.returncode == 0) == good and (good or "no column of this name" in process.stdout),
                   f"pictures {flags[:20]}", process.stdout[-300:])
    for name, start in (("curves.pdf", b"%PDF"), ("section.svg", b"<?xml")):
        with open(os.path.join(coat, "figures", name), "rb") as file:
            runs.check(file.read(5).startswith(start), f"figures as {name[-3:]}")
    with open(os.path.join(coat, "figures", "curves.svg"), encoding="utf-8") as file:
        drawn = file.read()  # the text of a title stands in a comment beside its outlines
        asked = "<!-- kinetic energy (µJ/m)" in drawn and "<!-- time (ms)" in drawn and "<!-- potential" not in drawn
        runs.check(asked, "curves that were asked for", re.findall("<!-- .* -->", drawn)[:20])
    recipe = "".join(line[4:] for line in next(b for b in blocks if "import csv" in b).splitlines(True))
    done = subprocess.run([sys.executable, "-c", recipe.replace("output/coat", coat)], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    runs.check(len(re.findall(r"^gauge \d: \d\.\d\d mm$", done.stdout, re.M)) == 4, "coating_python",
               done.stdout[-300:])
    recipe = dict(texts())["cases/README.md"].split("## Examples in Python")[1].split("\nIn ParaView")[0]
    recipe = "".join(line[4:] or "\n" for line in recipe.split("far the two are apart:\n")[1].splitlines(True))
    recipe = recipe.replace("output/coat", coat).replace("compare.pdf", runs.scratch("compare.pdf"))
    done = subprocess.run([sys.executable, "-c", recipe], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          check=False)
    runs.check(done.returncode == 0 and re.search(r"last fifth: \d\.\d{3} mm", done.stdout) and
               os.path.getsize(runs.scratch("compare.pdf")) > 5000, "example_in_python", done.stdout[-300:])
    with open(os.path.join(runs.ROOT, "cases/coated_plate/case.opts"), encoding="utf-8") as file:
        case = [line.split("#")[0].split() for line in file if line.startswith("-") and "checkpoint" not in line]
    with open(sheet, encoding="utf-8") as file:
        runs.check([line.split("#")[0].split() for line in file] == case, "coating_is_the_case", str(case))


def installed():
    # an installed program runs an installed case, and its pictures are drawn, away from the sources
    prefix = runs.scratch("prefix")
    for driver in ("tests/tradeoff/tradeoff.py", "tests/bench/bench.py", "tests/verify/runner.py"):
        done = subprocess.run([sys.executable, driver, "--help"], cwd=runs.ROOT, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, check=False)
        runs.check(done.stdout.startswith("usage:"), f"help_{os.path.basename(driver)}", done.stdout[:200])

    done = runs.install(prefix)
    if runs.check(done.returncode == 0, "install", done.stdout[-300:]):
        case = os.path.join(prefix, "share/isph/cases/drop_collision/case.opts")
        for command in ([os.path.join(prefix, "bin/isph"), "-options_file", case, "-steps_max", "2",
                         "-output_dir", "there"],
                        [os.path.join(prefix, "bin/isph-pictures"), "there", "--count", "1"]):
            done = subprocess.run(command, cwd=prefix, env=runs.environment(), stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, universal_newlines=True, check=False)
            runs.check(done.returncode == 0, f"installed_{os.path.basename(command[0])}", done.stdout[-300:])
        runs.check(os.path.exists(os.path.join(prefix, "there/figures/section.png")), "installed_picture", "missing")
        place, = glob.glob(os.path.join(prefix, "lib/python3*/dist-packages"))
        use = "import isph; print(isph.open_run('there').pictures('--count', '1'), isph.program(), isph.__file__)"
        found = dict(runs.environment(), PYTHONPATH=place, PATH=f"{prefix}/bin:{os.environ['PATH']}")
        done = subprocess.run([sys.executable, "-c", use], cwd=prefix, stdout=subprocess.PIPE, env=found,
                              stderr=subprocess.STDOUT, text=True, check=False)
        runs.check(done.returncode == 0 and "section.png" in done.stdout and
                   f"{prefix}/bin/isph {place}" in done.stdout, "installed_python", done.stdout[-300:])


def dry_runs():
    # what a dry run says is within 30 % of the steps of implicit viscosity, and of vortices that die out:
    # steps tried at the start would tell 1.7 times as many
    for name, scene in (("column", "-options_file cases/column/case.opts -spacing 0.01"),
                        ("vortices", "-options_file cases/taylor_green/case.opts -spacing 0.0125 -water_viscosity 5e-3 "
                         "-time_end 5")):
        dry = runs.start(f"{scene} -dry_run -output_dir {runs.scratch('dry_' + name)}")
        said = re.search(r"time: about .*: (\d+) steps", dry.stdout)
        taken = runs.series(runs.run(scene, "dry_" + name))["step"][-1]
        runs.check(said and 0.7 < int(said.group(1)) / taken < 1.3, f"steps_of_a_dry_run_{name}",
                   f"{said}, taken {taken}")
    # what emitters bring and what leaves by outlets counts: particles at the end, bytes of a checkpoint
    for name, scene in (("emitter", "-box_y wall -bodies jet -jet_type emitter -jet_upper 0.2,0.4 -jet_velocity 0.5,0 "
                         "-jet_viscosity 0.02 -time_end 2"),
                        ("outlet", "-box_xmin wall -box_ymin wall -box_xmax_level 0.1 -gravity 0,-9.81 -bodies water "
                         "-water_upper 1,0.35 -time_end 0.8")):
        scene = f"-dimension 2 -spacing 0.02 -box_lower 0,0 -box_upper 1,0.4 {scene}"
        dry = runs.start(f"{scene} -dry_run -output_dir {runs.scratch('dry_' + name)}")
        said = re.search(r"at the end: about (\d+) particles", dry.stdout)
        each = re.search(r"two checkpoints of ([0-9.e-]+) MB", dry.stdout)
        folder = runs.run(scene, "dry_" + name)
        at_end = runs.series(folder)["particles"][-1]
        size = os.path.getsize(runs.numbered(folder, "checkpoint")[-1]) / 1e6
        if runs.check(said and each, f"dry_run_of_{name}", dry.stdout + dry.stderr):
            runs.check(0.9 < int(said.group(1)) / at_end < 1.1, f"particles_of_a_dry_run_{name}", f"{said}, {at_end}")
            runs.check(0.8 < float(each.group(1)) / size < 1.2, f"bytes_of_a_dry_run_{name}", f"{each}, {size}")
    # a scene that cannot be as coarse as a rehearsal is estimated from its trial steps, without a word of that
    dry = runs.start("-options_file cases/drop_impact/axisymmetric.opts -spacing 0.25e-3 -bodies drop,film,tiny "
                     "-dry_run -tiny_shape sphere -tiny_center 0,0.019 -tiny_radius 0.25e-3 "
                     f"-output_dir {runs.scratch('tiny')}")
    runs.check(dry.returncode == 0 and not dry.stderr and "(trial steps alone)" in dry.stdout, "no_rehearsal",
               dry.stderr[-300:])

PARTS = {f.__name__: f for f in (written, tutorial, question, coating, installed, dry_runs)}
for part in runs.parts(*PARTS):
    PARTS[part]()
runs.done()
