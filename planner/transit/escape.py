"""Short ways out of soft discs that hold an end of a transit.

Such a disc cannot be kept clear. Left out of the search, it may be crossed at length; here the line leaves it
through a place on its circle instead wherever that saves more metres inside than it costs outside.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from planner.airspace.kernels import length_in_discs
from planner.airspace.zones import TOUCH_M, Disc, KeepOut
from planner.dubins.path import Path, join
from planner.dubins.words import candidates_between
from planner.route import Anchor

#: A metre inside a soft disc that holds an end weighs as much as this many metres of detour.
INSIDE_WEIGHT = 10.0

#: Where on the circle the line may leave, from the direction in which the end lies; and how it leans there.
EXITS_RAD = tuple(math.radians(step) for step in (0, 15, -15, 30, -30, 45, -45, 60, -60, 90, -90))
LEANS_RAD = tuple(math.radians(lean) for lean in (0, 30, -30, 60, -60))

#: So many of the most promising exits are searched from.
TRIES = 12

#: Of a disc that holds both ends, so many exits are tried with so many entries.
PAIRS = 4

#: Arcs are sampled this finely to measure how much of them lies inside.
SAMPLE_M = 5.0

#: A line that hugs a disc is not inside: chords between samples are, by a few millimetres.
HUGGING_M = 0.05

Solve = Callable[[Anchor, Anchor, KeepOut], Path | None]


def shorten_crossings(
    path: Path,
    start: Anchor,
    goal: Anchor,
    held: Sequence[Disc],
    zones: KeepOut,
    radius_m: float,
    solve: Solve,
) -> Path:
    """The line with its ways out of (and into) discs shortened where a better way was found.

    Parameters
    ----------
    path
        A line from ``start`` to ``goal`` clear of ``zones``.
    held
        Soft discs that hold the start or the goal, not among ``zones``.
    solve
        Finds a line between two anchors clear of the zones given.
    """
    if not held:
        return path
    path = _around(path, start, goal, held, zones, radius_m, solve)
    way_out, rest, origin = _leave(path, start, goal, held, zones, radius_m, solve)

    def solve_back(a: Anchor, b: Anchor, kept: KeepOut) -> Path | None:
        found = solve(turned(b), turned(a), kept)
        return None if found is None else found.reverse()

    way_in, back, _ = _leave(rest.reverse(), turned(goal), turned(origin), held, zones, radius_m, solve_back)
    pieces = [piece for piece in (way_out, back.reverse(), way_in and way_in.reverse()) if piece is not None]
    return join(*pieces)


def _leave(
    path: Path,
    start: Anchor,
    goal: Anchor,
    held: Sequence[Disc],
    zones: KeepOut,
    radius_m: float,
    solve: Solve,
) -> tuple[Path | None, Path, Anchor]:
    """The best way out of the discs that hold the start, the line from there on, and where it begins."""
    best: tuple[Path | None, Path, Anchor] = (None, path, start)
    best_cost = _cost(path, held)
    leaving = [disc for disc in held if _holds(disc, start) and not _holds(disc, goal)]
    exits = [e for disc in leaving for e in _exits(disc, start, goal, held, zones, radius_m)]
    for least, out, place in sorted(exits, key=lambda row: row[0])[:TRIES]:
        if least >= best_cost:
            break
        kept = tuple(d for d in held if not _holds(d, place) and not _holds(d, goal))
        onward = solve(place, goal, replace(zones, discs=zones.discs + kept))
        if onward is None:
            continue
        cost = _cost(out, held) + _cost(onward, held)
        if cost < best_cost - 1e-6:
            best, best_cost = (out, onward, place), cost
    return best


def _around(
    path: Path,
    start: Anchor,
    goal: Anchor,
    held: Sequence[Disc],
    zones: KeepOut,
    radius_m: float,
    solve: Solve,
) -> Path:
    """Where a disc holds both ends: out of it, round it, and in again, if that is better."""
    best, best_cost = path, _cost(path, held)
    for disc in held:
        if not (_holds(disc, start) and _holds(disc, goal)):
            continue
        outs = _exits(disc, start, goal, held, zones, radius_m)[:PAIRS]
        ins = _exits(disc, turned(goal), start, held, zones, radius_m)[:PAIRS]
        for (_, out, place), (_, back, other) in itertools.product(outs, ins):
            ends_cost = _cost(out, held) + _cost(back, held)
            if ends_cost + math.dist(place.position, other.position) >= best_cost:
                continue
            kept = tuple(d for d in held if not _holds(d, place) and not _holds(d, other))
            between = solve(place, turned(other), replace(zones, discs=zones.discs + kept))
            if between is None:
                continue
            cost = ends_cost + _cost(between, held)
            if cost < best_cost - 1e-6:
                best, best_cost = join(out, between, back.reverse()), cost
    return best


def _exits(
    disc: Disc, start: Anchor, goal: Anchor, held: Sequence[Disc], zones: KeepOut, radius_m: float
) -> list[tuple[float, Path, Anchor]]:
    """Ways from the start to a disc's circle: least cost of a line to the goal by it, the way, its end."""
    exits: list[tuple[float, Path, Anchor]] = []
    towards = math.atan2(start.north_m - disc.north_m, start.east_m - disc.east_m)
    for off, lean in itertools.product(EXITS_RAD, LEANS_RAD):
        angle = towards + off
        place = Anchor(
            disc.east_m + disc.radius_m * math.cos(angle),
            disc.north_m + disc.radius_m * math.sin(angle),
            angle + lean,
        )
        words = candidates_between(start, place, radius_m)
        out = next((word for word in words if zones.clear(word)), None)
        if out is not None:
            exits.append((_cost(out, held) + math.dist(place.position, goal.position), out, place))
    return sorted(exits, key=lambda row: row[0])


def _cost(path: Path, held: Sequence[Disc]) -> float:
    """Length and weighted metres inside."""
    points = path.sample(SAMPLE_M)[:, :2]
    inside_m = sum(
        length_in_discs(points, np.array([[d.east_m, d.north_m, d.radius_m - HUGGING_M]])) for d in held
    )
    return path.length_m + INSIDE_WEIGHT * float(inside_m)


def _holds(disc: Disc, end: Anchor) -> bool:
    return math.hypot(end.east_m - disc.east_m, end.north_m - disc.north_m) < disc.radius_m - 0.5 * TOUCH_M


def turned(end: Anchor) -> Anchor:
    """The same place, flown through the other way."""
    return end if end.angle_rad is None else replace(end, angle_rad=end.angle_rad + math.pi)
