"""How many items of a mission a flight comes to, by a reckoning that is no less than what is encoded."""

from __future__ import annotations

import math
from itertools import pairwise

from planner.errors import Finding
from planner.profile.flight import Flight, Stretch
from planner.vehicle.aircraft import Aircraft

#: Largest distance of an arc from the chords between its waypoints, and the largest chord, as missions have
#: them where nothing else is asked for.
CHORD_ERROR_M, LARGEST_CHORD_RAD = 2.0, math.radians(45.0)
#: ArduPlane's arcs from so much on are a turn round their centre, of level ones no wider than this.
TURN_FROM_RAD, WIDEST_TURN_M, LEVEL_M = math.radians(60.0), 250.0, 1.0
#: Whole turns are one item; a little may be lost by rounding.
WHOLE_TURN_RAD = math.radians(359.9)
#: Arcs of what turns on the spot are corners, one for each right angle.
CORNER_M, CORNER_RAD = 2.1, math.radians(91.0)
#: Of each pass: on, off, and where PX4 is behind it when that is done; its ends are those of pieces. Of a
#: flight: home, take-off, speed, all off, where a landing begins, its approach and itself, and what a gimbal
#: is told before and behind.
ON_AND_OFF, LATE_OFF, EACH_FLIGHT = 2, 1, 10
#: The rule of a finding of a flight that has more.
TOO_MANY = "too-many-items"


def items_of(flight: Flight, passes: int, aircraft: Aircraft) -> int:
    """How many items a flight's mission has at most, its arcs said as they are by default.

    Parameters
    ----------
    passes
        How many it flies.
    """
    each_pass = ON_AND_OFF + (LATE_OFF if aircraft.autopilot == "px4" else 0)
    speeds = sum(one.most_m_s != other.most_m_s for one, other in pairwise(flight.stretches))
    stretches = sum(_of(stretch, aircraft) for stretch in flight.stretches)
    return EACH_FLIGHT + each_pass * passes + speeds + stretches


def too_many(name: str, count: int, most: int, why: str = "") -> Finding:
    """What is said of a flight that no upload takes.

    Parameters
    ----------
    why
        It is not several; empty where that is not known.
    """
    return Finding(
        name,
        TOO_MANY,
        f"one of its flights comes to about {count} items of a mission, and its autopilot holds {most}"
        + (f": {why}" if why else ""),
        "Plan a part of the regions at a time, or add batteries or aircraft.",
        "warning",
    )


def _of(stretch: Stretch, aircraft: Aircraft) -> int:
    segment = stretch.segment
    if segment is None:
        return 2
    turned_rad = abs(segment.turn_rad)
    if segment.kind == "straight" or turned_rad >= WHOLE_TURN_RAD:
        return 1
    if aircraft.hovers and segment.radius_m <= CORNER_M:
        # The line before it is not named where it ends: both meet in the corner.
        return math.ceil(turned_rad / CORNER_RAD) - 1
    level = abs(stretch.end_altitude_m - stretch.start_altitude_m) <= LEVEL_M
    plane = aircraft.autopilot == "ardupilot" and not aircraft.hovers
    if plane and level and turned_rad > TURN_FROM_RAD and segment.radius_m <= WIDEST_TURN_M:
        return 2
    bent = segment.radius_m <= CHORD_ERROR_M
    chord_rad = math.pi if bent else 2.0 * math.acos(1.0 - CHORD_ERROR_M / segment.radius_m)
    return math.ceil(turned_rad / min(chord_rad, LARGEST_CHORD_RAD))
