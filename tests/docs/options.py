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
CHOICES = 12  # that a line holds
MARKS = "<!-- options -->", "<!-- /options -->"
UNITS = (  # the rule
    "A unit behind a number is converted once; dumps and all files of a run have SI. It stands without a blank,",
    '`0.1mm`, or both in quotation marks, `"0.1 mm"`. In a list the unit of the last number is that of all',
    "without one, and 0 needs none: `0,1.5mm` is 0 and 1.5 mm. A blank within a unit may be left out, or be a dot.")
NUMBER = r"[-+\d.][\d.e+-]*"
# An option of a refusal, and its value.
FEATURE = r"(?<!\S)-[\w<>]+(?: (?!or |without )[\w<>]+)?"


def code(text):
    """Options of a refusal as code."""
    return re.sub(FEATURE, r"`\g<0>`", text)


def interval(text):
    """An interval of -options_json, an end that is infinite left out."""
    low, _, high = (text or "(-inf, inf)").partition(", ")
    return text if high != "inf)" else "" if low == "(-inf" else ("≥ " if low[0] == "[" else "> ") + low[1:]


def head(option):
    """`-name value` unit, what else it may be."""
    default, values = option["default"], option.get("values", [])
    literal = re.fullmatch(f"{NUMBER}(,{NUMBER})*|true|false|output/.*", default) or default in values
    default = "0" if re.fullmatch(r"0(,0)*", default) else default
    unit = "" if option["unit"] in (None, "1") else " " + option["unit"]
    facts = [f"`{option['name']}{' ' + default if literal else ''}`{unit}", interval(option["range"]),
             ", ".join(value for value in values if value != default) if len(values) <= CHOICES else "",
             "" if literal or default == "none" else default]
    return ", ".join(filter(None, facts))


def meaning(option):
    """What it is, for which choices, and what 0 means; -help has the details."""
    first, *more = re.split(r"; (?![^(]*\))", option["meaning"])
    choices = ", ".join(word.split()[-1] for word in option["choice"].split(", ") if word)
    zero = [clause for clause in more if clause.startswith("0: ")]
    return "; ".join([first + f" ({choices})" * bool(choices), *zero])


def sections(options):
    """{title: {line: None}}: choices, and what differs in its direction, stand once."""
    found = {}
    for option in options:
        lines = found.setdefault(re.split(r", | with -|: ", option["group"])[0], {})
        lines[f"- {head(option)}: {meaning(option)}"] = None
    return found


def reference(known):
    """The list in markdown."""
    lines, apart = ["## What cannot be used together", "", "A run that is refused says why.", ""], {}
    for refusal in known["refusals"]:
        apart.setdefault((refusal["other"], refusal["relation"]), []).append(code(refusal["one"]))
    lines += [f"- {code(other)}, {'needed by' if relation == 'needs' else 'not with'}: {'; '.join(ones)}"
              for (other, relation), ones in apart.items()]
    lines += ["", "## Units", "", *UNITS, ""]
    lines += [f"- {unit}: {', '.join(others)}" for unit, others in known["units"].items()] + [""]
    for title, items in sections(known["options"]).items():
        lines += [f"## {title}", "", *items, ""]
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
