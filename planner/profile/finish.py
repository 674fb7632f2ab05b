"""How a flight ends where it is not said."""

from __future__ import annotations

import math

from planner.airspace.zones import KeepOut
from planner.plan import Finish
from planner.profile.rise import conflicts, ring
from planner.route import Terminal
from planner.vehicle.aircraft import Aircraft

#: A flight that ends nearer to its start than this returns to it.
NEAR_HOME_M = 200.0


def finish_of(aircraft: Aircraft, start: Terminal, end: Terminal) -> Finish:
    """The finish asked for; else a return where the end is near the start, a landing elsewhere.

    PX4's wings take no mission without a landing (MIS_TKO_LAND_REQ), so they always land.
    """
    if aircraft.finish != "auto":
        return aircraft.finish
    if aircraft.autopilot == "px4" and aircraft.type != "multirotor":
        return "land"
    return "return" if math.dist(start.ground, end.position) <= NEAR_HOME_M else "land"


def finish_among(
    aircraft: Aircraft, start: Terminal, end: Terminal, radius_m: float, zones: KeepOut
) -> Finish:
    """The same, but for a landing where the circle round home that a return ends in is not clear of zones.

    That circle lies round home whatever is beside it; a landing comes from where there is room.
    """
    finish = finish_of(aircraft, start, end)
    if aircraft.finish != "auto" or finish != "return" or aircraft.type == "multirotor":
        return finish
    hard, _ = conflicts(ring(start.ground, 0.0, "left", radius_m), zones)
    return "land" if hard else finish
