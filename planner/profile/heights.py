"""Heights along a line: knots between which the slope is even."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Knots nearer than this along the line are one place; two heights there are a climb on the spot.
SAME_M = 1e-6
#: Parts of a line are looked at no nearer to their ends, where heights may be changed on the spot.
WITHIN_M = 1e-5


@dataclass(frozen=True, slots=True)
class Heights:
    """Altitude by distance along a line over the ground.

    Parameters
    ----------
    knots
        Distance along the line in metres, not falling, and altitude in metres over the flight's datum. Two
        knots at one distance: straight up or down there.
    """

    knots: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        """Refuse knots out of order."""
        along_m = [at_m for at_m, _ in self.knots]
        if len(along_m) < 2 or any(b < a - SAME_M for a, b in pairwise(along_m)):
            raise ValueError(f"knots are to follow each other along the line: {along_m}")

    @property
    def length_m(self) -> float:
        """Distance along the line of the last knot."""
        return self.knots[-1][0]

    def at(self, along_m: ArrayLike) -> NDArray[np.float64]:
        """Altitude at distances along the line; where it climbs on the spot, the later one."""
        at_m, altitude_m = (np.array(column) for column in zip(*self.knots, strict=True))
        places = np.asarray(along_m, dtype=np.float64)
        last = np.clip(np.searchsorted(at_m, places + SAME_M, side="right"), 1, len(at_m) - 1)
        run_m = at_m[last] - at_m[last - 1]
        part = np.where(run_m > SAME_M, (places - at_m[last - 1]) / np.maximum(run_m, SAME_M), 1.0)
        part = np.clip(part, 0.0, 1.0)
        return np.asarray(altitude_m[last - 1] + part * (altitude_m[last] - altitude_m[last - 1]))

    def within(self, from_m: float, until_m: float) -> Heights:
        """Those of a part of the line, its ends looked at from within."""
        inside = [
            (at_m - from_m, up_m)
            for at_m, up_m in self.knots
            if from_m + WITHIN_M < at_m < until_m - WITHIN_M
        ]
        first_m, last_m = self.at([from_m + WITHIN_M, until_m - WITHIN_M])
        return Heights(((0.0, float(first_m)), *inside, (until_m - from_m, float(last_m))))

    @property
    def is_level(self) -> bool:
        """Whether it is one altitude all along."""
        low_m, high_m = self.range_m
        return high_m - low_m <= SAME_M

    @property
    def range_m(self) -> tuple[float, float]:
        """The lowest altitude and the highest."""
        altitudes_m = [altitude_m for _, altitude_m in self.knots]
        return min(altitudes_m), max(altitudes_m)

    def reverse(self) -> Heights:
        """The same heights flown the other way."""
        return Heights(tuple((self.length_m - at_m, height_m) for at_m, height_m in reversed(self.knots)))

    def then(self, other: Heights) -> Heights:
        """These, and others behind them."""
        moved = tuple((self.length_m + at_m, height_m) for at_m, height_m in other.knots)
        return Heights(tidy((*self.knots, *moved)))


def level(length_m: float, altitude_m: float) -> Heights:
    """One altitude all along."""
    return Heights(((0.0, altitude_m), (length_m, altitude_m)))


def tidy(knots: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    """Knots without those that say nothing: repeated ones, and ones on the line between their neighbours."""
    kept: list[tuple[float, float]] = []
    for knot in knots:
        if kept and abs(knot[0] - kept[-1][0]) <= SAME_M and abs(knot[1] - kept[-1][1]) <= SAME_M:
            continue
        if len(kept) >= 2 and _between(kept[-2], kept[-1], knot):
            kept[-1] = knot
        else:
            kept.append(knot)
    return tuple(kept) if len(kept) > 1 else (knots[0], knots[-1])


def _between(before: tuple[float, float], middle: tuple[float, float], behind: tuple[float, float]) -> bool:
    run_m = behind[0] - before[0]
    if run_m <= SAME_M:
        return (behind[1] - middle[1]) * (middle[1] - before[1]) >= 0.0
    if middle[0] - before[0] <= SAME_M or behind[0] - middle[0] <= SAME_M:
        return False
    there_m = before[1] + (behind[1] - before[1]) * (middle[0] - before[0]) / run_m
    return abs(there_m - middle[1]) <= SAME_M
