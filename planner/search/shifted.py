"""Strips of a search moved each by itself, for more of the worth found within the same budget.

A strip is moved aside, made longer or shorter, turned, flown the other way, taken out, put in beside another,
or comes elsewhere in the order; or all are moved together. A step may lose a little at first and nothing at
the end (threshold accepting; G. Dueck, T. Scheuer 1990). The same seed gives the same strips.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from planner.progress import Stop
from planner.search.programme import Programme, Sweep

Floats = NDArray[np.float64]

#: Steps tried: so many, and so many more for each strip.
TRIALS, TRIALS_EACH, MOST_TRIALS = 300, 30, 1500
#: Steps by the width of the swath, as often small as large.
LEAST, MOST = 0.02, 1.0
#: What a step may lose at first, of the worth of one strip; at the end nothing.
ACCEPTED = 0.05
#: Of two that find as much, which is shorter: the whole budget counts as this part of the worth.
SHORTER = 1e-3
#: All that there is to be found, but for this.
ALL = 1e-6
#: Strips turn by so many radians for each step that is as large as they are long.
TURNED = 1.0


def strip_of(sweep: Sweep) -> Floats:
    """The middle line of the ground that a pass sees, (2, 2)."""
    along, swath = sweep.along, sweep.swath
    aside = swath.middle_m * np.array([-along[1], along[0]])
    start = np.asarray(sweep.start) + aside + swath.run_in_m * along
    end = np.asarray(sweep.end) + aside - swath.run_out_m * along
    return np.stack([start, end])


def shifted(
    strips: Floats,
    tried: Callable[[Floats], Programme | None],
    width_m: float,
    total: float,
    seed: int,
    enough: Stop,
) -> Programme | None:
    """The best programme found from strips (N, 2, 2); None where they cannot be flown.

    Parameters
    ----------
    tried
        The programme that flies strips within the budget.
    total
        All that can be found.
    enough
        Asked between steps: ends them with the best found.
    """
    rng = np.random.default_rng(seed)
    best = at = tried(strips)
    if best is None or at is None:
        return None
    level = _goodness(best, total)
    score = level
    trials = min(MOST_TRIALS, TRIALS + TRIALS_EACH * len(strips))
    for number in range(trials):
        if best.worth >= (1.0 - ALL) * total or enough():
            break
        step_m = width_m * math.exp(rng.uniform(math.log(LEAST), math.log(MOST)))
        trial = tried(_moved(at.strips, step_m, width_m, rng))
        if trial is None:
            continue
        found = _goodness(trial, total)
        left = 1.0 - number / trials
        if found > level - left * ACCEPTED * best.worth / len(best.sweeps):
            at, level = trial, found
        if found > score:
            best, score = trial, found
    return best


def _goodness(programme: Programme, total: float) -> float:
    return programme.worth - SHORTER * total * programme.cost_m / (programme.cost_m + 1e6)


def _moved(strips: Floats, step_m: float, width_m: float, rng: np.random.Generator) -> Floats:
    """One step from strips."""
    moved = strips.copy()
    k = int(rng.integers(len(strips)))
    side = moved[k, 1] - moved[k, 0]
    length_m = max(float(np.hypot(*side)), 1e-6)
    along = side / length_m
    across = np.array([-along[1], along[0]])
    way_m = float(rng.normal(0.0, step_m))
    kind = rng.random()
    if kind < 0.25:
        moved[k] += way_m * across
    elif kind < 0.55:
        end = int(rng.integers(2))
        longer = moved[k, end] + (2.0 * way_m) * along
        moved[k, end] = (
            longer if (longer - moved[k, 1 - end]) @ along * (2 * end - 1) > 0.0 else moved[k, end]
        )
    elif kind < 0.65:
        turn = TURNED * way_m / length_m
        moved[k] += np.array([-1.0, 1.0])[:, None] * (0.5 * turn * length_m) * across
    elif kind < 0.70:
        moved[k] = moved[k, ::-1]
    elif kind < 0.78 and len(strips) > 1:
        other = int(rng.integers(len(strips)))
        low, high = min(k, other), max(k, other)
        moved[low : high + 1] = moved[low : high + 1][::-1, ::-1]
    elif kind < 0.84 and len(strips) > 1:
        taken = moved[k].copy()
        rest = np.delete(moved, k, axis=0)
        moved = np.insert(rest, int(rng.integers(len(rest) + 1)), taken, axis=0)
    elif kind < 0.88 and len(strips) > 1:
        moved = np.delete(moved, k, axis=0)
    elif kind < 0.92:
        beside = moved[k, ::-1] + math.copysign(width_m, way_m) * across
        moved = np.insert(moved, k + 1, beside, axis=0)
    elif kind < 0.96:
        moved += rng.normal(0.0, step_m, 2)
    else:
        # Along or across, all of them.
        middle, first = moved.reshape(-1, 2).mean(axis=0), np.stack([along, across])
        own = (moved - middle) @ first.T
        half_m = max(0.5 * float(np.ptp(own.reshape(-1, 2), axis=0).max()), width_m)
        own[..., int(rng.integers(2))] *= 1.0 + way_m / half_m
        moved = middle + own @ first
    return moved


def moves(strips: Floats, part: float, width_m: float) -> Iterator[Floats]:
    """Strips moved along and across the first of them, stretched along both, and turned."""
    middle = strips.reshape(-1, 2).mean(axis=0)
    first = strips[0, 1] - strips[0, 0]
    along = first / max(float(np.hypot(*first)), 1e-9)
    axes = np.array([along, [-along[1], along[0]]])
    own = (strips - middle) @ axes.T
    for axis in (0, 1):
        for way in (-part, part):
            yield middle + (own + way * width_m * np.eye(2)[axis]) @ axes
            yield middle + (own * (1.0 + 0.2 * way * np.eye(2)[axis])) @ axes
    for turn_rad in (-part * math.radians(12.0), part * math.radians(12.0)):
        cos, sin = math.cos(turn_rad), math.sin(turn_rad)
        yield middle + own @ np.array([[cos, sin], [-sin, cos]]) @ axes
