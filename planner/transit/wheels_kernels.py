"""Compiled: circles that touch two others."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Array = NDArray[np.float64]


@njit(cache=True)
def touching(ends: Array, others: Array, radius_m: float, most: int) -> Array:
    """Wheels of ``radius_m`` that touch a wheel and another of the same sense from outside.

    Parameters
    ----------
    ends, others
        Wheels, shapes (A, 3) and (B, 3): east_m, north_m, signed radius; those of no radius touch nothing.
        Of each end with the nearest ``most`` of the others.

    Returns
    -------
    ndarray
        Wheels, shape (C, 3), of the other sense: left of the line between the centres, then right of it, by
        distance.
    """
    found = np.empty((2 * most * len(ends), 3))
    count = 0
    apart = np.empty(most)
    which = np.empty(most, dtype=np.int64)
    for i in range(len(ends)):
        if ends[i, 2] == 0.0:
            continue
        size = 0
        near = abs(ends[i, 2]) + radius_m
        for k in range(len(others)):
            if not others[k, 2] * ends[i, 2] > 0.0:
                continue
            distance = math.hypot(others[k, 0] - ends[i, 0], others[k, 1] - ends[i, 1])
            far = abs(others[k, 2]) + radius_m
            # A triangle of the two centres and the one between, of sides near, far and distance.
            if not (distance > abs(far - near) and distance < near + far and distance > 0.0):
                continue
            key = distance - far
            if size == most and not key < apart[size - 1]:
                continue
            place = size if size < most else most - 1
            while place > 0 and key < apart[place - 1]:
                apart[place], which[place] = apart[place - 1], which[place - 1]
                place -= 1
            apart[place], which[place] = key, k
            size = min(size + 1, most)
        for side in (1.0, -1.0):
            for n in range(size):
                k = which[n]
                offset_e, offset_n = others[k, 0] - ends[i, 0], others[k, 1] - ends[i, 1]
                distance = math.hypot(offset_e, offset_n)
                far = abs(others[k, 2]) + radius_m
                along = (near * near - far * far + distance * distance) / (2.0 * distance)
                aside = side * math.sqrt(max(near * near - along * along, 0.0))
                unit_e, unit_n = offset_e / distance, offset_n / distance
                found[count, 0] = ends[i, 0] + along * unit_e - aside * unit_n
                found[count, 1] = ends[i, 1] + along * unit_n + aside * unit_e
                found[count, 2] = -math.copysign(radius_m, ends[i, 2])
                count += 1
    return found[:count]
