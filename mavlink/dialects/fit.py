"""A mission from elsewhere as an autopilot can hold it: what it means the same by is changed, and told."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from mavlink.dialects.base import GLOBAL_FRAMES, Dialect
from mavlink.dialects.mission import Mission
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult

_NAN_ANSWERS: Mapping[MissionResult, str] = {
    MissionResult.INVALID_PARAM1: "param1",
    MissionResult.INVALID_PARAM2: "param2",
    MissionResult.INVALID_PARAM3: "param3",
    MissionResult.INVALID_PARAM4: "param4",
}


def fitted(mission: Mission) -> Mission:
    """The mission for its vehicle, with a note for each item that was changed.

    Open numbers that ArduPilot refuses become 0, which it takes them for; items without a place that PX4
    takes in frame 2 alone are put there; the home row counts from the sea. Missions of our own fit already.
    """
    if mission.declared is None:
        return mission
    dialect = mission.dialect
    notes: list[str] = []
    items: list[MissionItem] = []
    for item in mission.mission:
        if dialect.home_row and item.seq == 0:
            items.append(_home(item))
            continue
        fit, words = _closed(item, dialect)
        fit, more = _framed(fit, dialect)
        items.append(fit)
        notes += [f"item {item.seq}: {word}" for word in (*words, *more)]
    return replace(mission, mission=tuple(items), notes=(*mission.notes, *notes))


def _home(item: MissionItem) -> MissionItem:
    """ArduPilot drops the row, and takes home from where it stands."""
    return replace(item, frame=int(Frame.GLOBAL))


def _closed(item: MissionItem, dialect: Dialect) -> tuple[MissionItem, list[str]]:
    """Without the open numbers that are refused."""
    words = []
    while (name := _NAN_ANSWERS.get(dialect.answer(item))) and math.isnan(getattr(item, name)):
        item = _zeroed(item, name)
        words.append(f"{name[:-1]} {name[-1]} is open (NaN), which {dialect.name} refuses: it is sent as 0")
    return item, words


def _zeroed(item: MissionItem, name: str) -> MissionItem:
    match name:
        case "param1":
            return replace(item, param1=0.0)
        case "param2":
            return replace(item, param2=0.0)
        case "param3":
            return replace(item, param3=0.0)
    return replace(item, param4=0.0)


def _framed(item: MissionItem, dialect: Dialect) -> tuple[MissionItem, list[str]]:
    """In the frame that is taken, where the item has no place to lose."""
    if dialect.autopilot != "px4" or item.frame not in GLOBAL_FRAMES or item.x or item.y:
        return item, []
    moved = replace(item, frame=int(Frame.MISSION))
    if item.command in (Command.NAV_ROI, Command.DO_SET_ROI):
        return item, []
    if dialect.answer(item) == MissionResult.ACCEPTED or dialect.answer(moved) != MissionResult.ACCEPTED:
        return item, []
    return moved, [f"frame {int(item.frame)} is not taken for command {item.command}: it is sent in frame 2"]
