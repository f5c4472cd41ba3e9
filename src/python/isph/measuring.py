"""Columns of a run that is done, from its snapshots: -measure."""
import os

import numpy as np

from . import launch, tables
from .running import Run, words_of


def measure(run, **options):
    """The columns of a run's series at the times of its snapshots, with gauges that it did not have:
    measure(run, gauge_heights=(0.2, 0.4)). run: a Run or its folder. Returns {name: array}, time among them; what only
    the run itself knows, as its steps and works, is not there. Forces need -snapshot_walls of the run, else they are
    nan."""
    folder, words = os.fspath(run.folder if isinstance(run, Run) else run), words_of(options)
    launch.call([launch.program(), "-measure", folder, *words])
    known = launch.known.__wrapped__(os.path.join(folder, "options.opts"), *words)
    names = {row["head"]: row["name"] for row in known["columns"] if row["file"] == "series.csv"}
    table = tables.read_table(os.path.join(folder, "measured.csv"), names)
    return {name: np.array(values) for name, values in table.items()}
