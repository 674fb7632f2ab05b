"""The two columns of an item's place, between a file's numbers and the wire's integers.

In a global frame a file says degrees and the wire 1e-7 degrees. In frame 2 (MISSION) and in local frames both
say the same number, which the wire holds whole. What the integers cannot hold is kept in
``MissionItem.written`` for the next file and told where it goes to a vehicle.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.dialects.mission import placed
from mavlink.formats.errors import FormatError
from mavlink.formats.places import lat_lon_problem
from mavlink.wire.items import Command, Frame, MissionItem

_LARGEST = 2**31 - 1
#: Flags and ids of ArduPilot's global frames, divided by 1e7 as if they were a place, stay under this.
_LARGEST_SCALED = 0.01
#: Their two columns are numbers of their own, never a place.
NUMBERS_FOR_PLACE = frozenset(
    {Command.DO_DIGICAM_CONTROL, Command.DO_SET_ACTUATOR, Command.DO_GIMBAL_MANAGER_PITCHYAW}
)


def scale_of(frame: int) -> float:
    """How often the wire's unit goes into the file's."""
    return 1e7 if frame in GLOBAL_FRAMES else 1.0


def from_file(item: MissionItem, first: float, second: float) -> MissionItem:
    """The item with the two columns of a file.

    Raises
    ------
    FormatError
        A number that no integer of 32 bits is near to.
    """
    scale = 1.0 if _is_plain(item, first, second) else scale_of(item.frame)
    x, y = (_wire(value, scale) for value in (first, second))
    exact = scale == scale_of(item.frame) and (x / scale, y / scale) == (first, second)
    return replace(item, x=x, y=y, written=None if exact else (first, second))


def _is_plain(item: MissionItem, first: float, second: float) -> bool:
    """Whether numbers stand in a global frame as they are, which is how ArduPilot's stations write them."""
    return item.command in NUMBERS_FOR_PLACE and any(
        abs(value) >= _LARGEST_SCALED or item.command == Command.DO_SET_ACTUATOR for value in (first, second)
    )


def _wire(value: float, scale: float) -> int:
    if math.isnan(value):
        return 0
    if not abs(value * scale) <= _LARGEST:
        raise FormatError(f"{value:g} is out of range")
    return round(value * scale)


def for_file(item: MissionItem) -> MissionItem:
    """The item as a file says it: numbers that are no place stand in a frame without degrees.

    ArduPilot gives every command back in a global frame, where other readers take the numbers for degrees.
    """
    if not is_reframed(item):
        return item
    fractions = item.written is not None and any(value != round(value) for value in item.written)
    return replace(item, frame=int(Frame.MISSION), written=item.written if fractions else None)


def is_reframed(item: MissionItem) -> bool:
    """Whether :func:`for_file` gives the item another frame."""
    return item.command in NUMBERS_FOR_PLACE and item.frame in GLOBAL_FRAMES and bool(item.x or item.y)


def in_file(item: MissionItem) -> tuple[float, float]:
    """What a file says in the two columns; whole numbers where the frame has no degrees."""
    if item.written is not None:
        return item.written
    if item.frame not in GLOBAL_FRAMES:
        return item.x, item.y
    return item.x / 1e7, item.y / 1e7


def first_place(items: Iterable[MissionItem]) -> tuple[float, float] | None:
    """Latitude and longitude of the first item that is somewhere; other numbers are passed over."""
    for item in items:
        if item.frame not in GLOBAL_FRAMES or item.command in NUMBERS_FOR_PLACE:
            continue
        place = in_file(item)
        if all(map(math.isfinite, place)) and any(place) and lat_lon_problem(*place) is None:
            return place
    return None


def placed_exactly(
    command: int, lat_deg: float, lon_deg: float, altitude_m: float, frame: int, name: str
) -> MissionItem:
    """An item at a place of a file, all its digits kept.

    Raises
    ------
    FormatError
        Naming the member, where that is nowhere on Earth.
    """
    problem = lat_lon_problem(lat_deg, lon_deg)
    if problem:
        raise FormatError(f"{name}: {problem}; {lat_deg}, {lon_deg} is nowhere on Earth")
    bare = placed(command, (0.0, 0.0), 0.0, frame)
    return replace(from_file(bare, lat_deg, lon_deg), z=altitude_m)


def lost_digits(item: MissionItem) -> str | None:
    """What of the two columns a vehicle cannot hold, in words; None for nothing worth telling."""
    if item.written is None:
        return None
    if any(math.isnan(value) for value in item.written):
        return "a place left open (null) goes to the vehicle as 0"
    if item.frame in GLOBAL_FRAMES:
        return None  # finer than 1e-7 degrees, a hundredth of a metre
    first, second = item.written
    return (
        f"{first:.9g}, {second:.9g} in frame {item.frame}, which has no fractions, goes to the vehicle as "
        f"{item.x}, {item.y}: give it a global frame where it is a place"
    )
