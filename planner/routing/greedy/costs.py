"""What a route costs: eqs 10 and 25 of Li, Chen, Wang, Li (2018)."""

from __future__ import annotations

import math

from planner.route import Point
from planner.wishes import Objective


def path_length_ratio(length_m: float, start: Point, end: Point) -> float | None:
    """Path length ratio J1 of eq 10: length over the distance from start to end; None for a round trip."""
    direct_m = math.dist(start, end)
    return length_m / direct_m if direct_m > 0.0 else None


def weighted_cost(objective: Objective, length_ratio: float, missile: float, radar: float) -> float:
    """Weighted sum of J1, J2 and J3, eqs 22 and 25."""
    return objective.length * length_ratio + objective.missile * missile + objective.radar * radar
