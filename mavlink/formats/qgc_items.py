"""The items of a ``.plan`` in order, simple and complex, jumps naming the numbers of the vehicle."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

from mavlink.dialects import Autopilot
from mavlink.formats.columns import from_file
from mavlink.formats.errors import FormatError
from mavlink.formats.members import boolean_of, integer_of, list_of, number_of, object_of
from mavlink.formats.notes import Notes
from mavlink.formats.places import check_place
from mavlink.formats.qgc_complex import expand
from mavlink.formats.qgc_old import as_simple_item
from mavlink.formats.qgc_unread import tell_item
from mavlink.wire.items import Command, MissionItem

_SIMPLE = "SimpleItem"
#: What a simple item was called in the files of version 1.
_OLD_SIMPLE = "missionItem"
_PARAMS = 7


@dataclass(slots=True)
class _Numbers:
    """Which item has which number of the file; those inside complex items can be stale and count last."""

    simple: dict[int, int] = field(default_factory=dict)
    inside: dict[int, int] = field(default_factory=dict)
    repeated: set[int] = field(default_factory=set)


def read_items(mission: dict[str, Any], autopilot: Autopilot, notes: Notes) -> tuple[MissionItem, ...]:
    """All items, not yet numbered.

    Raises
    ------
    FormatError
        Naming the member that is wrong.
    """
    first_seq = 1 if autopilot == "ardupilot" else 0
    numbers = _Numbers()
    items: list[MissionItem] = []
    jumps: list[tuple[int, str]] = []
    for index, value in enumerate(list_of(mission.get("items"), "mission.items")):
        name = f"mission.items[{index}]"
        entry = object_of(value, name)
        if entry.get("type") not in (_SIMPLE, _OLD_SIMPLE):
            for inner_id, item in _expanded(entry, name, autopilot, notes):
                if inner_id is not None:
                    numbers.inside.setdefault(inner_id, len(items) + first_seq)
                items.append(item)
            continue
        if entry.get("doJumpId") is not None:
            jump_id = integer_of(entry["doJumpId"], f"{name}.doJumpId")
            if jump_id in numbers.simple:
                numbers.repeated.add(jump_id)
                notes.add(f"{name}.doJumpId {jump_id} stands twice: items are numbered anew")
            numbers.simple.setdefault(jump_id, len(items) + first_seq)
        item = _item(name, entry, notes)
        tell_item(entry, item, len(items) + first_seq, notes)
        if item.command == Command.DO_JUMP:
            jumps.append((len(items), name))
        items.append(item)
    targets = numbers.inside | numbers.simple
    for place, name in jumps:
        jump_to = items[place].param1
        number = int(jump_to) if math.isfinite(jump_to) else None
        target = None if number is None else targets.get(number)
        if target is None:
            raise FormatError(f"{name} jumps to {jump_to:g}, and no item has that doJumpId")
        if number in numbers.repeated:
            raise FormatError(f"{name} jumps to {jump_to:g}, and that doJumpId stands twice")
        items[place] = replace(items[place], param1=float(target))
    return tuple(items)


def _expanded(
    entry: dict[str, Any], name: str, autopilot: Autopilot, notes: Notes
) -> list[tuple[int | None, MissionItem]]:
    """The items that a complex item stands for, each with the number the file gives it."""
    found: list[tuple[int | None, MissionItem]] = []
    for inner, part in expand(entry, name, autopilot, notes):
        if isinstance(part, MissionItem):
            found.append((None, part))
            continue
        item = _item(inner, part, notes)
        if item.command == Command.DO_JUMP:
            raise FormatError(f"{inner} jumps, which nothing inside a complex item can")
        number = part.get("doJumpId")
        found.append((None if number is None else integer_of(number, f"{inner}.doJumpId"), item))
    return found


def _item(name: str, told: dict[str, Any], notes: Notes) -> MissionItem:
    entry = as_simple_item(told, name, notes)
    command = integer_of(entry.get("command"), f"{name}.command")
    if not 0 <= command <= 65535:
        raise FormatError(f"{name}.command {command} is none")
    frame = integer_of(entry.get("frame"), f"{name}.frame")
    if not 0 <= frame <= 255:
        raise FormatError(f"{name}.frame {frame} is none")
    values = _params(entry.get("params"), f"{name}.params", notes)
    first, second = values[4:6]
    if not (math.isnan(first) or math.isnan(second)):
        problem = check_place(command, frame, first, second)
        if problem:
            raise FormatError(f"{name}.params: {problem}")
    bare = MissionItem(
        0,
        frame,
        command,
        param1=values[0],
        param2=values[1],
        param3=values[2],
        param4=values[3],
        z=values[6],
        autocontinue=boolean_of(entry.get("autoContinue", True), f"{name}.autoContinue"),
    )
    try:
        return from_file(bare, first, second)
    except FormatError as error:
        raise FormatError(f"{name}.params: {error.message} for a place") from error


def _params(value: Any, name: str, notes: Notes) -> list[float]:
    numbers = [number_of(entry, name) for entry in list_of(value, name)]
    if not 4 <= len(numbers) <= _PARAMS:
        raise FormatError(f"{name} has {len(numbers)} numbers, {_PARAMS} are meant")
    if len(numbers) < _PARAMS:
        notes.add(f"{name} has {len(numbers)} numbers: those that lack are left open, as MAVSDK leaves them")
    return numbers + [math.nan] * (_PARAMS - len(numbers))
