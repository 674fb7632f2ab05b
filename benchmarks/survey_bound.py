"""What no order of lanes comes below.

Lanes as surveys lay them, at the headings and offsets of a fine grid, and turns of which each joins two ends
of lanes as cheaply as any does. A tour joins all ends of its lanes but two in pairs: of such pairings the
cheapest is no longer than its turns, and half of an assignment of an end to each no longer than that.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from shapely.geometry import Polygon

from planner.coverage.merge import split_region
from planner.coverage.survey.headings import headings
from planner.coverage.survey.lanes import Survey, lanes_at
from planner.dubins.kernels import dubins_lengths
from planner.sensors.camera import CameraSensor
from planner.wishes import Region

Floats = NDArray[np.float64]

#: Headings and offsets looked at, and how many lanes more than there have to be.
STEP_RAD, OFFSETS, MORE_LANES = math.radians(1.0), np.linspace(0.0, 1.0, 5), 1
#: No two ends of one lane are joined.
_NEVER_M = 1e7


def least_order_m(area: Polygon, camera: CameraSensor, height_m: float, radius_m: float) -> float:
    """No order of parallel lanes at these headings and offsets is shorter, from the first to the last one."""
    survey = Survey(area, area, camera, height_m)
    (region,) = split_region(Region("R", area))
    # Those of edges, and those at which one lane less just does, are among them.
    angles_rad = headings(region, survey, STEP_RAD, math.pi * radius_m)
    counts = survey.counts(angles_rad)
    least_m = math.inf
    for more in range(MORE_LANES + 1):
        for count in np.unique(counts).tolist():
            laid = lanes_at(survey, angles_rad[counts == count], OFFSETS, count + more)
            # In still air lanes there and back are one line.
            for lines in laid.lines[..., 0, :, :].reshape(-1, count + more, 2, 2):
                lanes_m = float(np.hypot(*(lines[:, 1] - lines[:, 0]).T).sum())
                if lanes_m < least_m:
                    least_m = min(least_m, lanes_m + _turns_m(lines, radius_m))
    return least_m


def _turns_m(lines: Floats, radius_m: float) -> float:
    """No turns between lanes (N, 2, 2), flown either way in any order, are shorter in all."""
    lanes = len(lines)
    if lanes == 1:
        return 0.0
    ahead = lines[:, 1] - lines[:, 0]
    angle_rad = np.arctan2(ahead[:, 1], ahead[:, 0])
    # Leaving each end: lanes' beginnings first.
    ends = lines.transpose(1, 0, 2).reshape(-1, 2)
    out_rad = np.concatenate([angle_rad + math.pi, angle_rad])
    leaving = np.column_stack([ends, out_rad])
    arriving = np.column_stack([ends, out_rad + math.pi])
    count = 2 * lanes
    cost_m = dubins_lengths(np.repeat(leaving, count, axis=0), np.tile(arriving, (count, 1)), radius_m)
    joined = np.zeros((count + 2, count + 2))
    joined[:count, :count] = cost_m.reshape(count, count)
    lane = np.arange(count) % lanes
    joined[:count, :count][lane[:, None] == lane[None, :]] = _NEVER_M
    # Two ends are joined to nothing.
    joined[count:, count:] = _NEVER_M
    rows, columns = linear_sum_assignment(joined)
    return float(joined[rows, columns].sum()) / 2.0
