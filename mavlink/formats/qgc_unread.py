"""What a ``.plan`` says that is not taken over, told: members not known, heights and members said twice.

QGroundControl takes ``Altitude`` where it stands, MAVSDK ``params``; of a member that stands twice most
readers take the last, and some the first.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from mavlink.dialects.base import GLOBAL_FRAMES
from mavlink.formats.errors import FormatError
from mavlink.formats.notes import Notes
from mavlink.wire.items import MissionItem

_ROOT: Final = frozenset(("fileType", "version", "groundStation", "mission", "geoFence", "rallyPoints"))
_MISSION: Final = frozenset(
    ("version", "firmwareType", "vehicleType", "cruiseSpeed", "hoverSpeed", "items", "plannedHomePosition",
     "globalPlanAltitudeMode")
)  # fmt: skip
_FENCE: Final = frozenset(("version", "polygons", "circles", "polygon", "breachReturn"))
_RALLY: Final = frozenset(("version", "points"))
_ITEM: Final = frozenset(
    ("type", "frame", "command", "autoContinue", "doJumpId", "id", "params", "coordinate", "param1", "param2",
     "param3", "param4", "MISSION_ITEM_ID", "Altitude", "AltitudeMode", "AMSLAltAboveTerrain")
)  # fmt: skip
#: Heights from home and above the sea; those above terrain are worked out over QGroundControl's own.
_PLAIN_MODES, _OVER_TERRAIN = (1, 2), 3
#: Heights nearer than this say the same.
_SAME_M = 1e-6


def members_of(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """The object of a document's pairs.

    Raises
    ------
    FormatError
        A member stands twice and says different things.
    """
    members: dict[str, Any] = {}
    for key, value in pairs:
        if key in members and members[key] != value:
            raise FormatError(f"{key[:40]!r} stands twice in one object and says different things: keep one")
        members[key] = value
    return members


def tell_unknown(root: Mapping[str, Any], notes: Notes) -> None:
    """Name the members of a file, its mission, fence and rally points that are not known here."""
    found = [str(key) for key in root if key not in _ROOT]
    for name, known in (("mission", _MISSION), ("geoFence", _FENCE), ("rallyPoints", _RALLY)):
        part = root.get(name)
        if isinstance(part, dict):
            found += [f"{name}.{key}" for key in part if key not in known]
    if found:
        notes.add(f"members that are not known here are left out: {', '.join(key[:60] for key in found[:8])}")


def tell_item(entry: Mapping[str, Any], item: MissionItem, seq: int, notes: Notes) -> None:
    """Name what of a simple item is not taken over."""
    unknown = sorted(str(key)[:40] for key in entry if key not in _ITEM)
    if unknown:
        notes.add(f"members that are not known here are left out: {', '.join(unknown[:8])}", "item", seq)
    if item.frame not in GLOBAL_FRAMES:
        return
    mode, altitude_m = entry.get("AltitudeMode"), entry.get("Altitude")
    if mode == _OVER_TERRAIN:
        notes.add("its height over the ground is kept as the height above the sea in params", "item", seq)
        return
    if mode not in _PLAIN_MODES or isinstance(altitude_m, bool) or not isinstance(altitude_m, (int, float)):
        return
    if math.isfinite(item.z) and abs(altitude_m - item.z) > _SAME_M * max(1.0, abs(item.z)):
        notes.add(
            f"Altitude is {altitude_m:g} and the last of params {item.z:g}, which counts here and in MAVSDK, "
            "while QGroundControl takes the other",
            "item",
            seq,
        )
