"""Values with error bars and studies: make answer and make study, from Python."""
import csv
import os
import sys
import typing

from . import launch
from .running import name_of, table_of, word


class Value(typing.NamedTuple):
    """A quantity with its error bar, and what the bar comes from."""
    quantity: str
    value: float
    bar: float
    unit: str
    by_spacing: float
    by_packing: float

    def __str__(self):
        return f"{self.quantity} = {self.value:.5g} +- {self.bar:.2g} {self.unit}".rstrip()


def columns_of(path):
    """The columns of a CSV file; numbers where all are."""
    with open(path, newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    columns = {}
    for name, texts in zip(head, zip(*rows)):
        try:
            texts = [float(text) for text in texts]
        except ValueError:
            pass
        columns[f"{list(columns)[-1]} {name}" if name == "+-" else name] = list(texts)
    return columns


def ask(name, scene, quantity, output, words):
    """Calls answer.py or study.py; the folder."""
    output = os.fspath(output or os.path.join("output", "python", name_of(scene), name))
    launch.call([sys.executable, launch.tool(f"answers/{name}.py"), os.fspath(scene), "--quantity", quantity,
                 "--output", output, *words])
    return output


def answer(scene, quantity, accuracy=5, budget=600, jobs=1, output=None):
    """A quantity (COLUMN:TAKE, as "highest:max"; several separated by commas) with its error by spacing and packing, to
    so many per cent, for at most so many processor seconds (make answer; tests/answers/README.md). A Value, or a list
    of them."""
    folder = ask("answer", scene, quantity, output,
                 ["--accuracy", str(accuracy), "--budget", str(budget), "--jobs", str(jobs)])
    columns = columns_of(os.path.join(folder, "answer.csv"))
    found = [Value(*row) for row in zip(*(columns[name] for name in Value._fields))]
    return found if len(found) > 1 else found[0]


def study(scene, quantity, accuracy=0, budget=600, jobs=1, output=None, **options):
    """A table of quantities for all values of one or two options, which are lists (make study): a pandas table where
    pandas is installed, else {head: values}. accuracy: with error bars."""
    varied = " ".join(f"{name}=" + ";".join(map(word, values)) for name, values in options.items())
    folder = ask("study", scene, quantity, output,
                 ["--vary", varied, "--accuracy", str(accuracy), "--budget", str(budget), "--jobs", str(jobs)])
    return table_of(columns_of(os.path.join(folder, "_".join(options), "study.csv")))
