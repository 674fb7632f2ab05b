"""Whether an item's latitude and longitude can be a place, and whether the two look swapped."""

from __future__ import annotations

from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.wire.items import Command

#: Commands up to this number fly somewhere (MAV_CMD_NAV_*).
_LAST_NAV = 95
_OTHERS_WITH_A_PLACE = frozenset(
    {Command.DO_SET_ROI_LOCATION, Command.DO_SET_ROI, Command.DO_REPOSITION, Command.DO_SET_HOME}
)


def check_place(command: int, frame: int, lat_deg: float, lon_deg: float) -> str | None:
    """What is wrong with an item's place; None where nothing is, or the command has none.

    DO commands use the two fields for other things whatever their frame says, so theirs are not judged.
    """
    if frame not in GLOBAL_FRAMES or not (command <= _LAST_NAV or command in _OTHERS_WITH_A_PLACE):
        return None
    return lat_lon_problem(lat_deg, lon_deg)


def lat_lon_problem(lat_deg: float, lon_deg: float) -> str | None:
    """What is wrong with a latitude and longitude, None where they are a place."""
    if abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0:
        return None
    wrong = f"latitude {lat_deg:g}" if not abs(lat_deg) <= 90.0 else f"longitude {lon_deg:g}"
    if abs(lat_deg) <= 180.0 and abs(lon_deg) <= 90.0:
        return f"{wrong} is out of range: latitude and longitude seem to be swapped"
    return f"{wrong} is out of range"
