"""What a search has left over of ground and of its limits: pieces it has not seen, one pass for each."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.errors import InfeasibleError
from planner.search.choose import Search
from planner.search.programme import Programme, Sweep
from planner.tasks.budget import MOST, Flight, part_used
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import exceeded

Floats = NDArray[np.float64]

#: Pieces that are flown for, those worth most first; narrower ones than twice this are none.
PIECES, NARROW_M = 16, 0.25
#: Longer programmes are left as they are: each place of each piece in the order is tried.
MOST_SWEEPS = 80
#: Strips reach beyond a piece by this much.
BEYOND_M = 1.0
#: Where all do not fit, half of them are tried, so often.
HALVED = 3


def filled(
    best: Flight,
    asked: Search,
    fly: Callable[[Programme], Flight],
    aircraft: Aircraft,
    enough: Callable[[], bool],
) -> Flight:
    """A flight with passes over what it leaves unseen, put in where the way is least, within its limits.

    Of looks that find all, at what stays: a small region beside a large one is no part of any pattern.
    """
    if asked.detection < 1.0 or asked.drifting is not None or len(best.programme.sweeps) > MOST_SWEEPS:
        return best
    pieces = _pieces(best, asked)
    for _ in range(HALVED):
        if not pieces or enough():
            break
        sweeps = _with(best, pieces, asked, aircraft)
        if len(sweeps) == len(best.programme.sweeps):
            break
        worth, cost_m = asked.found(sweeps), asked.pricing.cost_m(sweeps)
        programme = replace(
            best.programme, sweeps=sweeps, whole=sweeps, worth=worth, cost_m=cost_m, thinned=False
        )
        try:
            found = fly(programme)
        except InfeasibleError:
            pieces = pieces[: len(pieces) // 2]
            continue
        fits = part_used(aircraft, found.use) <= MOST and not exceeded(aircraft, found.use)
        if fits and _seen(found, asked).area > _seen(best, asked).area:
            return found
        pieces = pieces[: len(pieces) // 2]
    return best


def _seen(flight: Flight, asked: Search) -> BaseGeometry:
    return shapely.intersection(shapely.union_all([each.footprint for each in flight.passes]), asked.ground)


def _pieces(flight: Flight, asked: Search) -> list[Polygon]:
    """What of the ground is not seen and worth anything, that worth most first."""
    left = shapely.get_parts(shapely.difference(asked.ground, _seen(flight, asked))).tolist()
    parts = [p for p in left if isinstance(p, Polygon) and not p.buffer(-NARROW_M).is_empty]
    worth = {id(part): _score(part, asked) * part.area for part in parts}
    kept = sorted((part for part in parts if worth[id(part)] > 0.0), key=lambda part: -worth[id(part)])
    return kept[:PIECES]


def _score(part: Polygon, asked: Search) -> float:
    """The highest of the cells at a place in it: a small piece may have no cell's middle of its own."""
    worth, place = asked.worth, part.representative_point()
    row = int((place.y - worth.south_m) / worth.cell_m)
    column = int((place.x - worth.west_m) / worth.cell_m)
    near = worth.scores[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    if near.size and near.max() > 0.0:
        return float(near.max())
    plain = worth.scores[worth.scores > 0.0]
    # Ground that is worth the same everywhere is so where no cell tells, too.
    return float(plain[0]) if len(plain) and plain.min() == plain.max() else 0.0


def _strips(part: Polygon, width_m: float) -> Floats:
    """Strips (N, 2, 2) side by side along the longer side of the least rectangle round a piece."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(part))[:4]
    sides = np.diff(corners[:3], axis=0)
    lengths_m = np.hypot(*sides.T)
    along, aside = (sides[0], sides[1]) if lengths_m[0] >= lengths_m[1] else (sides[1], sides[0])
    unit = along / max(float(np.hypot(*along)), 1e-9)
    middle = corners.mean(axis=0)
    rows = max(1, math.ceil(float(np.hypot(*aside)) / width_m))
    found = []
    for row in range(rows):
        at = middle + aside * ((row + 0.5) / rows - 0.5)
        found.append((at - 0.5 * along - BEYOND_M * unit, at + 0.5 * along + BEYOND_M * unit))
    return np.array(found)


def _with(best: Flight, pieces: Sequence[Polygon], asked: Search, aircraft: Aircraft) -> tuple[Sweep, ...]:
    """Its passes and those over pieces, each where it costs least, as far as limits go, about."""
    pricing, sweeps = asked.pricing, best.programme.sweeps
    used = part_used(aircraft, best.use)
    budget_m = math.inf if used <= 0.0 else best.programme.cost_m * MOST / used
    for piece in pieces:
        for strip in _strips(piece, asked.looking.narrowest_m()):
            ways = [
                sweep
                for look in asked.looking.looks
                for way in (strip, strip[::-1])
                for sweep in asked.sweeps_over(way[None], look)
            ]
            tried = [
                (pricing.cost_m(again), number, again)
                for number, (sweep, at) in enumerate(
                    (sweep, at) for sweep in ways for at in range(len(sweeps) + 1)
                )
                if (again := (*sweeps[:at], sweep, *sweeps[at:]))
            ]
            if tried and (least := min(tried, key=lambda one: one[:2]))[0] <= budget_m:
                sweeps = least[2]
    return sweeps
