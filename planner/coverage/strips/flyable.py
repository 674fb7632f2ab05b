"""Whether a region's lanes can be flown within the operating area."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.coverage.lines import flown_straight
from planner.coverage.strips.headings import grid
from planner.coverage.strips.sweeps import Sweep, allowed, lanes_at

Floats = NDArray[np.float64]


def is_flyable(sweep: Sweep, area: shapely.Polygon | None, settle_m: float = 0.0) -> bool:
    """Whether at some heading every lane, settling run and all, can be inside the area."""
    if area is None:
        return True
    if sweep.region.approach_rad is None:
        # Mostly one along or across does, which is found sooner than all headings are.
        few = grid(sweep.region.area, math.pi / 2.0)
        if flyable_headings(sweep, area, settle_m, few).any():
            return True
    return bool(flyable_headings(sweep, area, settle_m, sweep.angles_rad).any())


def flyable_headings(
    sweep: Sweep, area: shapely.Polygon | None, settle_m: float, angles_rad: Floats
) -> NDArray[np.bool_]:
    """At which headings every lane of a sweep, settling run and all, can be inside the area, (M,)."""
    flyable = np.zeros(len(angles_rad), dtype=np.bool_)
    counts = sweep.lanes(angles_rad)
    for count in np.unique(counts):
        rows = np.flatnonzero(counts == count)
        if area is None:
            flyable[rows] = True
            continue
        lanes = lanes_at(sweep, angles_rad[rows], np.array([0.0, 0.5, 1.0]), int(count))
        shapely.prepare(area)
        flown = shapely.linestrings(flown_straight(lanes.lines, settle_m))
        inside = np.asarray(shapely.covers(area, flown), dtype=np.bool_)
        inside &= allowed(sweep, lanes.headings_rad)[:, None, None, :]
        flyable[rows] = np.any(np.all(np.any(inside, axis=3), axis=2), axis=1)
    return flyable
