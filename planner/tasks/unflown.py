"""What a search was still to fly when it is planned anew in flight."""

from __future__ import annotations

import math

import numpy as np

from planner.route import Look
from planner.scenario import Scenario
from planner.search.swaths import Looking
from planner.tasks.setting import Setting

Place = tuple[float, float]

#: On a pass is who is this near to its line, on its course about.
ON_M, ON_RAD = 30.0, math.radians(30.0)
#: The settling run of what is left of it begins so far ahead.
AHEAD_M = 1.0


def unflown_of(
    scenario: Scenario, setting: Setting, looking: Looking
) -> tuple[tuple[Place, Place, Look], ...]:
    """Lines of passes and the sides looked to, in flight order; none where the sensor does not look so.

    Of a pass that is being flown as much as lies behind a settling run from where the aircraft is: else it
    would have to turn back for it.
    """
    going_on, start = scenario.going_on, setting.ends[0]
    name = setting.model.aircraft.name
    passes = () if going_on is None else going_on.unflown.get(name, ())
    found: list[tuple[Place, Place, Look]] = []
    for number, one in enumerate(passes):
        begin, end = np.array(one.start), np.array(one.end)
        length_m = math.dist(begin, end)
        along = (end - begin) / length_m
        if number == 0 and start.over_home_m is not None and start.angle_rad is not None:
            off = np.array(start.position) - begin
            turned_rad = math.remainder(start.angle_rad - math.atan2(along[1], along[0]), math.tau)
            aside_m = abs(float(off @ np.array([-along[1], along[0]])))
            if aside_m <= ON_M and abs(turned_rad) <= ON_RAD:
                ahead_m = float(off @ along) + setting.model.settle_m + AHEAD_M
                begin = begin + min(max(ahead_m, 0.0), length_m) * along
        if one.look in looking.looks and math.dist(begin, end) > 0.0:
            found.append((tuple(begin.tolist()), one.end, one.look))
    return tuple(found)
