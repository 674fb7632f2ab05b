"""Is what the vehicle holds what was meant?

Both lists are brought to the form in which the vehicle gives items back (``Dialect.expected_readback``), the
home row is left out where the autopilot keeps one, and what remains is compared with these tolerances:

- sequence number, command, latitude and longitude: none;
- frame: none, but that the integer frames 5, 6 and 11 are the same as 0, 3 and 10;
- altitude: 11 mm, because ArduPilot truncates to centimetres after a conversion to 32-bit floats;
- parameters: one part in a million plus 1e-4, the width of a 32-bit float and of PX4's yaw in radians;
- NaN equals NaN;
- ``current`` and ``autocontinue`` are left out: ArduPilot ignores both, and PX4 marks the item it flies.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from mavlink.dialects.base import Dialect, mission_type_of
from mavlink.wire.items import Frame, MissionItem, MissionType

ALTITUDE_TOLERANCE_M = 0.011
PARAMETER_TOLERANCE = 1e-4
PARAMETER_RELATIVE_TOLERANCE = 1e-6

_EXACT = ("command", "x", "y", "mission_type")
#: MISSION_ITEM_INT means integers in either frame.
_SAME_FRAME: dict[int, int] = {
    Frame.GLOBAL_INT: Frame.GLOBAL,
    Frame.GLOBAL_RELATIVE_ALT_INT: Frame.GLOBAL_RELATIVE_ALT,
    Frame.GLOBAL_TERRAIN_ALT_INT: Frame.GLOBAL_TERRAIN_ALT,
}
_PARAMETERS = ("param1", "param2", "param3", "param4")


@dataclass(frozen=True, slots=True)
class Difference:
    """One number that the vehicle holds otherwise than meant.

    Parameters
    ----------
    seq
        The item; None where the lengths of the lists differ.
    field
        ``"count"``, ``"item"`` (missing or too many) or the name of a field of MissionItem.
    meant, held
        The two values, after what the autopilot is known to alter; None where there is none.
    """

    seq: int | None
    field: str
    meant: float | None
    held: float | None

    def __str__(self) -> str:
        where = "the list" if self.seq is None else f"item {self.seq}"
        return f"{where}: {self.field} should be {self.meant}, is {self.held}"


def differences(
    meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...], dialect: Dialect
) -> tuple[Difference, ...]:
    """What differs between the items meant and those read back; empty when they are equal.

    Parameters
    ----------
    meant
        As encoded for this dialect, home row included where it has one.
    held
        As downloaded, home row included where it has one.
    """
    drops_home = dialect.home_row and mission_type_of(held or meant) == MissionType.MISSION
    return tuple(
        _all_differences(
            dialect.expected_readback(meant),
            tuple(item for item in held if not (drops_home and item.seq == 0)),
        )
    )


def _all_differences(meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...]) -> Iterator[Difference]:
    if len(meant) != len(held):
        yield Difference(None, "count", len(meant), len(held))
    wanted = {item.seq: item for item in meant}
    found = {item.seq: item for item in held}
    for seq in sorted(wanted.keys() | found.keys()):
        if seq not in found:
            yield Difference(seq, "item", wanted[seq].command, None)
        elif seq not in wanted:
            yield Difference(seq, "item", None, found[seq].command)
        else:
            yield from _item_differences(wanted[seq], found[seq])


def _item_differences(meant: MissionItem, held: MissionItem) -> Iterator[Difference]:
    for name in _EXACT:
        if getattr(meant, name) != getattr(held, name):
            yield Difference(meant.seq, name, int(getattr(meant, name)), int(getattr(held, name)))
    if _frame(meant) != _frame(held):
        yield Difference(meant.seq, "frame", int(meant.frame), int(held.frame))
    if not _close(meant.z, held.z, ALTITUDE_TOLERANCE_M):
        yield Difference(meant.seq, "z", meant.z, held.z)
    for name in _PARAMETERS:
        if not _close(getattr(meant, name), getattr(held, name), PARAMETER_TOLERANCE):
            yield Difference(meant.seq, name, getattr(meant, name), getattr(held, name))


def _frame(item: MissionItem) -> int:
    return _SAME_FRAME.get(item.frame, item.frame)


def _close(meant: float, held: float, tolerance: float) -> bool:
    if math.isnan(meant) or math.isnan(held):
        return math.isnan(meant) and math.isnan(held)
    return math.isclose(meant, held, rel_tol=PARAMETER_RELATIVE_TOLERANCE, abs_tol=tolerance)
