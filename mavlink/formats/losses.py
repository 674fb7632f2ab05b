"""What of a mission a file of the other kind cannot hold, told item by item."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Literal

from mavlink.dialects.base import PARAMETERS, fence_shapes, is_polygon
from mavlink.dialects.compare import (
    ALTITUDE_TOLERANCE_M,
    PARAMETER_RELATIVE_TOLERANCE,
    PARAMETER_TOLERANCE,
)
from mavlink.dialects.mission import Mission
from mavlink.formats.columns import is_reframed, lost_digits
from mavlink.formats.notes import Notes
from mavlink.formats.waypoints import held_by_waypoints
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

_AMSL = (Frame.GLOBAL, Frame.GLOBAL_INT)
_RELATIVE = (Frame.GLOBAL_RELATIVE_ALT, Frame.GLOBAL_RELATIVE_ALT_INT)
_ITEMS = {MissionType.MISSION: "item", MissionType.FENCE: "fence item", MissionType.RALLY: "rally item"}
_WORDS = {"x": "the latitude's number", "y": "the longitude's number", "z": "altitude"}
_NAMES = {MissionType.FENCE: "fence", MissionType.RALLY: "rally points", MissionType.MISSION: "mission"}


def losses(mission: Mission, form: Literal["plan", "waypoints"]) -> tuple[str, ...]:
    """What :func:`write_plan` or :func:`write_waypoints` leaves out or alters, in words."""
    notes = Notes()
    for item in mission.mission:
        if is_reframed(item):
            words = f"the numbers of command {item.command} are no place: they are written in frame"
            notes.add(f"{words} {int(Frame.MISSION)}", "item", item.seq)
        lost = lost_digits(item)
        if lost is not None:
            notes.add(lost, "item", item.seq)
    if form == "plan":
        _in_plan(mission, notes)
    else:
        _in_waypoints(mission, notes)
    return notes.lines()


def lost_on_board(mission: Mission) -> tuple[str, ...]:
    """What the autopilot keeps of the items otherwise than they say, by its tables.

    Open numbers (NaN) ask for nothing, and frames that mean the same are the same.
    """
    notes = Notes()
    dialect = mission.dialect
    for kind, word in _ITEMS.items():
        meant = {item.seq: item for item in mission.items_of(kind)}
        for held in dialect.expected_readback(mission.items_of(kind)):
            for name, said, kept in _altered(meant[held.seq], held):
                notes.add(f"{name} is {said:.9g}, {dialect.name} keeps {kept:.9g}", word, held.seq)
    return notes.lines()


def _altered(meant: MissionItem, held: MissionItem) -> Iterator[tuple[str, float, float]]:
    """Names, what is said and what is kept."""
    for name in (*PARAMETERS, "x", "y", "z"):
        said, kept = float(getattr(meant, name)), float(getattr(held, name))
        tolerance = ALTITUDE_TOLERANCE_M if name == "z" else PARAMETER_TOLERANCE
        if math.isfinite(said) and not math.isclose(
            said, kept, rel_tol=PARAMETER_RELATIVE_TOLERANCE, abs_tol=tolerance
        ):
            yield _WORDS.get(name, f"{name[:-1]} {name[-1]}"), said, kept


def _in_waypoints(mission: Mission, notes: Notes) -> None:
    held = held_by_waypoints(mission)
    for kind in (MissionType.FENCE, MissionType.RALLY):
        if kind is not held and mission.items_of(kind):
            notes.add(f"the {_NAMES[kind]} has no place in a .waypoints file")
    if held is not MissionType.MISSION and mission.dialect.home_row and mission.mission:
        home = mission.mission[0]
        if _parameters(home) != (0.0, 0.0, 0.0, 0.0) or not home.autocontinue or home.frame not in _AMSL:
            notes.add(
                "of home its place and height above the sea alone have a place beside a fence or rally points"
            )
    told = mission.declared
    if told is not None and (told.mav_type, told.cruise_speed_m_s, told.hover_speed_m_s) != (
        None,
        None,
        None,
    ):
        notes.add("vehicle type and speeds have no place in a .waypoints file")
    if mission.autopilot != "ardupilot":
        return
    for item in mission.items_of(held):
        for name in (*PARAMETERS, "z"):
            if math.isnan(getattr(item, name)):
                words = "altitude" if name == "z" else f"{name[:-1]} {name[-1]}"
                notes.add(
                    f"{words} is open (NaN), which ArduPilot has not: it is written as 0", "item", item.seq
                )
        if item.written is not None and any(map(math.isnan, item.written)):
            notes.add(
                "the place is open (NaN), which ArduPilot has not: it is written as 0", "item", item.seq
            )


def _in_plan(mission: Mission, notes: Notes) -> None:
    if mission.dialect.home_row and mission.mission:
        home = mission.mission[0]
        if home.frame not in _AMSL:
            notes.add(f"home's altitude in frame {home.frame} has no place in a .plan", "item", 0)
        if _parameters(home) != (0.0, 0.0, 0.0, 0.0):
            notes.add("home's parameters have no place in a .plan", "item", 0)
    for name, items in (("fence", mission.fence), ("rally", mission.rally)):
        for item in items:
            if not item.autocontinue:
                notes.add(f"autocontinue 0 has no place in a .plan's {name}", f"{name} item", item.seq)
    for item in mission.fence:
        first, *others = _parameters(item)
        alone = item.command == Command.NAV_FENCE_RETURN_POINT
        if alone and item.seq < len(mission.fence) - 1:
            notes.add("the place to return to stands behind the fence in a .plan", "fence item", item.seq)
        if any(others) or (alone and first):
            notes.add("further parameters of a fence have no place in a .plan", "fence item", item.seq)
        if item.z and not alone:
            notes.add("the altitude of a fence has no place in a .plan", "fence item", item.seq)
        if item.frame not in _AMSL:
            notes.add(
                f"frame {item.frame} of a fence has no place in a .plan: 0 is meant", "fence item", item.seq
            )
    for command, shape in fence_shapes(mission.fence):
        told = shape[0].param1
        if is_polygon(command) and (len(shape) < 3 or len(shape) != told):
            words = f"the polygon says {told:g} corners and has {len(shape)}: it is written with those it has"
            notes.add(words, "fence item", shape[0].seq)
    for item in mission.rally:
        if any(_parameters(item)):
            notes.add("the parameters of a rally point have no place in a .plan", "rally item", item.seq)
        if item.frame not in _RELATIVE:
            words = (
                f"its altitude is of frame {item.frame}, and a .plan's rally points count theirs from home"
            )
            notes.add(words, "rally item", item.seq)


def _parameters(item: MissionItem) -> tuple[float, ...]:
    return tuple(getattr(item, name) for name in PARAMETERS)
