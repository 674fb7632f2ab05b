"""Mission files of any kind that can be read: the kind is in the text, not in the name."""

from __future__ import annotations

from typing import Literal

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.mission import Mission
from mavlink.formats.errors import FormatError
from mavlink.formats.point_lists import is_point_list, read_point_list
from mavlink.formats.qgc_plan_read import read_plan
from mavlink.formats.waypoints import read_waypoints

FileKind = Literal["plan", "waypoints", "points"]

_UTF_16 = (b"\xff\xfe", b"\xfe\xff")


def kind_of(text: str) -> FileKind:
    """What a text looks like; ``waypoints`` where it looks like nothing known."""
    if text.lstrip("\ufeff \t\r\n").startswith("{"):
        return "plan"
    return "points" if is_point_list(text) else "waypoints"


def read_mission(
    content: bytes | str, autopilot: Autopilot | None = None, vehicle_type: VehicleType | None = None
) -> Mission:
    """The mission, fence and rally points of a ``.plan``, ``.mission``, ``.waypoints``, fence or rally file.

    Parameters
    ----------
    autopilot
        For whom it is; None for the one that the file names, or ArduPilot where it cannot name one.
    vehicle_type
        Likewise; None for a fixed wing where the file does not say, with a note.

    Raises
    ------
    FormatError
        With line and column, or the member, that is wrong.
    """
    text = content if isinstance(content, str) else decoded(content)
    kind = kind_of(text)
    if kind == "plan":
        return read_plan(text, autopilot, vehicle_type)
    reader = read_point_list if kind == "points" else read_waypoints
    return reader(text, autopilot or "ardupilot", vehicle_type)


def decoded(content: bytes) -> str:
    """The text of a file; what is no UTF-8 is taken for Latin-1, which only comments can show.

    Raises
    ------
    FormatError
        Where it is no text.
    """
    if b"\0" in content and not content.startswith(_UTF_16):
        raise FormatError("the file is no text")
    try:
        return content.decode("utf-16" if content.startswith(_UTF_16) else "utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")
