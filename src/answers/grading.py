"""Whether the runs of an answer have one spacing everywhere or one that follows the liquid (-spacing_follow auto).

After the first two spacings the same two run with the spacing that follows, if that costs no more than TRIAL of what is
left. At the same spacing both make about the same error, if their values agree within sqrt(2) of the narrower bar; so
that way is taken which comes to the finer spacing in the time that is left: a run costs the spacing to the power of
-growth, by the last two. The bars of the first spacings are too uncertain to tell more (tests/answers/README.md)."""
import math

import ladder
from isph import launch, tables

COARSEST = 4  # times the spacing, far from what it follows: that of cases/drop_impact/following.opts
LEVELS, PACKINGS = 2, 2  # of a trial
TRIAL = 0.4  # of the time that is left, for it
GAIN = 0.8  # of the spacing that one spacing would come to: less is not worth a change
UNIFORM, FOLLOWING = "uniform", "following"


def options(way, spacing):
    """Those of a run."""
    return ["-spacing_coarse", f"{COARSEST * spacing:.6g}", "-spacing_follow", "auto"] if way == FOLLOWING else []


def refused(scene, more, spacing):
    """Why the spacing cannot follow the liquid in this scene; "": it can."""
    given = [option["name"] for option in launch.known(scene, *more)["options"] if option["given"]]
    own = [name for name in ("-spacing_coarse", "-spacing_follow") if name in given]
    if own:
        return f"the scene has {own[0]}"
    try:
        launch.known(scene, *more, *options(FOLLOWING, spacing), "-spacing", f"{spacing:.6g}")
    except tables.Error as error:
        return str(error)
    return ""


def reach(answer, left):
    """The finest spacing (m) that a ladder comes to in so many seconds."""
    spacing, runs = answer.rungs[-1]
    last, growth = ladder.mean([run.cpu for run in runs]), answer.growth()
    finer = left * (1 - ladder.RATIO**-growth) / last  # the last of runs whose sum is what is left, over today's
    return spacing * max(finer, 1)**(-1 / growth)


def row(answer, left):
    """What the record says of a way."""
    spacing, runs = answer.rungs[-1]
    return {"way": answer.way, "spacing": spacing, "seconds": ladder.mean([run.cpu for run in runs]),
            "reach": reach(answer, left),
            "quantities": [{"quantity": q.text, "value": v.value, "bar": v.bar}
                           for q, v in zip(answer.quantities, answer.verdicts())]}


class Choice:
    """The way that is taken and why; words: one line; ways: rows of what was compared, none: nothing was."""

    def __init__(self, way, why, ways=()):
        self.way, self.why, self.ways = way, why, list(ways)

    def words(self):
        said = [f"{one['way']} {', '.join('{value:.4g} +- {bar:.2g}'.format(**q) for q in one['quantities'])} for "
                f"{one['seconds']:.3g} s a run at {one['spacing']:.3g} m, would come to {one['reach']:.3g} m"
                for one in self.ways]
        return f"{self.way}: {self.why}" + (f" ({'; '.join(said)})" if said else "")


def judge(rows):
    """The choice between the rows of both ways."""
    uniform, following = rows
    for u, f in zip(uniform["quantities"], following["quantities"]):
        if not abs(u["value"] - f["value"]) <= math.sqrt(2) * min(u["bar"], f["bar"]):
            return Choice(UNIFORM, f"{u['quantity']} differs where the spacing follows the liquid", rows)
    if following["reach"] < GAIN * uniform["reach"]:
        return Choice(FOLLOWING, "it comes to a finer spacing in the time that is left", rows)
    return Choice(UNIFORM, "a spacing that follows the liquid gains too little", rows)


def choose(uniform, following):
    """The choice after LEVELS spacings of 'uniform'; 'following' runs the same ones, if that pays."""
    left, bars = uniform.left(), uniform.verdicts()
    if all(v.share <= ladder.RATIO * uniform.arguments.accuracy for v in bars):
        return Choice(UNIFORM, "the next spacing may be enough")
    why = refused(uniform.scene, uniform.more, uniform.rungs[-1][0])
    if why:
        return Choice(UNIFORM, f"none that follows the liquid: {why}")
    cost = PACKINGS * sum(ladder.mean([run.cpu for run in runs]) for _, runs in uniform.rungs)
    if cost > TRIAL * left:
        return Choice(UNIFORM, f"to try one that follows the liquid would cost {cost:.3g} s of the {left:.3g} s left")
    following.spent = uniform.spent
    for spacing, _ in uniform.rungs:
        good = following.run(spacing, range(uniform.seed, uniform.seed + PACKINGS))
        if not good:
            return Choice(UNIFORM, f"no run that follows the liquid ended at {spacing:.3g} m: {following.notes[-1]}")
        following.rungs.append((spacing, good))
    uniform.spent, following.tried = following.spent, PACKINGS
    return judge([row(one, following.left()) for one in (uniform, following)])


def doubt(quantities, before, after):
    """In words, where the answer with a spacing that follows the liquid is not within the bars of one spacing; ""."""
    return "; ".join(f"with one spacing {q.text} was {u.value:.4g} +- {u.bar:.2g}"
                     for q, u, f in zip(quantities, before, after)
                     if abs(u.value - f.value) > math.hypot(u.bar, f.bar))
