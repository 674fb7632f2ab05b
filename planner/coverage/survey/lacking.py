"""How much room an operating area lacks for the lanes over a region."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.lines import flown_straight
from planner.coverage.survey.lanes import Survey, lanes_at

Floats = NDArray[np.float64]

#: Headings looked at are so far apart.
STEP_RAD = math.radians(10.0)


def lacking_m(survey: Survey, around: Surroundings) -> float:
    """How far lanes and the straight flight before them lie outside the area, at the best heading."""
    if around.area is None:
        return 0.0
    angles_rad: Floats = np.arange(0.0, math.pi, STEP_RAD)
    angles_rad = angles_rad[survey.frames(angles_rad).good]
    found = [math.inf]
    for angle_rad, count in zip(angles_rad, survey.counts(angles_rad), strict=True):
        lines = lanes_at(survey, np.array([angle_rad]), np.ones(1), int(count)).lines[0, 0]
        ends = shapely.points(flown_straight(lines, around.settle_m))
        # A lane is flown the way that leaves the area less.
        out_m = shapely.distance(around.area, ends).max(axis=-1).min(axis=-1)
        found.append(float(out_m.max()))
    return min(found)
