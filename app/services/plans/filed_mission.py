"""The mission file that a plan's document holds, where it was not planned here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.mission import Mission
from mavlink.formats import read_mission

#: The member of the document that holds it.
MEMBER = "mission_file"


def read_as(text: str, autopilot: str | None, vehicle_type: VehicleType | None) -> Mission:
    """A mission file's text for an autopilot and a type of vehicle; None for those that it names itself."""
    named: Autopilot | None = "px4" if autopilot == "px4" else "ardupilot" if autopilot else None
    return read_mission(text, named, vehicle_type)


def filed_mission(
    document: Mapping[str, Any], autopilot: str | None, vehicle_type: VehicleType | None
) -> Mission | None:
    """The mission of a document's file, for an autopilot and a vehicle; None where it holds none.

    What the file or whoever sent it says of the vehicle's type goes before ``vehicle_type``.
    """
    told = document.get(MEMBER)
    if told is None:
        return None
    mission = read_as(told["text"], autopilot or told["autopilot"], told["vehicle_type"])
    if mission.declared is not None and mission.declared.mav_type is None and vehicle_type is not None:
        mission = read_as(told["text"], autopilot or told["autopilot"], vehicle_type)
    return replace(mission, vehicle=told["vehicle"], notes=tuple(told["notes"]))
