"""Most reward along a flyable line among polygons, from a start to an end."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.dubins.path import Path, Segment, SegmentKind
from planner.fleet.prizes.choice import Choices, Flown, best_choice
from planner.fleet.prizes.lines_kernels import FIRST, LAST, shortest_clear, word
from planner.fleet.prizes.problem import Gathered
from planner.fleet.prizes.refine_kernels import refined
from planner.fleet.prizes.roadmap import Roadmap, roadmap
from planner.progress import Stop, never
from planner.route import Pose

Floats = NDArray[np.float64]

#: Routes over the budget by up to these parts are tried, in turn: headings between those of the roadmap may
#: make them fit.
SHARES = (1.0, 1.01, 1.005, 1.02)
#: Turns are this much wider than they need be.
WIDER = 1.0005
#: Of the budget this much is kept for roundings.
KEPT = 1e-6


@dataclass(frozen=True, slots=True)
class Field:
    """Targets among polygons.

    Parameters
    ----------
    start, end
        Ends of the line, any heading there.
    targets, rewards
        Places, and what the first visit to each brings.
    polygons
        May be touched, not entered.
    border
        Lines stay inside where all places do.
    radius
        Of the tightest turn; 0 for straights with corners.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    targets: tuple[tuple[float, float], ...]
    rewards: tuple[float, ...]
    polygons: tuple[Polygon, ...]
    border: Polygon | None
    radius: float


@dataclass(frozen=True, slots=True)
class Collected:
    """What a line brings.

    Parameters
    ----------
    targets
        Indices in order.
    reward, length
        Of the line.
    legs
        The line from the start to the first target, and so on to the end.
    """

    targets: tuple[int, ...]
    reward: float
    length: float
    legs: tuple[Path, ...]


def most_reward(
    field: Field,
    budget: float,
    seed: int,
    *,
    pools: int | None = 1,
    threads: int = 1,
    stop: Stop = never,
) -> Collected:
    """The line of most reward found within a budget of length; parameters are those of ``pools.bred``.

    Raises
    ------
    ValueError
        Where no line from start to end is within the budget.
    """
    places = (field.start, *field.targets, field.end)
    ways = roadmap(places, field.polygons, field.border, WIDER * field.radius, budget, threads)
    choices = Choices(ways.costs, np.array([0.0, *field.rewards, 0.0]), budget * (1.0 - KEPT))
    known: dict[tuple[int, ...], float] = {}

    def length(order: tuple[int, ...]) -> float:
        if order not in known:
            known[order] = _refined(ways, choices, order)[1]
        return known[order]

    flown = Flown(length, SHARES) if field.radius > 0.0 else None
    found = best_choice(choices, seed, pools=pools, threads=threads, stop=stop, flown=flown)
    return _collected(field, ways, choices, found)


def _poses(ways: Roadmap, choices: Choices, order: tuple[int, ...]) -> tuple[Floats, NDArray[np.bool_]]:
    """All poses of a route over the roadmap, and which of them are at corners."""
    at = [place * ways.headings + way for place, way in zip(order, choices.ways(order), strict=True)]
    chain = [at[0]]
    for leaving, arriving in itertools.pairwise(at):
        chain += ways.way(leaving, arriving)[1:]
    rows = np.array(chain)
    return ways.poses[rows].copy(), rows >= len(ways.costs) * ways.headings


def _refined(
    ways: Roadmap, choices: Choices, order: tuple[int, ...]
) -> tuple[Floats, float, NDArray[np.bool_]]:
    """Poses of a route turned so that it gets short, its length, and which are at corners."""
    poses, corner = _poses(ways, choices, order)
    size, length = refined(poses, corner, ways.radius, *ways.fence.arrays)
    return poses[:size], length, corner[:size]


def _collected(field: Field, ways: Roadmap, choices: Choices, found: Gathered) -> Collected:
    if ways.radius > 0.0:
        poses, _, corner = _refined(ways, choices, found.order)
        pieces = [_line(a, b, ways) for a, b in itertools.pairwise(poses)]
    else:
        poses, corner = _poses(ways, choices, found.order)
        pieces = [_straight(a, b) for a, b in itertools.pairwise(poses)]
    legs: list[tuple[Segment, ...]] = [()]
    for piece, at_corner in zip(pieces, corner[1:], strict=True):
        legs[-1] += piece
        if not at_corner:
            legs.append(())
    paths = tuple(Path(leg) for leg in legs[:-1])
    length = math.fsum(path.length_m for path in paths)
    return Collected(tuple(k - 1 for k in found.order[1:-1]), found.reward, length, paths)


def _straight(a: Floats, b: Floats) -> tuple[Segment, ...]:
    pose = Pose(float(a[0]), float(a[1]), math.atan2(b[1] - a[1], b[0] - a[0]))
    return (Segment("straight", pose, float(math.hypot(*(b - a)[:2]))),)


def _line(a: Floats, b: Floats, ways: Roadmap) -> tuple[Segment, ...]:
    """The shortest clear word between two poses."""
    k, _ = shortest_clear(a, b, ways.radius, math.inf, *ways.fence.arrays)
    t, p, q = word(k, a, b, ways.radius)
    middle = 0.0 if k < 4 else -FIRST[k]
    pose = Pose(float(a[0]), float(a[1]), float(a[2]))
    segments = []
    for side, part in ((FIRST[k], t), (middle, p), (LAST[k], q)):
        kind: SegmentKind = "straight" if side == 0.0 else "left" if side > 0.0 else "right"
        radius = math.inf if side == 0.0 else ways.radius
        segments.append(Segment(kind, pose, float(part * ways.radius), radius))
        pose = segments[-1].end
    return tuple(segments)


def dense_points(found: Collected, ends: Sequence[tuple[float, float]], step: float) -> list[list[float]]:
    """Points of the line at most a step apart, each target among them as it was given.

    ``ends`` are the ends of the legs.
    """
    points = [list(found.legs[0].start.position)]
    for leg, end in zip(found.legs, ends, strict=True):
        # Evenly along what has no corners: neighbours next to each other have no direction.
        bent = any(segment.kind != "straight" for segment in leg.segments)
        for piece in [leg] if bent else [Path((segment,)) for segment in leg.segments]:
            parts = max(math.ceil(piece.length_m / step), 1)
            begun = np.cumsum([0.0, *(segment.length_m for segment in piece.segments)])
            for along in piece.length_m * np.arange(1, parts + 1) / parts:
                k = min(int(np.searchsorted(begun, along, side="right")), len(piece.segments)) - 1
                points.append(list(piece.segments[k].at(float(along - begun[k])).position))
        points[-1] = [float(end[0]), float(end[1])]
    return points
