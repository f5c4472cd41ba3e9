"""What a ladder of spacings and packings says of a value: the value, its error by the spacing, its error by chance.

The error by the spacing: a line value = limit + slope spacing through the means of all spacings, the last FEW at most,
says how far the finest is from the limit; to this comes the scatter of the means about the line. SPH with free surfaces
converges with order one, and single differences of two spacings are as often chance as not: the order that they suggest
is shown, but not believed. The bar is MARGIN times that. The error by chance is that of the mean of the packings at the
finest spacing. Where the last means go one way in steps that are no chance and do not shrink, no limit is to be seen,
and no error is given."""
import math

RATIO = math.sqrt(2)  # of two spacings that follow each other
FEW = 5
MARGIN = 1.25
TWICE = 2.0


def mean(values):
    return sum(values) / len(values)


def deviation(values):
    """The standard deviation of a sample."""
    m = mean(values)
    return math.sqrt(sum((v - m)**2 for v in values) / (len(values) - 1))


class Verdict:
    """value, spacing (error), chance (error), bar, order (nan: does not converge), words, share (of the bar, per
    cent)."""

    def __init__(self, rungs, size=0.0):
        """rungs: [(spacing, [values of the packings])], coarse to fine; size: what the share is of, 0: the value."""
        self.value = mean(rungs[-1][1])
        self.chance = chance(rungs)
        self.order = math.nan
        means = [mean(values) for _, values in rungs]
        if len(rungs) < 3:
            self.spacing = abs(means[-1] - means[-2]) * (1 + MARGIN) if len(rungs) == 2 else math.inf
            self.words = "two spacings only: no order" if len(rungs) == 2 else "one spacing: no error"
        else:
            self.converge(rungs, means)
        self.bar = math.hypot(self.spacing, self.chance)
        self.size = size or abs(self.value)
        self.share = 100 * self.bar / self.size if self.size else math.inf if self.bar else 0.0

    def converge(self, rungs, means):
        spacings, means = [spacing for spacing, _ in rungs][-FEW:], means[-FEW:]
        middle, level = mean(spacings), mean(means)
        slope = (sum((s - middle) * (m - level) for s, m in zip(spacings, means)) /
                 sum((s - middle)**2 for s in spacings))
        off = [m - level - slope * (s - middle) for s, m in zip(spacings, means)]
        scatter = math.sqrt(sum(o * o for o in off) / (len(off) - 2))
        self.spacing = MARGIN * math.hypot(slope * spacings[-1], scatter)
        steps = [fine - coarse for coarse, fine in zip(means, means[1:])]
        before, last = steps[-2:]
        one_way = all(step * last > 0 for step in steps)
        if len(steps) > 2 and one_way and abs(last) >= abs(steps[0]) and (
                min(map(abs, steps)) > math.sqrt(2) * self.chance):
            self.spacing = math.inf
            self.words = "the spacings go one way, in steps that do not shrink: no limit is seen"
            return
        if before * last > 0:
            self.order = math.log(before / last) / math.log(spacings[-2] / spacings[-1])
            self.words = f"the last three spacings go one way, with order {self.order:.2g}"
        elif max(abs(before), abs(last)) <= math.sqrt(2) * self.chance:
            self.words = "the last three spacings differ by no more than packings do"
        else:
            self.words = "the last three spacings go up and down"


def chance(rungs):
    """The error of the mean at the finest spacing by chance: TWICE the standard deviation of the mean, with that of the
    last two spacings that have several packings, pooled."""
    several = [values for _, values in rungs if len(values) > 1][-2:]
    if not several:
        return math.inf
    freedom = sum(len(values) - 1 for values in several)
    spread = math.sqrt(sum((len(values) - 1) * deviation(values)**2 for values in several) / freedom)
    return TWICE * spread / math.sqrt(len(rungs[-1][1]))
