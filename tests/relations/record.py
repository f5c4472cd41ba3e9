"""What became of relations in scenes: '' if one holds, else why it does not apply, or what is wrong."""
import fcntl
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import runs  # noqa: E402

OUTPUT = os.path.join(runs.ROOT, "output", "tests", "relations.json")
WRONG = "wrong: "  # before a fate
# What is wrong and not cured, {(scene, relation): why}: it must still be wrong in its scene, or its row goes.
KNOWN = {("boat_at_wall/case", "books"): "liquid at rest rises by 0.05 % of its depth while the rows of its surface "
                                         "settle, more than a few coarse steps exchange",
         ("contact_angle/ball", "books"): "a drop on a ball gains 0.14 % of its surface energy as its edge settles",
         ("contact_angle/slope", "books"): "a drop on a slope gains a third of what it exchanges as its edge settles",
         ("bottle/case_3d", "books"): "water that hardly moves loses what its weight gives in 0.04 spacings as its "
                                      "coarse surface settles",
         ("random/99", "ends"): "a short last step changes speeds 3.1 times as much as two whole ones; the liquid of a "
                               "power law hardly shears",
         ("sinking_ball/case", "ends"): "a short last step changes speeds 3.2 times as much as two whole ones; "
                                        "the cause is not known",
         ("random/99", "stream"): "the viscosity of a power law is that of noise where liquid does not shear",
         ("channel/10", "books"): "syrup between a plate and a floor that slide, in steps of a twentieth of their way",
         **{(f"random/{k}", "books"): "strained graded rings gain 0.3 to 3 % of their kinetic energy"
            for k in (17, 50, 151)}}


def last():
    """{scene: {relation: fate}} of the last runs."""
    try:
        with open(OUTPUT, encoding="utf-8") as file:
            return json.load(file)
    except OSError:
        return {}


def keep(name, fates):
    """Adds to the fates of a scene; several parts may run at a time."""
    os.makedirs(os.path.dirname(OUTPUT), exist_ok=True)
    with open(OUTPUT + ".lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        table = last()
        table.setdefault(name, {}).update(fates)
        with open(OUTPUT, "w", encoding="utf-8") as file:
            json.dump(table, file, indent=1)
