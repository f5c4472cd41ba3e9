"""isph from Python: runs with options, their series and snapshots as arrays, answers with error bars, studies.

    import isph
    one = isph.run("ink.opts", wall_contact_angle=40, ink_velocity=(0, -6))   # waits; one.folder, one.log, one.scene
    one.series["highest"].max(), one.units["highest"]                         # arrays of series.csv, their SI units
    last = one.snapshots[-1]; last.time, last.position, last.velocity         # arrays of the liquid's particles
    many = isph.runs("ink.opts", wall_contact_angle=[20, 40, 60], jobs=2)     # every combination of the lists
    many.table(height=lambda run: run.series["highest"][-1])                  # a pandas table, where pandas is
    isph.answer("ink.opts", "highest:max", accuracy=5)                        # a value with its error bar
    isph.study("ink.opts", "highest:max", drop_velocity=[(0, -1), (0, -2)])   # a table
    isph.open_run("output/my")                                                # a run that is there already
    isph.measure("output/my", gauge_heights=(0.1, 0.2))                       # gauges that the run did not have
    with isph.Simulation("ink.opts") as now:                                  # a run that Python steps (libisph)
        now.step(); now.time, now.position, now.column("highest")

An option of the program is a keyword: -name 1,2 is name=(1, 2), and a list is what to vary. A run that was made before,
of the same scene and files with the same options by the same program, is not repeated (again=True repeats it). What
the program refuses is raised as isph.Error with its sentence, before anything is computed. Needs numpy, and h5py for
snapshots; pandas is used where it is installed. The program is that of this tree, of PATH, or $ISPH."""
import importlib

HOMES = {"tables": ("Error",), "launch": ("program",),
         "running": ("Run", "Runs", "Snapshot", "Snapshots", "open_run", "run", "runs"),
         "answers": ("Value", "answer", "study"), "fitting": ("Fit", "Fitted", "fit"), "measuring": ("measure",),
         "simulation": ("Simulation",)}
__all__ = sorted(name for names in HOMES.values() for name in names)


def __getattr__(name):
    """A module is read when one of its names is first used: tables of runs need no numpy."""
    home = next((home for home, names in HOMES.items() if name in names), None)
    if not home:
        raise AttributeError(f"isph has no {name}; it has {', '.join(__all__)}")
    return getattr(importlib.import_module("." + home, __name__), name)


def __dir__():
    return __all__
