#!/usr/bin/python3
"""options/README.md lists every option, and what cannot be used together, as ./isph -help knows them. Without
arguments a test that it does; --write writes the lists (make options-reference)."""
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

README = os.path.join(runs.ROOT, "options", "README.md")
MARKS = "<!-- options -->", "<!-- /options -->"
REFUSALS = "What cannot be used together"  # a group of -help that has no options
FEATURE = r"(?<!\S)(-[\w<>]+(?: (?!cannot|needs|yet)[\w<>]+)?)"
UNITS = ("1", "s", "m", "m/s", "m/s2", "1/s", "rad/s", "Hz", "kg/m3", "Pa s", "N/m", "N", "degrees", "spacings")
UNIT = rf"(?<!Eq\.) \(({'|'.join(map(re.escape, UNITS))})\)|, ([ms])(?=;|$)"  # 'Density (kg/m3)', 'Level, m; ...'
PETSC = ("PetscDevice", "Root Petsc", "Preconditioner (PC)")  # groups of PETSc's own options
EXAMPLE = "Body liquid"  # of the scene that -help makes up
CHOICES = 12  # that a cell holds
LINE = r"  (-(?:<body>)?\w+)[: ]+<([^>]*)>:? (.*?)( \((?:choose )?one of\)(?: \S+)*)? \([^()]*(?:\(\))?\)$"
COLUMNS = ("option", "default", "unit", "values", "meaning")


def default(text, meaning):
    """The default that help shows as '<now VALUE : formerly DEFAULT>', or the one that the meaning names."""
    if "required" in meaning:
        return "required"
    named = re.search(r"[;,] default:? ([^;]*)$", meaning)
    if named:
        return named.group(1)
    words = text.split(" : ")
    if len(words) == 1 and not re.fullmatch(r"[-0-9.,e+]+", text):
        return ""  # a list of names
    value = words[-1].replace("formerly", "").strip()
    return {"TRUE": "true", "FALSE": "false"}.get(value, re.sub(r"\.(?![0-9])", "", value))


def option(line):
    """An option from its line '  -name <value>: meaning (unit), in [0, 1] (one of) ...'; None if it is none."""
    found = re.match(LINE, line)
    if not found:
        return None
    name, value, meaning, choices = found.groups()
    choices = (choices or "").split(")")[-1].split()
    allowed = ", ".join(choices) if len(choices) <= CHOICES else "PETSc's"
    interval = re.search(r", in ([\[(]\S+, \S+[\])])$", meaning)
    if interval:
        meaning, allowed = meaning[:interval.start()], interval.group(1)
    elif value in ("TRUE : TRUE", "FALSE : FALSE"):
        allowed = "true, false"
    unit = re.search(UNIT, meaning) if allowed != "true, false" else None
    if unit:
        meaning = meaning[:unit.start()] + meaning[unit.end():]
    row = {"option": name, "default": default(value, meaning), "unit": unit.group(1) or unit.group(2) if unit else "",
           "values": allowed}
    meaning = re.sub(r"(, required|[;,] default:? [^;]*)$", "", meaning)
    row["meaning"] = meaning if meaning.split(":")[0] in choices else meaning[0].upper() + meaning[1:]
    return row


def groups(text):
    """{title: rows} of a text of help, advanced groups last. Options that differ in their direction share a row."""
    found, title = {}, None
    for line in text.splitlines():
        if re.fullmatch(r"\S.*:", line) and not line.startswith("Viewer"):
            title = line[:-1]
        row = option(line)
        if not row or title is None or title.startswith(PETSC) or title == EXAMPLE:
            continue
        rows = found.setdefault(title, [])
        alike = [r for r in rows if {**r, "option": 0} == {**row, "option": 0}]
        if alike and "-box_" in row["option"]:
            alike[0]["option"] += ", " + row["option"]
        else:
            rows.append(row)
    return dict(sorted(found.items(), key=lambda item: item[0].startswith("Advanced")))


def reference(text):
    """The list in markdown."""
    lines = [f"## {REFUSALS}", ""]
    for refusal in text.split(REFUSALS + ":\n")[1].split("\n-----")[0].strip().splitlines():
        lines.append("* " + re.sub(FEATURE, r"`\1`", refusal.strip()))
    lines.append("")
    for title, rows in groups(text).items():
        lines += ["## " + re.sub(r"(-\S+ \S+)$", r"`\1`", title), "", "| " + " | ".join(COLUMNS) + " |",
                  "|---" * len(COLUMNS) + "|"]
        for row in rows:
            names = ", ".join(f"`{name}`" for name in row["option"].split(", "))
            cells = [names] + [row[column].replace("|", "\\|") for column in COLUMNS[1:]]
            lines.append("| " + " | ".join(cells) + " |")
        lines.append("")
    return "\n".join(lines)


def main():
    process = runs.start("-help")
    runs.check(process.returncode == 0, "help", process.stderr[:300])
    with open(README, encoding="utf-8") as file:
        committed = file.read()
    head, tail = committed.split(MARKS[0])[0], committed.split(MARKS[1])[1]
    fresh = f"{head}{MARKS[0]}\n\n{reference(process.stdout)}\n{MARKS[1]}{tail}"
    if "--write" in sys.argv:
        with open(README, "w", encoding="utf-8") as file:
            file.write(fresh)
    else:
        runs.check(committed == fresh, "options_readme", "make options-reference writes it anew")
    runs.done()


if __name__ == "__main__":
    main()
