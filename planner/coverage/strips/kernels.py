"""Compiled part of sweeps: what each strip has to span. It knows nothing but numbers."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]

#: An edge along a strip's own edge is in it or not, whatever the last digit of a coordinate.
WITHIN_M = 2.5e-4


@njit(cache=True)
def strip_extents(edges: Floats, angles_rad: Floats, low_m: Floats, high_m: Floats) -> Floats:
    """Along-track extent of an outline within strips.

    Parameters
    ----------
    edges
        Shape (E, 4): both ends of each edge, east_m, north_m, east_m, north_m.
    angles_rad
        Flight directions, shape (M,); x̂ ahead, ŷ to the left.
    low_m, high_m
        ŷ of each strip's edges, shape (M, K, N); what is less than ``WITHIN_M`` inside them is another's.

    Returns
    -------
    ndarray
        Shape (M, K, N, 2): least and largest x̂, (inf, −inf) for a strip the outline does not touch.
    """
    extents = np.empty((*low_m.shape, 2))
    extents[..., 0] = np.inf
    extents[..., 1] = -np.inf
    for m in range(len(angles_rad)):
        cos, sin = math.cos(angles_rad[m]), math.sin(angles_rad[m])
        for i in range(edges.shape[0]):
            x0 = cos * edges[i, 0] + sin * edges[i, 1]
            y0 = cos * edges[i, 1] - sin * edges[i, 0]
            x1 = cos * edges[i, 2] + sin * edges[i, 3]
            y1 = cos * edges[i, 3] - sin * edges[i, 2]
            if y0 > y1:
                x0, y0, x1, y1 = x1, y1, x0, y0
            for k in range(low_m.shape[1]):
                for n in range(low_m.shape[2]):
                    low, high = low_m[m, k, n] + WITHIN_M, high_m[m, k, n] - WITHIN_M
                    if y1 < low or y0 > high:
                        continue
                    xa, xb = x0, x1
                    if y0 < low:
                        xa = x0 + (x1 - x0) * (low - y0) / (y1 - y0)
                    if y1 > high:
                        xb = x0 + (x1 - x0) * (high - y0) / (y1 - y0)
                    extents[m, k, n, 0] = min(extents[m, k, n, 0], xa, xb)
                    extents[m, k, n, 1] = max(extents[m, k, n, 1], xa, xb)
    return extents
