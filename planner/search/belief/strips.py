"""Patterns and lines for something that drifts, as strips of ground in flight order."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.drifting import Drifting
from planner.search.belief.patterns import LEGGED, PATTERNS, Searcher, Shape, pattern_lines
from planner.search.programme import Pricing
from planner.search.straights import strips_along

Floats = NDArray[np.float64]

#: The manual's patterns under the names of ours.
FAMILIES = {
    "expanding-square": "square",
    "sector": "sector",
    "parallel-track": "parallel",
    "creeping-line": "creeping",
}
#: Shapes that patterns are laid in.
SPACINGS, COURSES, SIZES = (0.9, 1.1), 4, (0.6, 0.8, 1.0)
#: Flights with nothing to limit them search so many errors' width.
MOST_TRACK_M = 1e6


def drifting_strips(
    drifting: Drifting, pricing: Pricing, width_m: float, budget_m: float, seed: int
) -> Iterator[tuple[str, Floats]]:
    """Strips (N, 2, 2) of patterns about the datum, at rest or moving on with it, with their families.

    Parameters
    ----------
    budget_m
        Metres through the air, for the whole flight.
    """
    model = pricing.model
    speed = model.aircraft.airspeed_m_s
    until_s = min(budget_m, MOST_TRACK_M) / speed
    radius_m = model.turn_radius_m
    target = drifting.target()
    searcher = Searcher(pricing.start, speed, radius_m, until_s, 0.5 * width_m, drifting.detection)
    east, north = target.drift_m_s
    with_drift_rad = math.atan2(north, east) - 0.5 * math.pi
    for name, spacing, moving, size, turn in itertools.product(
        PATTERNS, SPACINGS, (False, True), SIZES, range(COURSES)
    ):
        course_rad = with_drift_rad + math.tau * turn / COURSES
        for outward in (False, True) if name in LEGGED else (False,):
            shape = Shape(spacing, course_rad, size, moving, 0.5, outward)
            (line,) = pattern_lines(name, target, (searcher,), shape)
            yield FAMILIES[name], strips_along(line[:, :2], radius_m, width_m)
