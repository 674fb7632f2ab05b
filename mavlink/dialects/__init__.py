"""What ArduPilot and PX4 take, alter and refuse, as tables."""

from __future__ import annotations

from mavlink.dialects.ardupilot import ArduPilotDialect, ardupilot_dialect
from mavlink.dialects.base import Autopilot, Dialect, DialectFinding, VehicleType
from mavlink.dialects.px4 import Px4Dialect, px4_dialect

__all__ = [
    "ArduPilotDialect",
    "Autopilot",
    "Dialect",
    "DialectFinding",
    "Px4Dialect",
    "VehicleType",
    "dialect_for",
]


def dialect_for(autopilot: Autopilot, vehicle_type: VehicleType) -> Dialect:
    """The dialect of an autopilot on a type of vehicle, with its default parameters."""
    if autopilot == "ardupilot":
        return ardupilot_dialect(vehicle_type)
    if autopilot == "px4":
        return px4_dialect(vehicle_type)
    raise ValueError(f"unknown autopilot {autopilot!r}")
