"""Speeds told along a mission: of collects that are flown more slowly than the rest, from braking on."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mavlink.dialects.mission import unplaced
from mavlink.encoding.stops import Stop
from mavlink.encoding.task import Task
from mavlink.wire.items import Command, MissionItem

_AIRSPEED = 0.0
_GROUND_SPEED = 1.0
_KEEP_THROTTLE = -1.0


def speed_item(task: Task, speed_m_s: float) -> MissionItem:
    """The order to fly at a speed from here on: over the ground of what hovers, else through the air."""
    kind = _GROUND_SPEED if task.hovers else _AIRSPEED
    return unplaced(Command.DO_CHANGE_SPEED, (kind, round(speed_m_s, 3), _KEEP_THROTTLE, 0.0))


def speeds_behind(task: Task, stops: Sequence[Stop]) -> dict[int, MissionItem]:
    """What is ordered behind stops, by their number; −1 is the mission's beginning.

    A speed holds from the stop before a slow collect, at which the plan begins to brake, to where its sensor
    goes off. Between two stops the least of those that are told counts.
    """
    cruise_m_s = task.vehicle.airspeed_m_s
    legs_m_s = [cruise_m_s] * (len(stops) + 1)
    collects = sorted(task.collects, key=lambda collect: collect.start_m)
    slow = [math.inf if each.speed_m_s is None else each.speed_m_s for each in collects]
    if all(math.isinf(speed_m_s) for speed_m_s in slow):
        return {}
    ends = sorted(range(len(slow)), key=lambda k: collects[k].end_m)
    flown: set[int] = set()
    begun = ended = 0
    for number, stop in enumerate(stops):
        flown -= set(ends[ended : ended + stop.off])
        ended += stop.off
        new = range(begun, begun + stop.on)
        begun += stop.on
        # The leg to a stop is of its number, that from it of the next one.
        legs_m_s[number] = min([legs_m_s[number], *(slow[k] for k in new)])
        flown |= set(new)
        legs_m_s[number + 1] = min([legs_m_s[number + 1], *(slow[k] for k in flown)])
    changed = [
        (number - 1, speed_m_s)
        for number, speed_m_s in enumerate(legs_m_s)
        if speed_m_s != (legs_m_s[number - 1] if number else cruise_m_s)
    ]
    return {number: speed_item(task, speed_m_s) for number, speed_m_s in changed}
