"""Compiled shortening of a line through poses: each turned a little, needless corners left."""

# mypy: allow-untyped-decorators

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.fleet.prizes.lines_kernels import shortest_clear
from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Turns tried, from the widest to the narrowest in radians, each half the one before.
WIDEST, NARROWEST = 0.2, 2e-4
#: A line shorter by less is as long.
LEAST = 1e-6


@njit(cache=True, nogil=True)
def refined(
    poses: Floats, corner: Flags, radius: float, edges: Floats, offsets: Ints, boxes: Floats
) -> tuple[int, float]:
    """Turn the poses of a line, in place, until it gets no shorter: how many are left, and its length.

    ``corner`` marks those that a line need not pass. Ends may be turned, too.
    """
    size = len(poses)
    legs = np.empty(size)
    for k in range(size - 1):
        _, legs[k] = shortest_clear(poses[k], poses[k + 1], radius, np.inf, edges, offsets, boxes)
    pose = np.empty(3)
    step = WIDEST
    while step >= NARROWEST:
        better = True
        while better:
            better = False
            k = 0
            while k < size:
                had = 0.0
                if k > 0:
                    had += legs[k - 1]
                if k + 1 < size:
                    had += legs[k]
                if 0 < k < size - 1 and corner[k]:
                    _, direct = shortest_clear(poses[k - 1], poses[k + 1], radius, had, edges, offsets, boxes)
                    if direct <= had - LEAST:
                        for j in range(k, size - 1):
                            poses[j] = poses[j + 1]
                            corner[j] = corner[j + 1]
                            legs[j] = legs[j + 1]
                        legs[k - 1] = direct
                        size -= 1
                        better = True
                        continue
                for side in (-1.0, 1.0):
                    pose[:] = poses[k]
                    pose[2] += side * step
                    to, on = 0.0, 0.0
                    if k > 0:
                        _, to = shortest_clear(poses[k - 1], pose, radius, had, edges, offsets, boxes)
                    if k + 1 < size and to < had:
                        _, on = shortest_clear(pose, poses[k + 1], radius, had - to, edges, offsets, boxes)
                    if to + on < had - LEAST:
                        poses[k] = pose
                        if k > 0:
                            legs[k - 1] = to
                        if k + 1 < size:
                            legs[k] = on
                        better = True
                        break
                k += 1
        step *= 0.5
    return size, float(legs[: size - 1].sum())
