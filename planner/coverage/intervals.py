"""Where along a path the sensor works: operating function and duty cycle of Li, Chen, Wang, Li (2018)."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Interval = tuple[float, float]


def operating_intervals(collects_m: Iterable[Interval]) -> tuple[Interval, ...]:
    """Where along a path the sensor works, overlaps joined, in order.

    Parameters
    ----------
    collects_m
        Begin and end of each collect, metres along the path.
    """
    joined: list[Interval] = []
    for begin_m, end_m in sorted(collects_m):
        if joined and begin_m <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], end_m))
        else:
            joined.append((begin_m, end_m))
    return tuple(joined)


def operating_function(intervals_m: Iterable[Interval], along_m: ArrayLike) -> NDArray[np.int8]:
    """1 where the sensor works and 0 elsewhere, at distances along the path (section 5.3.1, figure 20)."""
    places_m = np.asarray(along_m, dtype=np.float64)
    working = np.zeros(places_m.shape, dtype=np.int8)
    for begin_m, end_m in intervals_m:
        working[(places_m >= begin_m) & (places_m <= end_m)] = 1
    return working


def collection_length_m(intervals_m: Iterable[Interval]) -> float:
    """Path length with the sensor on; overlapping intervals count once."""
    return math.fsum(end_m - begin_m for begin_m, end_m in operating_intervals(intervals_m))


def duty_cycle(intervals_m: Iterable[Interval], length_m: float) -> float:
    """Collection length over whole length; 0 for a path of no length."""
    return collection_length_m(intervals_m) / length_m if length_m > 0.0 else 0.0
