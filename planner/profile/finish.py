"""How a flight ends where it is not said."""

from __future__ import annotations

import math

from planner.airspace.zones import AREA, KeepOut
from planner.errors import InfeasibleError
from planner.plan import Finish
from planner.profile.rise import ring
from planner.route import Terminal
from planner.vehicle.aircraft import Aircraft

#: A flight that ends nearer to its start than this returns to it.
NEAR_HOME_M = 200.0
#: Farther from a zone by this much a circle is clear of it.
CLEAR_M = 1.0


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

    Raises
    ------
    InfeasibleError
        Where a return is asked for whose circle is not clear.
    """
    finish = finish_of(aircraft, start, end)
    if finish != "return" or aircraft.type == "multirotor":
        return finish
    circle = ring(start.ground, 0.0, "left", radius_m)
    hard = [each for each in ([] if zones.clear(circle) else zones.conflicts(circle)) if each.hard]
    if not hard:
        return finish
    if aircraft.finish == "auto":
        return "land"
    deepest = hard[0]
    by_m = math.ceil(deepest.depth_m + CLEAR_M)
    where = "leave the area by" if deepest.zone == AREA else f"enter {deepest.zone} by"
    raise InfeasibleError(
        AREA if deepest.zone == AREA else "hard-zone",
        start.name,
        f"the circle of {radius_m:.0f} m round it that finish: return ends in would {where} "
        f"{deepest.depth_m:.0f} m",
        f"Set finish: land (or auto), or have {start.name} {by_m} m farther from there.",
        deepest.where,
    )
