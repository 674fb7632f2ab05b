"""``auto`` for a disc: families of lines refined by optimisation until the energy is used, the best taken.

Waypoints are moved one, two or some together, for more of the worth seen and no more energy than there is; a
step may lose a little at first and nothing at the end (threshold accepting; G. Dueck, T. Scheuer 1990). The
same seed gives the same line.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.errors import InfeasibleError
from planner.progress import Stop, never
from planner.search.course import DiscSearch
from planner.search.upright import upright

Floats = NDArray[np.float64]

#: How many of the lines go on in each round, and trials of each.
ROUNDS = ((96, 100), (10, 500), (4, 2500))
#: Each is begun so often: first steps that take out a waypoint or put one in are seldom undone.
STARTED = 3
#: Steps by the disc's radius, as often small as large.
LEAST, MOST = 0.01, 0.6
#: What a step may lose at first, by the square of the disc's radius; at the end nothing.
ACCEPTED = 0.03
#: Arcs of lines that are tried have chords of so many radii of the disc.
COARSE = 0.25
#: Joules over the budget count as many times the worth that straight flight sees for them.
OVER = 8.0


@dataclass(frozen=True, slots=True)
class Refined:
    """A line found.

    Parameters
    ----------
    points
        Vertices, (N, 2).
    energy_j
        For all of it.
    worth
        Seen, by cells.
    """

    family: str
    waypoints: Floats
    points: Floats
    energy_j: float
    worth: float


def auto(
    search: DiscSearch, seed: int = 0, stop: Stop = never, rounds: Sequence[tuple[int, int]] = ROUNDS
) -> Refined:
    """The line that sees most and ends at the end within the energy.

    Parameters
    ----------
    rounds
        How many of the lines go on in each, and trials of each line.

    Raises
    ------
    InfeasibleError
        ``"energy"``: no line that was tried is within it.
    """
    asked, frame = search, upright(search)
    search = frame.search
    rng = np.random.default_rng(seed)
    lines = [_evaluated(search, family, waypoints) for family, waypoints in families(search)] * STARTED
    for most, trials in rounds:
        lines = [_climb(search, line, trials, rng, stop) for line in lines[:most]]
        lines.sort(key=lambda each: -_goodness(search, each.worth, each.energy_j))
    kept = [each for each in lines if each.energy_j <= search.glider.energy_j]
    if not kept:
        least_j = min((each.energy_j for each in lines), default=math.inf)
        raise InfeasibleError(
            "energy",
            "search",
            f"there are {search.glider.energy_j / 3600.0:.1f} Wh, and the least line tried takes "
            f"{least_j / 3600.0:.1f} Wh",
            "Raise the energy, or search less ground.",
        )
    best = max(kept, key=lambda each: each.worth)
    points = frame.back(search.line(best.waypoints)[0])
    return Refined(best.family, frame.back(best.waypoints), points, best.energy_j, asked.seen(points))


def families(search: DiscSearch) -> Iterator[tuple[str, Floats]]:
    """Waypoints of lanes both ways and of spirals, as dense as the disc and somewhat wider."""
    west_m, south_m, east_m, north_m = search.ground.bounds
    size = np.array([east_m - west_m, north_m - south_m])
    corner = np.array([west_m, south_m])
    for across in (0, 1):
        fewest = max(1, math.floor(size[across] / (2.0 * search.reach_m)))
        for count in (fewest, fewest + 1):
            for mirrored in (False, True):
                for turned in (False, True):
                    lanes = _lanes(count, min(0.5, 0.97 * search.reach_m / size[1 - across]))
                    lanes[:, 0] = 1.0 - lanes[:, 0] if mirrored else lanes[:, 0]
                    lanes[:, 1] = 1.0 - lanes[:, 1] if turned else lanes[:, 1]
                    places = lanes if across == 0 else lanes[:, ::-1]
                    name = "parallel" if across == int(np.argmin(size)) else "creeping"
                    yield name, corner + places * size
    rings = max(1, math.ceil(size.min() / (4.0 * search.reach_m)))
    spiral = _rings(rings)
    for quarter in range(4):
        turned_spiral = _turned(spiral, quarter)
        yield "spiral", corner + turned_spiral * size
        yield "square", corner + turned_spiral[::-1] * size


def _lanes(count: int, inset: float) -> Floats:
    """Corners of lanes to and fro over the unit square, from its south-west."""
    places = []
    for k in range(count):
        x = (k + 0.5) / count
        ends = (inset, 1.0 - inset) if k % 2 == 0 else (1.0 - inset, inset)
        places += [(x, ends[0]), (x, ends[1])]
    return np.array(places)


def _rings(count: int) -> Floats:
    """Corners of a spiral inwards over the unit square."""
    step = 0.5 / count
    places = [(step / 2.0, step / 2.0)]
    for k in range(count):
        low, high = (k + 0.5) * step, 1.0 - (k + 0.5) * step
        places += [(high, low), (high, high), (low, high), (low, min(low + step, high))]
    return np.array(places)


def _turned(places: Floats, quarters: int) -> Floats:
    for _ in range(quarters):
        places = np.column_stack([1.0 - places[:, 1], places[:, 0]])
    return places


def _climb(search: DiscSearch, best: Refined, trials: int, rng: np.random.Generator, stop: Stop) -> Refined:
    """A line moved for as long as that helps."""
    score = _goodness(search, best.worth, best.energy_j)
    at, level = best, score
    mean = float(search.worth.scores.max())
    for trial_number in range(trials):
        if stop():
            break
        left = 1.0 - trial_number / trials
        step_m = search.reach_m * math.exp(rng.uniform(math.log(LEAST), math.log(MOST)))
        trial = _evaluated(search, at.family, _moved(at.waypoints, step_m, rng))
        found = _goodness(search, trial.worth, trial.energy_j)
        if found > level - left * ACCEPTED * search.reach_m**2 * mean:
            at, level = trial, found
        if found > score:
            best, score = trial, found
    return best


def _moved(waypoints: Floats, step_m: float, rng: np.random.Generator) -> Floats:
    """One waypoint, a leg, or a run of them, moved by the same; all stretched; one put in or taken out."""
    moved = waypoints.copy()
    first = int(rng.integers(len(waypoints)))
    kind = rng.random()
    if kind < 0.03 and len(waypoints) > 2:
        return np.delete(moved, first, axis=0)
    if kind < 0.06:
        after = min(first + 1, len(waypoints) - 1)
        middle = 0.5 * (waypoints[first] + waypoints[after]) + rng.normal(0.0, step_m, 2)
        return np.insert(moved, after, middle, axis=0)
    if kind < 0.16:
        # All together, stretched along one axis.
        axis, middle = int(rng.integers(2)), waypoints.mean(axis=0)
        half_m = max(float(np.ptp(waypoints[:, axis])) / 2.0, step_m)
        stretch = 1.0 + rng.normal(0.0, step_m) / half_m
        moved[:, axis] = middle[axis] + stretch * (waypoints[:, axis] - middle[axis])
        return moved
    span = 1 if kind < 0.45 else 2 if kind < 0.85 else int(rng.integers(1, len(waypoints) + 1))
    way = rng.normal(0.0, step_m, 2)
    if rng.random() < 0.5:
        way[int(rng.integers(2))] = 0.0
    moved[first : first + span] += way
    return moved


def _evaluated(search: DiscSearch, family: str, waypoints: Floats) -> Refined:
    points, energy_j = search.line(waypoints, COARSE * search.reach_m)
    worth = search.seen(points) if math.isfinite(energy_j) else 0.0
    return Refined(family, waypoints, points, energy_j, worth)


def _goodness(search: DiscSearch, worth: float, energy_j: float) -> float:
    """Worth, less what is over the budget."""
    if not math.isfinite(energy_j):
        return -math.inf
    over_m = max(energy_j - search.glider.energy_j, 0.0) / search.glider.energy_j * search.glider.straight_m
    mean = float(search.worth.scores.max())
    return worth - OVER * over_m * 2.0 * search.reach_m * mean
