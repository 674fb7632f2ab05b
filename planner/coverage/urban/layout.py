"""Layouts of sweeps that see all of an area's free ground, and which of them promise the shortest flight."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.frontier import Frontier, Laid, Manner

Floats = NDArray[np.float64]

#: Headings tried: the directions that most of the ground's edges have, so far apart, and across the first.
HEADINGS, APART_RAD = 4, math.radians(6.0)
#: Directions this near to the first axis are along it.
ALONG_RAD = 1e-3
#: Of them so many are tried in all manners, by what the first manners promise.
BEST_HEADINGS = 2
FIRST_MANNERS = (Manner(0.5), Manner(None, 0.0, 0.5))
#: Gap and bend (see ``Manner``) of sweeps tried at each of these headings, from below and from above.
MANNERS = ((0.0, 0.5), (1.0, 0.75), (2.0, 0.25))
#: Where the lowest of level sweeps lies, in widths over the lowest ground, and as parts of what is to spare.
LEVELS, SPARED = (0.25, 0.0, -0.25), (0.0, 0.5, 1.0)
#: Of headings those are looked at whose first manners cost no more than this part of the best.
SECOND = 1.1
#: Layouts that cost this close, by part, are one.
SAME = 1e-4
#: Corners that one sweep costs about.
CORNERS = 2.0


@dataclass(frozen=True, slots=True)
class Layout:
    """Sweeps that see all the ground, and what a flight along them costs about, metres."""

    laid: tuple[Laid, ...]
    cost_m: float

    @property
    def count(self) -> int:
        """How many sweeps there are."""
        return sum(len(each.rows) for each in self.laid)

    def lines(self) -> Floats:
        """All of them, (N, 2, 2)."""
        return np.concatenate([each.lines() for each in self.laid])


def cheapest(urban: UrbanArea, edges: Floats) -> Layout:
    """The most promising way to see all of the ground with these edges, (E, 4), at one heading."""
    tried: list[tuple[float, int, Frontier]] = []
    best: Layout | None = None
    for k, angle_rad in enumerate(headings(edges)):
        frontier = Frontier.of(edges, angle_rad, False, urban.width_m)
        least_m = math.inf
        for manner in FIRST_MANNERS:
            most_m = math.inf if best is None else SECOND * best.cost_m
            layout = _layout(urban, frontier, manner, most_m)
            least_m = min(least_m, layout.cost_m)
            best = layout if best is None or layout.cost_m < (1.0 - SAME) * best.cost_m else best
        tried.append((least_m, k, frontier))
    if best is None:
        raise ValueError("ground without edges has no headings")
    for _, _, frontier in sorted(tried, key=lambda each: (round(each[0], 1), each[1]))[:BEST_HEADINGS]:
        spare = -frontier.height_m / urban.width_m % 1.0
        levels = dict.fromkeys((*LEVELS, *(0.5 - part * spare for part in SPARED)))
        manners = [Manner(None, gap, bent) for gap, bent in MANNERS]
        ways = [(frontier.mirrored(), manner) for manner in manners]
        ways += [(frontier, manner) for manner in (*manners, *(Manner(level) for level in levels))]
        for side, manner in ways:
            if side is frontier and manner in FIRST_MANNERS:
                continue
            layout = _layout(urban, side, manner, best.cost_m)
            best = layout if layout.cost_m < (1.0 - SAME) * best.cost_m else best
    return best


def headings(edges: Floats) -> list[float]:
    """Directions that most of the edges have, and across the first of them."""
    along = edges[:, 2:] - edges[:, :2]
    lengths_m = np.hypot(along[:, 0], along[:, 1])
    # From a little below 0 on: what lies along the first axis, but for rounding, is not its other way.
    angles_rad = np.mod(np.arctan2(along[:, 1], along[:, 0]) + ALONG_RAD, math.pi) - ALONG_RAD
    # buildings have few directions among them
    angles_rad, which = np.unique(np.round(angles_rad, 9), return_inverse=True)
    weights = np.bincount(which, lengths_m)
    apart = np.abs(np.mod(angles_rad[:, None] - angles_rad[None] + math.pi / 2.0, math.pi) - math.pi / 2.0)
    near = apart < APART_RAD / 2.0
    found: list[float] = []
    for _ in range(HEADINGS):
        best = int(np.argmax(np.round(near @ weights, 3)))
        if weights[best] <= 0.0:
            break
        found.append(float(angles_rad[best]))
        weights[apart[best] < APART_RAD] = 0.0
    across = (found[0] + math.pi / 2.0) % math.pi
    if all(abs(math.remainder(across - angle, math.pi)) > APART_RAD for angle in found):
        found.append(across)
    return found


def turn_m(urban: UrbanArea) -> float:
    """What a corner costs: the way flown while the aircraft stops and turns on the spot."""
    return urban.stop_s * urban.speed_m_s if urban.turn_radius_m == 0.0 else 0.0


def each_m(urban: UrbanArea) -> float:
    """What one sweep more costs about, besides its length."""
    return urban.width_m + CORNERS * turn_m(urban)


def _layout(urban: UrbanArea, frontier: Frontier, manner: Manner, most_m: float) -> Layout:
    """Sweeps in a manner; what costs more than ``most_m`` is not laid to its end."""
    each = each_m(urban)
    laid = frontier.laid(urban.width_m, urban.length_m, manner, each, most_m)
    return Layout((laid,), float(laid.lengths_m.sum()) + each * len(laid.rows))
