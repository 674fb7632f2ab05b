"""Ways to do a job that a fleet chooses from: the cheapest of all there are, from different sides."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Of a region's options so many are the ways to do it, the cheapest first, none of a heading so near to that
#: of one before: nothing of that hangs on where east is, or left. No even part of a turn, which grids have.
MOST_WAYS, APART_RAD = 4, math.radians(73.0)
#: Options that cost no more than this part more, at headings this near, are as cheap; nearer ones are one.
AS_CHEAP, BESIDE_RAD, BESIDE_M = 1e-3, math.radians(5.0), 10.0


@dataclass(frozen=True, slots=True, eq=False)
class Ways:
    """Ways to do one job: poses before and behind it, (K, 3), and what lies between, metres, (K,)."""

    entries: Floats
    exits: Floats
    inner_m: Floats


def best_ways(entries: Floats, exits: Floats, inner_m: Floats) -> Ways:
    """The cheapest, and the cheapest of other headings; of as cheap ones those on either side."""
    entries = np.asarray(entries)
    headings_rad = entries[:, 2]
    leading: list[int] = []
    kept: list[int] = []
    # By the millimetre: options that are as dear come in their order.
    for row in np.argsort(np.round(inner_m, 3), kind="stable").tolist():
        if len(leading) == MOST_WAYS or not math.isfinite(inner_m[row]):
            break
        if np.all(_apart_rad(headings_rad[leading], headings_rad[row]) >= APART_RAD):
            leading.append(row)
            kept += _either_side(entries, inner_m, row)
    return Ways(entries[kept], np.asarray(exits)[kept], np.asarray(inner_m)[kept])


def _either_side(entries: Floats, inner_m: Floats, row: int) -> list[int]:
    """Of options as cheap as one, at its heading about, the ones farthest to the left and right."""
    along_rad = entries[row, 2]
    cheap = np.flatnonzero(
        (inner_m <= (1.0 + AS_CHEAP) * inner_m[row]) & (_apart_rad(entries[:, 2], along_rad) <= BESIDE_RAD)
    )
    aside_m = entries[cheap, 1] * math.cos(along_rad) - entries[cheap, 0] * math.sin(along_rad)
    ends_m = [float(aside_m.min()), float(aside_m.max())]
    if ends_m[1] - ends_m[0] <= BESIDE_M:
        return [row]
    there = (cheap[np.abs(aside_m - end_m) <= BESIDE_M] for end_m in ends_m)
    return sorted((int(each[np.argmin(inner_m[each])]) for each in there), key=lambda k: (inner_m[k], k))


def _apart_rad(headings_rad: Floats, from_rad: float) -> Floats:
    return np.asarray(np.abs(np.remainder(headings_rad - from_rad + math.pi, math.tau) - math.pi))
