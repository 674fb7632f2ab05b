"""What the stages hand on: places and directions, passes that see a region, their order, lines flown."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

from shapely.geometry import Polygon

Point = tuple[float, float]

#: The side of the line that a sensor looks to, or straight down.
Look = Literal["left", "right", "down"]


@dataclass(frozen=True, slots=True)
class Pose:
    """A place and a direction: metres east and north, radians counter-clockwise from east."""

    east_m: float
    north_m: float
    angle_rad: float

    @property
    def position(self) -> Point:
        """East and north in metres."""
        return (self.east_m, self.north_m)


@dataclass(frozen=True, slots=True)
class Slow:
    """A speed over the ground that a pass is flown no faster than, and what braking to it takes before."""

    speed_m_s: float
    braking_m: float


@dataclass(frozen=True, slots=True)
class CollectPass:
    """One straight pass with the sensor on, run-in and run-out of half an aperture included.

    Parameters
    ----------
    regions
        Names of the regions it sees: one, or several where neighbours were merged.
    sensor, look
        The sensor and the side it looks to.
    start, end
        East and north in metres, in flight direction.
    eta
        η of eq 18 (Li et al. 2018), 0 at the innermost and 1 at the outermost line.
    footprint
        Ground seen at full resolution.
    photo_spacing_m
        The widest distance between photos that keeps their overlap; None where none are taken.
    goes_on
        Whether it is flown on from the pass before it, in one turn, without settling: round a ring.
    slow
        Where it is flown more slowly than the flight.
    """

    regions: tuple[str, ...]
    sensor: str
    look: Look
    start: Point
    end: Point
    eta: float
    footprint: Polygon
    photo_spacing_m: float | None = None
    goes_on: bool = False
    slow: Slow | None = None

    @property
    def angle_rad(self) -> float:
        """Flight direction."""
        return math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])

    @property
    def length_m(self) -> float:
        """Length of the line."""
        return math.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])

    @property
    def entry(self) -> Pose:
        """Pose at sensor on."""
        return Pose(*self.start, self.angle_rad)

    def settling(self, settle_m: float) -> Pose:
        """Pose where the straight flight before it begins."""
        scale = 0.0 if self.goes_on else settle_m / self.length_m
        ahead = self.end[0] - self.start[0], self.end[1] - self.start[1]
        return Pose(self.start[0] - scale * ahead[0], self.start[1] - scale * ahead[1], self.angle_rad)

    @property
    def exit(self) -> Pose:
        """Pose at sensor off."""
        return Pose(*self.end, self.angle_rad)


@dataclass(frozen=True, slots=True)
class Route:
    """The passes of one aircraft in flight order."""

    passes: tuple[CollectPass, ...]


@dataclass(frozen=True, slots=True)
class Anchor:
    """One end of a transit: a place, and the direction of flight there (any where ``angle_rad`` is None)."""

    east_m: float
    north_m: float
    angle_rad: float | None = None

    @property
    def position(self) -> Point:
        """East and north in metres."""
        return (self.east_m, self.north_m)


@dataclass(frozen=True, slots=True)
class Terminal:
    """Where the flight starts or ends; any direction where ``angle_rad`` is None.

    Parameters
    ----------
    run_m, runs_rad
        Flown straight from a start before anything else, and the directions of it to choose among.
    over_home_m
        Height over home of an aircraft that is in the air already; None on the ground.
    home
        Where it took off, if not here.
    """

    name: str
    position: Point
    angle_rad: float | None = None
    run_m: float = 0.0
    runs_rad: tuple[float, ...] = ()
    over_home_m: float | None = None
    home: Point | None = None

    @property
    def ground(self) -> Point:
        """Where it took off, or takes off."""
        return self.position if self.home is None else self.home

    def after_run(self, angle_rad: float) -> tuple[float, float, float]:
        """Where a run in a direction ends, and that direction."""
        east_m, north_m = self.position
        return (
            east_m + self.run_m * math.cos(angle_rad),
            north_m + self.run_m * math.sin(angle_rad),
            angle_rad,
        )


class LinePiece(Protocol):
    """A straight or an arc; ``planner.dubins.path.Segment`` is one."""

    @property
    def kind(self) -> str:
        """``straight``, ``left`` or ``right``."""

    @property
    def start(self) -> Pose:
        """Pose at its beginning."""

    @property
    def length_m(self) -> float:
        """Along the line."""

    @property
    def radius_m(self) -> float:
        """Of the arc; inf for a straight."""

    @property
    def turn_rad(self) -> float:
        """Change of direction, to the left positive."""


class Line(Protocol):
    """Pieces end to end; ``planner.dubins.path.Path`` is one."""

    @property
    def segments(self) -> Sequence[LinePiece]:
        """In flight order."""

    @property
    def length_m(self) -> float:
        """Along the line."""
