"""Compiled choice of where lanes end: each place in two photos of one lane and in view of another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]


@njit(cache=True)
def lane_ends(
    line_m: Floats,
    back_m: Floats,
    cells_m: Floats,
    nearer_m: Floats,
    farther_m: Floats,
    twice_m: Floats,
    once_m: Floats,
) -> Floats:
    """How far lanes go at one end.

    Parameters
    ----------
    line_m
        As far as each goes for ground on its own line, (P, N), N ≥ 2; −inf where there is none.
    back_m
        From where on each goes there, (P, N): its other end; inf where it has none.
    cells_m
        How far ground goes between lanes, (P, N + 1): beside the first one, between it and the next, so on to
        beside the last. Ground beside the outer lanes is seen by these and by the next.
    nearer_m, farther_m
        The same of the parts of each cell that the lane beyond its farther one does not see, and of those
        that the lane before its nearer one does not; −inf where there are none.
    twice_m, once_m
        How far ground may lie beyond a lane's end to be in two of its photos, and in one, (P,).

    Returns
    -------
    ndarray
        (P, N): two lanes at least have a cell's ground in one photo, one of the two beside it in two.
    """
    ends_m = line_m.copy()
    problems, lanes = line_m.shape
    for p in range(problems):
        for cell in range(lanes + 1):
            one = min(max(cell - 1, 0), lanes - 2)
            full_m = cells_m[p, cell] - once_m[p]
            near_m = max(ends_m[p, one], nearer_m[p, cell] - once_m[p])
            far_m = max(ends_m[p, one + 1], farther_m[p, cell] - once_m[p])
            inner = 0 < cell < lanes
            # Who stands in goes from where the other leaves off to where the ground ends.
            beyond = inner and one + 2 < lanes and ends_m[p, one + 2] >= full_m
            beyond = beyond and back_m[p, one + 2] <= near_m + once_m[p]
            before = inner and one > 0 and ends_m[p, one - 1] >= full_m
            before = before and back_m[p, one - 1] <= far_m + once_m[p]
            ends_m[p, one] = near_m if beyond else max(ends_m[p, one], full_m)
            ends_m[p, one + 1] = far_m if before else max(ends_m[p, one + 1], full_m)
        for cell in range(lanes + 1):
            one = min(max(cell - 1, 0), lanes - 2)
            longer = one if ends_m[p, one] >= ends_m[p, one + 1] else one + 1
            ends_m[p, longer] = max(ends_m[p, longer], cells_m[p, cell] - twice_m[p])
    return ends_m
