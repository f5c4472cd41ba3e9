"""The table and the map of make extremes."""
import csv
import os
import subprocess

import runs

COLORS = {"works": "#5aa469", "handled": "#b9d77c", "refused": "#9fb8d6", "stopped": "#e9b44c", "FAILED": "#d1495b"}
HERE = os.path.dirname(os.path.abspath(__file__))


def picture(lines, path, width=13, dpi=110):
    """The stability map: a row for each axis, a cell for each value, its outcome as colour."""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    axes = list(dict.fromkeys(line["axis"] for line in lines))
    figure, plot = plt.subplots(figsize=(width, 0.36 * len(axes) + 0.8))
    for row, axis in enumerate(axes):
        cells = [line for line in lines if line["axis"] == axis]
        for k, line in enumerate(cells):
            plot.barh(-row, 0.98 / len(cells), left=k / len(cells), height=0.9, color=COLORS[line["outcome"]])
            words = line["value"].split(", ") if len(line["value"]) * len(cells) > 150 else [line["value"]]
            label = "\n".join(words) if len(words) > 1 else "\n".join(wrapped(words[0], 160 // len(cells)))
            plot.text((k + 0.49) / len(cells), -row, label, ha="center", va="center", fontsize=6)
    plot.set_yticks([-row for row in range(len(axes))], axes)
    plot.set_xticks([])
    plot.set_xlim(0, 1)
    plot.set_ylim(-len(axes) + 0.5, 0.5)
    plot.set_frame_on(False)
    plot.legend([plt.Rectangle((0, 0), 1, 1, color=c) for c in COLORS.values()], COLORS, ncol=5, loc="lower center",
                bbox_to_anchor=(0.5, 1.0), frameon=False)
    figure.tight_layout()
    figure.savefig(path, dpi=dpi)


def wrapped(text, width):
    """The words of a text in lines of at most about this many characters."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines


def table(lines):
    """A row for each axis, and what the lines about predicted limits say."""
    kinds = list(COLORS)
    rows = ["| axis | tried | " + " | ".join(kinds).lower() + " | energy gained, at most |", "| --- " * 8 + "|"]
    for axis in dict.fromkeys(line["axis"] for line in lines):
        cells = [line for line in lines if line["axis"] == axis]
        counts = [sum(line["outcome"] == kind for line in cells) or "" for kind in kinds]
        gained = max(float(line["energy gained"] or 0) for line in cells)
        values = "; ".join(line["value"] for line in cells)
        rows.append(f"| {axis} | {values} | " + " | ".join(map(str, counts)) + f" | {100 * gained:.1f} % |")
    rows += [""] + [f"- {line['value']}: {line['remark']}" for line in lines if line["axis"] == "step over limit"]
    failed = [f"- {line['axis']} {line['value']}: {line['remark']}" for line in lines if line["outcome"] == "FAILED"]
    return rows + (["", "Failed:", ""] + failed if failed else [])


def keep(lines, folder, root):
    """Writes the table, the map and the version of the program."""
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "extremes.csv"), "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(lines[0]))
        writer.writeheader()
        writer.writerows(lines)
    version = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=root, stdout=subprocess.PIPE,
                             universal_newlines=True, check=False).stdout.strip()
    with open(os.path.join(folder, "version.txt"), "w", encoding="utf-8") as file:
        file.write(version + "\n")
    picture(lines, os.path.join(folder, "extremes.png"))


def readme(folder):
    """Writes the table of the README beside this file, and the map."""
    with open(os.path.join(folder, "extremes.csv"), newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    with open(os.path.join(folder, "version.txt"), encoding="utf-8") as file:
        version = file.read().strip()
    body = "\n".join(table(lines) + ["", f"{len(lines)} runs; written by `make extremes-readme` at version {version}."])
    runs.replace(os.path.join(HERE, "README.md"), "extremes", f"\n{body}\n")
    picture(lines, os.path.join(HERE, "map.png"), 11, 80)
