"""The table of the runs that are finished: means over waters, and t-intervals of the differences."""

import math

import ways
from scipy import stats

TITLES = {"lit": "lit by their own water", "as-is": "as they are: white light"}


def interval(differences):
    """The mean, and what lies within a 95 % t-interval of it."""
    count = len(differences)
    mean = sum(differences) / count
    if count < 2:
        return f"{mean:+.3f}"
    deviation = math.sqrt(sum((value - mean) ** 2 for value in differences) / (count - 1))
    half = stats.t.ppf(0.975, count - 1) * deviation / math.sqrt(count)
    return f"{mean:+.3f} ({mean - half:+.3f} to {mean + half:+.3f})"


def of(runs, steps, waters, batch, trained):
    """Both kinds of scenes, turbid waters apart."""
    parts = [
        f"Mean intersection over union in a water not seen; {trained} images in two other waters, {steps} steps of {batch} images "
        f"from scratch, everything drawn again each step; a run a water, of {waters}. Differences are between runs of the same "
        "water, with 95 % t-intervals over waters."
    ]
    for kind in TITLES:
        by_way = {way: {one["water"]: one for one in runs if (one["kind"], one["way"]) == (kind, way)} for way in ways.WAYS}
        if not any(by_way.values()):
            continue
        parts += ["", f"Scenes {TITLES[kind]}:", ""]
        parts.append("| way | runs | mean | beside none | beside ColorJitter | beside ColorJitter in turbid waters | at home |")
        parts.append("|---|---|---|---|---|---|---|")
        for way, found in by_way.items():
            if found:
                parts.append(row(way, found, by_way["none"], by_way["ColorJitter"]))
    return "\n".join(parts)


def row(way, found, none, jitter):
    def beside(other, only_turbid=False):
        both = [water for water in found if water in other and (found[water]["turbid"] or not only_turbid)]
        if found is other or not both:
            return ""
        text = interval([found[water]["away"] - other[water]["away"] for water in both])
        return f"{text}, {len(both)}" if only_turbid else text

    def mean(name):
        return f"{sum(one[name] for one in found.values()) / len(found):.3f}"

    cells = [way, str(len(found)), mean("away"), beside(none), beside(jitter), beside(jitter, True), mean("home")]
    return "| " + " | ".join(cells) + " |"
