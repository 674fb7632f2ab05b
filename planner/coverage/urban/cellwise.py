"""Cells of free ground swept back and forth, lane by lane."""

from __future__ import annotations

import math

import numpy as np
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import Place
from planner.coverage.urban.fitting import Fitting
from planner.coverage.urban.measures import Sweep

Lanes = tuple[Sweep, ...]


def cell_lanes(
    part: BaseGeometry, ground: BaseGeometry, fitting: Fitting, angle_rad: float
) -> tuple[Lanes, Lanes]:
    """Lanes of a cell from its right side to its left, seen along them, and sweeps over what they leave."""
    lanes, extras = fitting.lanes(part, angle_rad, ground)
    if not lanes:
        # a cell narrower than the margin at its edge
        lanes, extras = extras[:1], extras[1:]
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    aside = np.array([-ahead[1], ahead[0]])
    order = sorted(lanes, key=lambda lane: (np.dot(lane.midpoint, aside), np.dot(lane.midpoint, ahead)))
    return tuple(order), extras


def back_and_forth(lanes: Lanes, extras: Lanes, here: Place) -> list[Sweep]:
    """Lanes in their order, each begun at its end that is nearer; extras where the line comes by an end near.

    The seed spreader's motion.
    """
    beside: dict[tuple[int, Place], list[Sweep]] = {}
    for extra in extras:
        near = min(
            ((k, end) for k, lane in enumerate(lanes) for end in (lane.start, lane.end)),
            key=lambda each: (_apart(extra, each[1]), each[0]),
        )
        beside.setdefault(near, []).append(extra)
    found: list[Sweep] = []
    for k, lane in enumerate(lanes):
        flown = _begun(lane, here)
        for end in (flown.start, flown.end):
            for extra in sorted(beside.get((k, end), []), key=lambda each: _apart(each, here)):
                found.append(_begun(extra, here))
                here = found[-1].end
            if end == flown.start:
                found.append(flown)
                here = flown.end
    return found


def _begun(sweep: Sweep, here: Place) -> Sweep:
    return sweep if math.dist(here, sweep.start) <= math.dist(here, sweep.end) else sweep.reversed()


def _apart(sweep: Sweep, place: Place) -> float:
    return min(math.dist(sweep.start, place), math.dist(sweep.end, place))
