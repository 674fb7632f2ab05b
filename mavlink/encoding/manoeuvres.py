"""Where a fixed wing circles up at the start and comes down at the end, inside the plan's fence.

A plan's path begins and ends in the air at the plan's altitude; these are the two pieces of flight that a
mission adds. Each has a few possible places; the first that lies wholly in the room is taken, else the one
that leaves it least.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeVar

from mavlink.encoding.fence import Room
from mavlink.wire.geometry import Xy, offset

#: Kept free round every circle and line that is chosen here.
MARGIN_M = 20.0
_HEADINGS = 24


@dataclass(frozen=True, slots=True)
class Orbit:
    """A circle to climb or descend on.

    Parameters
    ----------
    centre
        East and north in metres.
    radius_m
        As MAVLink has it: positive clockwise, negative counter-clockwise.
    leave_m
        Where it touches the first line of the path, measured from the path's start: negative before it. None
        where it does not touch it.
    outside_m2
        How much of it leaves the room.
    """

    centre: Xy
    radius_m: float
    leave_m: float | None = None
    outside_m2: float = 0.0


@dataclass(frozen=True, slots=True)
class Landing:
    """A circle down, a straight approach and a touch-down."""

    orbit: Orbit
    approach: Xy
    approach_altitude_m: float
    outside_m2: float


_Candidate = TypeVar("_Candidate", Orbit, Landing)


def orbit_radius_m(min_turn_radius_m: float) -> float:
    """A whole number of metres somewhat above the tightest turn; above 255 m in steps of ten."""
    radius_m = math.ceil(1.05 * min_turn_radius_m)
    return float(radius_m if radius_m <= 255 else math.ceil(radius_m / 10) * 10)


def climb_orbit(start: Xy, angle_rad: float, radius_m: float, straight_m: float, room: Room) -> Orbit:
    """A circle that is left along the first line of the path.

    Parameters
    ----------
    start, angle_rad
        Where the path begins and in which direction.
    straight_m
        How much of the path's beginning is straight and needed for nothing: the circle may lie along it when
        there is no room at the start.

    Notes
    -----
    The tangent point lies a radius before the start, so that the aircraft is on the line when the path
    begins and the start is outside the circle, as autopilots want of the place they leave it for.
    """

    def orbits() -> Iterator[Orbit]:
        leave_m = -radius_m
        # The circle must be left some way before the straight ends, or there is no tangent to leave it on.
        while leave_m <= max(-radius_m, straight_m - radius_m):
            for side in (1.0, -1.0):
                centre = offset(start, angle_rad, leave_m, side * radius_m)
                line = [offset(start, angle_rad, leave_m), start]
                yield Orbit(
                    centre,
                    -side * radius_m,
                    leave_m,
                    room.orbit_outside_m2(centre, radius_m, MARGIN_M)
                    + (room.line_outside_m2(line, 1.0) if leave_m < 0.0 else 0.0),
                )
            leave_m += radius_m
        yield Orbit(start, radius_m, None, room.orbit_outside_m2(start, radius_m, MARGIN_M))

    return _clearest(orbits())


def takeoff_place(home: Xy, angle_rad: float, distance_m: float, room: Room) -> Xy:
    """A place to climb towards: along the path's first direction when that is clear, else another."""
    for part in (1.0, 0.5, 0.25):
        for turn in sorted(range(_HEADINGS), key=lambda n: min(n, _HEADINGS - n)):
            place = offset(home, angle_rad + turn * 2.0 * math.pi / _HEADINGS, part * distance_m)
            if room.line_outside_m2([home, place], MARGIN_M) <= 0.0:
                return place
    return offset(home, angle_rad, distance_m)


def landing(
    land: Xy,
    angle_rad: float,
    radius_m: float,
    approach_altitude_m: float,
    slope_deg: float,
    room: Room,
    least_run_m: float = 0.0,
) -> Landing:
    """A way down to a place: circle, then a straight approach whose slope is kept, preferably ahead.

    Parameters
    ----------
    angle_rad
        Direction in which the aircraft arrives over the place.
    approach_altitude_m
        Height over the place at which the straight approach begins; lowered when there is no room.
    slope_deg, least_run_m
        The approach is no steeper and no shorter.
    """

    def landings() -> Iterator[Landing]:
        for part in (1.0, 0.75, 0.5):
            altitude_m = part * approach_altitude_m
            run_m = max(least_run_m, altitude_m / math.tan(math.radians(slope_deg)))
            for turn in sorted(range(_HEADINGS), key=lambda n: min(n, _HEADINGS - n)):
                final_rad = angle_rad + turn * 2.0 * math.pi / _HEADINGS
                for side in (1.0, -1.0):
                    yield _landing(land, final_rad, side, radius_m, altitude_m, run_m, room)

    return _clearest(landings())


def _landing(
    land: Xy, final_rad: float, side: float, radius_m: float, altitude_m: float, run_m: float, room: Room
) -> Landing:
    approach = offset(land, final_rad, -run_m)
    tangent = offset(approach, final_rad, -radius_m)
    centre = offset(tangent, final_rad, 0.0, side * radius_m)
    outside_m2 = (
        room.orbit_outside_m2(centre, radius_m, MARGIN_M)
        + room.line_outside_m2([tangent, land], MARGIN_M)
        + room.line_outside_m2([land, centre], MARGIN_M)
    )
    return Landing(Orbit(centre, -side * radius_m), approach, altitude_m, outside_m2)


def _clearest(candidates: Iterable[_Candidate]) -> _Candidate:
    """The first that stays in the room, else the one that leaves it least."""
    best: _Candidate | None = None
    for candidate in candidates:
        if candidate.outside_m2 <= 0.0:
            return candidate
        if best is None or candidate.outside_m2 < best.outside_m2:
            best = candidate
    if best is None:
        raise ValueError("nothing to choose from")
    return best
