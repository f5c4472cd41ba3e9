"""The work-precision chart of a sweep."""
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

MARKS = "os^vD<>phX*d"


def draw(rows, front, title, path):
    """Error against CPU time, one mark an axis, the Pareto front as a line, presets and the scene named."""
    figure, axes = plt.subplots(figsize=(9, 6.5), constrained_layout=True)
    names = list(dict.fromkeys(row["axis"] for row in rows))
    for k, name in enumerate(names):
        points = [row for row in rows if row["axis"] == name and math.isfinite(row["error"]) and row["error"] > 0]
        bold = name in ("scene", "preset")
        axes.scatter([p["seconds"] for p in points], [p["error"] for p in points], s=90 if bold else 36,
                     marker=MARKS[k % len(MARKS)], color=f"C{k % 10}", edgecolors="k" if bold else "none",
                     linewidths=0.8, label=name, zorder=3 if bold else 2)
    line = sorted(front, key=lambda row: row["seconds"])
    axes.plot([p["seconds"] for p in line], [p["error"] for p in line], "k-", lw=1, alpha=0.6, label="Pareto front",
              zorder=1)
    named = {id(row): row for row in line + [r for r in rows if r["axis"] in ("scene", "preset")]}.values()
    for k, row in enumerate(r for r in named if math.isfinite(r["error"])):
        words = row["label"] if row["axis"] == "preset" else "the scene" if row["axis"] == "scene" else \
            f"{row['axis']}: {row['label']}"
        axes.annotate(words, (row["seconds"], row["error"]), xytext=(6, 6 if k % 2 else -11),
                      textcoords="offset points", fontsize=8, fontweight="bold" if row["axis"] == "preset" else None)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("CPU time, s")
    axes.set_ylabel("error")
    axes.set_title(title, fontsize=10)
    axes.grid(True, which="both", alpha=0.25)
    axes.legend(fontsize=8, loc="best", ncol=2)
    figure.savefig(path, dpi=110)
    plt.close(figure)
