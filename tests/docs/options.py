#!/usr/bin/python3
"""options/options.json and options/README.md have every option, and what cannot be used together, as isph -options_json
writes them. Without arguments a test that they do; --write writes both (make options-reference)."""
import json
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import runs  # noqa: E402

FOLDER = os.path.join(runs.ROOT, "options")
README, LIST = os.path.join(FOLDER, "README.md"), os.path.join(FOLDER, "options.json")
FORM = os.path.join(FOLDER, "form.html")
ROWS = '<script id="rows" type="application/json">', "</script>\n<!-- /rows -->"
MARKS = "<!-- options -->", "<!-- /options -->"
FEATURE = r"(?<!\S)(-[\w<>]+(?: (?!cannot|needs|yet)[\w<>]+)?)"
CHOICES = 12  # that a cell holds
UNITS = (  # the rule
    "A unit behind a number is converted once; dumps and all files of a run have SI. It stands without a blank,",
    '`0.1mm`, or both in quotation marks, `"0.1 mm"`. In a list the unit of the last number is that of all',
    "without one, and 0 needs none: `0,1.5mm` is 0 and 1.5 mm. A blank within a unit may be left out, or be a dot.")
COLUMNS = ("option", "default", "unit", "values", "meaning")


def cells(row):
    """The cells of an option, but for its name."""
    default = "0" if re.fullmatch(r"0(,0)*", row["default"]) else row["default"]
    values = row.get("values", ["true", "false"] if row["kind"] == "bool" else [])
    allowed = ", ".join(values) if len(values) <= CHOICES else "PETSc's"
    meaning = row["meaning"] + f" ({row['choice']})" * (", " in row["choice"])
    return [default, row["unit"] or "", row["range"] or allowed, meaning]


def groups(options):
    """{title: [[names, cells...]]}. Options that differ in their direction share a row."""
    found = {}
    for option in options:
        rows = found.setdefault(option["group"], [])
        alike = [row for row in rows if row[1:] == cells(option) and "-box_" in option["name"]]
        if alike:
            alike[0][0].append(option["name"])
        else:
            rows.append([[option["name"]], *cells(option)])
    return found


def reference(known):
    """The list in markdown."""
    lines = ["## What cannot be used together", ""]
    for refusal in known["refusals"]:
        text = f"{refusal['one']} {refusal['relation']} {refusal['other']}{refusal['rest']}"
        lines.append("* " + re.sub(FEATURE, r"`\1`", text))
    lines += ["", "## Units", "", *UNITS, "", "| an option in | may have |", "|---|---|"]
    lines += [f"| {unit} | {', '.join(others)} |" for unit, others in known["units"].items()] + [""]
    for title, rows in groups(known["options"]).items():
        lines += ["## " + re.sub(r"(-\S+ \S+)$", r"`\1`", title), "", "| " + " | ".join(COLUMNS) + " |",
                  "|---" * len(COLUMNS) + "|"]
        for names, *rest in rows:
            row = [", ".join(f"`{name}`" for name in names)] + [cell.replace("|", "\\|") for cell in rest]
            lines.append("| " + " | ".join(row) + " |")
        lines.append("")
    return "\n".join(lines)


def rows(known):
    """What the form knows of each option."""
    keys = ("name", "kind", "unit", "range", "values", "default", "meaning", "group")
    text = json.dumps([[option.get(key) for key in keys] for option in known["options"]], ensure_ascii=False,
                      separators=(",", ":"))
    return text.replace("</", "<\\/").replace("],[", "],\n[")


def sound(option):
    """Whether the row of an option says all that it should."""
    number = option["kind"] in ("real", "int", "point", "direction", "numbers")
    listed = option["kind"] in ("word", "choice") or option["kind"] == "names" and "values" in option
    return option["meaning"][:1] and option["place"] and option["group"] and (
        not number or option["unit"]) and ("values" in option) == listed


def main():
    path = runs.scratch("options.json")
    process = runs.start(["-options_json", path])
    runs.check(process.returncode == 0, "list", process.stderr[:300])
    with open(path, encoding="utf-8") as file:
        text = file.read()
    known = json.loads(text)
    bad = [option["name"] for option in known["options"] if not sound(option)]
    runs.check(len(known["options"]) > 150 and not bad, "rows", f"{len(known['options'])} rows; not whole: {bad}")
    with open(README, encoding="utf-8") as file:
        committed = file.read()
    head, tail = committed.split(MARKS[0])[0], committed.split(MARKS[1])[1]
    with open(FORM, encoding="utf-8") as file:
        form = file.read()
    form = form.split(ROWS[0])[0] + ROWS[0] + rows(known) + ROWS[1] + form.split(ROWS[1])[1]
    page = f"{head}{MARKS[0]}\n\n{reference(known)}\n{MARKS[1]}{tail}"
    for file_path, fresh in ((LIST, text), (FORM, form), (README, page)):
        if "--write" in sys.argv:
            with open(file_path, "w", encoding="utf-8") as file:
                file.write(fresh)
        else:
            with open(file_path, encoding="utf-8") as file:
                runs.check(file.read() == fresh, os.path.basename(file_path), "make options-reference writes it anew")
    runs.done()


if __name__ == "__main__":
    main()
