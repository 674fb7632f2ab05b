"""Offsets η of the collection segments at the chosen angle: eq 22 of Li, Chen, Wang, Li (2018)."""

from __future__ import annotations

import math

import numpy as np

from planner.airspace.threats import line_risk
from planner.airspace.values import Threat
from planner.coverage.strips.choices import Choices, Side
from planner.route import Anchor, CollectPass
from planner.routing.greedy.costs import weighted_cost
from planner.wishes import Objective


def best_passes(
    origin: Anchor,
    region: Choices,
    side: Side,
    index: int,
    threats: tuple[Threat, ...],
    objective: Objective,
) -> tuple[CollectPass, ...]:
    """Eq 22: the pass, or the two passes, with the least cost at an angle, the first one first.

    Eq 10 divides a length by the distance between its ends, which for one straight leg is always 1. Here J1
    of the leg from the last collect is its length over what it would be at η = 0.5, so 1 means the middle
    line; the threat terms, summed over dividing points 100 m apart along the collect (eqs 12 and 14), weigh
    against it as in eq 25.

    Parameters
    ----------
    index
        Of the angle in ``side``.

    Returns
    -------
    tuple of CollectPass
        Of a distributed region the second has η₂ ≤ 1 − η₁.
    """
    grades = side.grades[index]
    firsts = np.flatnonzero((grades if region.turns == 0 else grades.min(axis=1)) == region.best)
    first, k = _best(origin, region, side, index, firsts, threats, objective, opposite=False)
    if region.turns == 0:
        return (first,)
    seconds = np.flatnonzero(grades[k] == region.best)
    leave = Anchor(*first.end, first.angle_rad)
    second, _ = _best(leave, region, side, index, seconds, threats, objective, opposite=True)
    return (first, second)


def _best(
    origin: Anchor,
    region: Choices,
    side: Side,
    index: int,
    open_: np.ndarray[tuple[int], np.dtype[np.intp]],
    threats: tuple[Threat, ...],
    objective: Objective,
    *,
    opposite: bool,
) -> tuple[CollectPass, int]:
    around = side.neighbourhood
    middle = around.lines(np.array([0.5]), opposite=opposite)[index, 0]
    unit_m = max(math.dist(origin.position, middle[0]), 1.0)
    lines = around.lines(region.etas, opposite=opposite)[index]
    costs = []
    for k in open_:
        missile, radar = line_risk(lines[k], threats)
        ratio = math.dist(origin.position, lines[k, 0]) / unit_m
        costs.append(weighted_cost(objective, ratio, missile, radar))
    best = int(open_[int(np.argmin(costs))])
    return around.collect(index, float(region.etas[best]), opposite=opposite), best
