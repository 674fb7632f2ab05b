"""What there is to choose from for one region: its collection segments, each graded by the room it has."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage.merge import MergedRegion
from planner.coverage.strips.classify import STEP_RAD
from planner.coverage.strips.neighbourhood import complementary, neighbourhoods
from planner.coverage.strips.room import FORBIDDEN, Grades, Room
from planner.coverage.strips.segments import Neighbourhood
from planner.errors import InfeasibleError
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]

#: Step of η in the search of eq 22; the paper does not state its own.
ETA_STEP = 0.05


@dataclass(frozen=True, slots=True)
class Side:
    """The collection neighbourhood for one side of view, with the grade of every choice in it.

    Parameters
    ----------
    grades
        int16, shape (M, K): angle and η; of a distributed region (M, K, K): angle, η₁ and η₂.
    """

    neighbourhood: Neighbourhood
    grades: Grades


@dataclass(frozen=True, slots=True)
class Choices:
    """All ways to see one region from inside the operating area and outside hard zones.

    Parameters
    ----------
    etas
        Float64, shape (K,), from 0 to 1 in equal steps.
    best
        The best grade there is; only choices with this grade are taken.
    """

    region: MergedRegion
    turns: int
    etas: Floats
    sides: tuple[Side, ...]
    best: int


def choices(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    room: Room,
    eta_step: float = ETA_STEP,
    step_rad: float = STEP_RAD,
) -> Choices:
    """Grade the collection neighbourhood of a region.

    The fewest turns that can be flown are taken (Definition 1): a region one pass would see gets two where
    every single pass leaves the area or enters a hard zone.

    Raises
    ------
    InfeasibleError
        ``"swath"`` or ``"approach"`` where no pass sees the region, ``"area"`` or ``"hard-zone"`` where those
        that do may not be flown.
    """
    etas = np.linspace(0.0, 1.0, max(2, round(1.0 / eta_step) + 1))
    least = neighbourhoods(region, sensor, height_m, step_rad)
    found = _graded(region, least, etas, room)
    if found.best >= FORBIDDEN and least[0].turns == 0:
        found = _with_two_passes(region, sensor, height_m, room, etas, step_rad) or found
    if found.best < FORBIDDEN:
        return found
    open_room = replace(room, hard=Polygon())
    zoned = not room.hard.is_empty and _graded(region, least, etas, open_room).best < FORBIDDEN
    raise InfeasibleError(
        "hard-zone" if zoned else "area",
        region.label,
        f"every pass that sees it leaves the operating area{' or crosses a hard zone' if zoned else ''}",
        "enlarge the area round the region, change the altitude, or let the sensor look to both sides",
        region.centroid,
    )


def _with_two_passes(
    region: MergedRegion, sensor: SarSensor, height_m: float, room: Room, etas: Floats, step_rad: float
) -> Choices | None:
    turns: Literal[1] = 1
    try:
        return _graded(region, neighbourhoods(region, sensor, height_m, step_rad, turns), etas, room)
    except InfeasibleError:
        # Limits on the direction may allow single passes only: the caller reports these.
        return None


def _graded(region: MergedRegion, around: tuple[Neighbourhood, ...], etas: Floats, room: Room) -> Choices:
    sides = tuple(Side(side, _grades(side, etas, room)) for side in around)
    best = min(int(side.grades.min()) for side in sides)
    return Choices(region, around[0].turns, etas, sides, best)


def _grades(side: Neighbourhood, etas: Floats, room: Room) -> Grades:
    first = room.grade(side.lines(etas))
    if side.turns == 0:
        return first
    second = room.grade(side.lines(etas, opposite=True))
    both = np.minimum(first[:, :, None] + second[:, None, :], FORBIDDEN)
    return np.where(complementary(etas), both, FORBIDDEN).astype(np.int16)
