"""Which missions PX4 takes and then declares invalid.

MISSION_ACK says ACCEPTED for these too, and the reason comes in an event only: they are found out before.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

from mavlink.dialects.base import GLOBAL_FRAMES, DialectFinding, VehicleType
from mavlink.wire.geometry import distance_m
from mavlink.wire.items import Command, Frame, MissionItem

_TAKEOFFS = frozenset({Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF})
_LANDINGS = frozenset({Command.NAV_LAND, Command.NAV_VTOL_LAND})
_VTOL_ONLY = frozenset({Command.NAV_VTOL_TAKEOFF, Command.NAV_VTOL_LAND})
#: PX4 takes this for an item with a place when it looks for the take-off.
_COUNTS_AS_PLACE = frozenset({Command.DO_SET_ACTUATOR})
_ABSOLUTE = frozenset({Frame.GLOBAL, Frame.GLOBAL_INT})


def feasibility_findings(
    items: tuple[MissionItem, ...],
    *,
    vehicle_type: VehicleType,
    landing_required: bool,
    max_landing_slope_deg: float,
    acceptance_radius_m: float,
) -> Iterator[DialectFinding]:
    """Take-off first, landing last, an approach that can be flown."""
    if vehicle_type != "vtol":
        for item in items:
            if item.command in _VTOL_ONLY:
                yield DialectFinding(
                    "vtol-item",
                    f"command {item.command} makes the mission of a {vehicle_type} invalid",
                    item.seq,
                )
    yield from _takeoff_findings(items, landing_required, acceptance_radius_m)
    if landing_required and not any(item.command in _LANDINGS for item in items):
        yield DialectFinding("landing-missing", "a landing is required, and RTL does not count")
    if vehicle_type == "multirotor":
        return
    yield from _land_start_findings(items)
    for before, item in pairwise(items):
        if item.command == Command.NAV_LAND:
            yield from _approach_findings(before, item, max_landing_slope_deg)
    if items and items[0].command in _LANDINGS:
        yield DialectFinding("landing-first", "the mission starts with a landing", items[0].seq)


def _takeoff_findings(
    items: tuple[MissionItem, ...], required: bool, acceptance_radius_m: float
) -> Iterator[DialectFinding]:
    takeoffs = [item for item in items if item.command in _TAKEOFFS]
    if not takeoffs:
        if required:
            yield DialectFinding("takeoff-missing", "a take-off is required")
        return
    takeoff = takeoffs[0]
    for item in items[: items.index(takeoff)]:
        if item.frame in GLOBAL_FRAMES or item.command in _COUNTS_AS_PLACE:
            yield DialectFinding(
                "takeoff-not-first", f"command {item.command} stands before the take-off", item.seq
            )
    # Above sea level the height over home is not known here.
    if takeoff.frame not in _ABSOLUTE and takeoff.z - 1.0 < acceptance_radius_m:
        yield DialectFinding(
            "takeoff-too-low",
            f"climbs to {takeoff.z:g} m, at least {acceptance_radius_m + 1.0:g} m are needed",
            takeoff.seq,
        )


def _land_start_findings(items: tuple[MissionItem, ...]) -> Iterator[DialectFinding]:
    starts = [index for index, item in enumerate(items) if item.command == Command.DO_LAND_START]
    if not starts:
        return
    if len(starts) > 1:
        yield DialectFinding("land-start-repeated", "more than one DO_LAND_START", items[starts[1]].seq)
    after = items[starts[0] + 1 :]
    if not any(item.command in _LANDINGS for item in after):
        yield DialectFinding("land-start-alone", "no landing follows DO_LAND_START", items[starts[0]].seq)
    for item in after:
        if item.command == Command.NAV_RETURN_TO_LAUNCH:
            yield DialectFinding("rtl-after-land-start", "RTL behind DO_LAND_START is refused", item.seq)


def _approach_findings(
    before: MissionItem, land: MissionItem, max_landing_slope_deg: float
) -> Iterator[DialectFinding]:
    if before.frame not in GLOBAL_FRAMES:
        yield DialectFinding("approach-missing", "no place stands right before the landing", land.seq)
        return
    if before.command not in (Command.NAV_WAYPOINT, Command.NAV_LOITER_TO_ALT):
        yield DialectFinding(
            "approach-kind", "only a waypoint or LOITER_TO_ALT may lead to the landing", before.seq
        )
        return
    if (before.frame in _ABSOLUTE) != (land.frame in _ABSOLUTE):
        yield DialectFinding(
            "approach-datum", "approach and landing count their heights from different places", land.seq
        )
        return
    height_m = before.z - land.z
    if height_m <= 0.0:
        yield DialectFinding(
            "approach-below-land", f"the approach is {-height_m:g} m below the landing point", before.seq
        )
        return
    run_m = distance_m((before.y / 1e7, before.x / 1e7), (land.y / 1e7, land.x / 1e7))
    if before.command == Command.NAV_LOITER_TO_ALT:
        radius_m = abs(before.param2)
        if run_m <= radius_m:
            yield DialectFinding(
                "approach-inside-orbit", "the landing point lies inside the orbit before it", before.seq
            )
            return
        run_m = math.sqrt(run_m**2 - radius_m**2)
    slope_deg = math.degrees(math.atan2(height_m, run_m))
    if slope_deg > max_landing_slope_deg:
        yield DialectFinding(
            "approach-too-steep",
            f"{slope_deg:.2f}° down to the landing point, {max_landing_slope_deg:g}° are allowed",
            before.seq,
        )
