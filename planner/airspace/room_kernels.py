"""Compiled parts of what options cost: lines and turns among discs, (K, 3): east_m, north_m, radius_m."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.airspace.kernels import length_in_discs
from planner.jit import njit

Floats = NDArray[np.float64]


@njit(cache=True)
def inside_m(lines: Floats, discs: Floats) -> Floats:
    """Length of each polyline (N, P, 2) inside the union of discs, (N,)."""
    lengths_m = np.empty(lines.shape[0])
    for i in range(lines.shape[0]):
        lengths_m[i] = length_in_discs(lines[i], discs)
    return lengths_m


@njit(cache=True)
def circles_fit(poses: Floats, side: float, radius: float, discs: Floats) -> NDArray[np.bool_]:
    """Whether the turning circle to a side (1 left, -1 right) of poses (N, 3) is outside every disc, (N,)."""
    fit = np.ones(poses.shape[0], dtype=np.bool_)
    for i in range(poses.shape[0]):
        east_m = poses[i, 0] - side * radius * math.sin(poses[i, 2])
        north_m = poses[i, 1] + side * radius * math.cos(poses[i, 2])
        for k in range(discs.shape[0]):
            if math.hypot(east_m - discs[k, 0], north_m - discs[k, 1]) < discs[k, 2] + radius:
                fit[i] = False
                break
    return fit
