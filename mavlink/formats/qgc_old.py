"""The older JSON files of QGroundControl, brought to the form of a ``.plan``.

Before ``.plan`` there was ``.mission``: version 2 is what now is the member ``mission``; version 1 keeps
complex items apart, home as an item, and an item's parameters one by one beside a ``coordinate``.
"""

from __future__ import annotations

from typing import Any

from mavlink.formats.errors import FormatError
from mavlink.formats.members import list_of, object_of
from mavlink.formats.notes import Notes

PLAN, MISSION = "Plan", "Mission"
_PARAMETERS = ("param1", "param2", "param3", "param4")


def as_plan(root: dict[str, Any], notes: Notes) -> dict[str, Any]:
    """The file as a ``.plan`` document; a file that is one as it stands.

    Raises
    ------
    FormatError
        Where it is none of QGroundControl's, or of a version that nothing reads.
    """
    kind = root.get("fileType")
    if kind is None and "mission" in root:
        notes.add("the file does not say its type, 'Plan' is meant")
        kind = PLAN
    if kind == PLAN:
        _check_version(root, (1,), "version")
        mission = object_of(root.get("mission"), "mission")
        _check_version(mission, (1, 2), "mission.version")
        return {**root, "mission": _newest(mission, notes)}
    if kind == MISSION or (kind is None and "items" in root):
        _check_version(root, (1, 2), "version")
        notes.add("the file is a .mission, which .plan has replaced: it holds no fence and no rally points")
        return {"mission": _newest(root, notes)}
    raise FormatError(f"fileType is {kind!r}, {PLAN!r} is meant")


def _check_version(holder: dict[str, Any], wanted: tuple[int, ...], name: str) -> None:
    version = holder.get("version")
    known = [*wanted, *(f"{number}.0" for number in wanted)]
    if isinstance(version, bool) or version not in known:
        meant = " or ".join(str(number) for number in wanted)
        raise FormatError(f"{name} is {version!r}, {meant} is meant")


def _newest(mission: dict[str, Any], notes: Notes) -> dict[str, Any]:
    """The mission of version 2, which keeps complex items among the others."""
    if mission["version"] in (2, "2.0"):
        return mission
    if list_of(mission.get("complexItems", []), "complexItems"):
        raise FormatError(
            "complexItems are of a version that holds no items: save the plan in QGroundControl again"
        )
    notes.add("the mission is of version 1, 2 is written")
    home = mission.get("plannedHomePosition")
    place = object_of(home, "plannedHomePosition").get("coordinate") if home is not None else None
    items = [
        {"doJumpId": entry.get("id"), **entry} if isinstance(entry, dict) else entry
        for entry in list_of(mission.get("items"), "mission.items")
    ]
    return {
        **{key: value for key, value in mission.items() if key != "MAV_AUTOPILOT"},
        "firmwareType": mission.get("MAV_AUTOPILOT", mission.get("firmwareType", 0)),
        "plannedHomePosition": place,
        "items": items,
    }


def as_simple_item(entry: dict[str, Any], name: str, notes: Notes) -> dict[str, Any]:
    """A simple item of any version with its seven ``params``.

    Raises
    ------
    FormatError
        Where its parameters are none of the three ways in which they were ever written.
    """
    if "params" not in entry and any(key in entry for key in _PARAMETERS):
        entry = {**entry, "params": [entry.get(key) for key in _PARAMETERS]}
    params = list_of(entry.get("params"), f"{name}.params")
    if len(params) == 4 and "coordinate" in entry:
        notes.add("items are written the old way, as four parameters and a coordinate")
        place = list_of(entry["coordinate"], f"{name}.coordinate")
        if len(place) != 3:
            raise FormatError(f"{name}.coordinate has {len(place)} numbers, 3 are meant")
        return {**entry, "params": [*params, *place]}
    if "coordinate" in entry and len(params) == 7 and list_of(entry["coordinate"], name) != params[4:]:
        notes.add("a coordinate beside seven parameters is left out")
    return entry
