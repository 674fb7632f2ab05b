"""A mission as a vehicle gets it: items, fence, rally points, and what they are for."""

from __future__ import annotations

from dataclasses import dataclass, replace

from mavlink.dialects import Autopilot, Dialect, VehicleType, dialect_for
from mavlink.wire.items import Command, Frame, MissionItem, MissionType, degrees_e7, longitude_e7
from planner.plan import LonLat


@dataclass(frozen=True, slots=True)
class Declared:
    """What a file says of the vehicle it is for; None where it does not say."""

    firmware_type: int | None = None
    mav_type: int | None = None
    cruise_speed_m_s: float | None = None
    hover_speed_m_s: float | None = None
    altitude_mode: int | None = None


def declared_by(autopilot: Autopilot, vehicle_type: VehicleType | None) -> Declared:
    """What whoever reads a file says in its place; None for a type that nobody names."""
    if vehicle_type is None:
        return Declared()
    return Declared(mav_type=dialect_for(autopilot, vehicle_type).mav_type)


@dataclass(frozen=True, slots=True)
class Mission:
    """Everything that goes up to one vehicle.

    Parameters
    ----------
    mission
        In flight order, numbered from 0; for ArduPilot item 0 is the home row.
    fence, rally
        Numbered from 0; empty where there is none.
    vehicle
        The plan's name of the vehicle.
    home
        Longitude and latitude in degrees.
    notes
        What was chosen, assumed or left out, for people.
    home_altitude_m
        Height of home above sea level; 0 when it is not known.
    speed_m_s
        Cruise speed.
    declared
        Of a mission that was read from a file, what the file says; None for a mission of our own.
    unread
        Lists that the file has and that could not be read whole.
    """

    mission: tuple[MissionItem, ...]
    fence: tuple[MissionItem, ...]
    rally: tuple[MissionItem, ...]
    autopilot: Autopilot
    vehicle: str
    vehicle_type: VehicleType
    home: LonLat
    notes: tuple[str, ...] = ()
    home_altitude_m: float = 0.0
    speed_m_s: float = 0.0
    declared: Declared | None = None
    unread: frozenset[MissionType] = frozenset()

    @property
    def dialect(self) -> Dialect:
        """What the autopilot takes, with its default parameters."""
        return dialect_for(self.autopilot, self.vehicle_type)

    def items_of(self, kind: MissionType) -> tuple[MissionItem, ...]:
        """The list of one type."""
        lists = {
            MissionType.MISSION: self.mission,
            MissionType.FENCE: self.fence,
            MissionType.RALLY: self.rally,
        }
        return lists[kind]


def placed(
    command: int,
    place: LonLat,
    altitude_m: float,
    frame: int,
    parameters: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
) -> MissionItem:
    """An item with a place, not yet numbered; the altitude is rounded to the centimetre ArduPilot keeps."""
    param1, param2, param3, param4 = parameters
    return MissionItem(
        0,
        frame,
        command,
        param1=param1,
        param2=param2,
        param3=param3,
        param4=param4,
        x=degrees_e7(place[1]),
        y=longitude_e7(place[0]),
        z=round(altitude_m, 2),
    )


def unplaced(
    command: int, parameters: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
) -> MissionItem:
    """An item without a place, not yet numbered."""
    param1, param2, param3, param4 = parameters
    return MissionItem(0, Frame.MISSION, command, param1=param1, param2=param2, param3=param3, param4=param4)


def home_item(home: LonLat, altitude_m: float) -> MissionItem:
    """The row that ArduPilot and the waypoint file keep for home, numbered 0, its altitude unrounded."""
    return replace(placed(Command.NAV_WAYPOINT, home, altitude_m, Frame.GLOBAL), z=altitude_m)


def numbered(items: list[MissionItem], kind: MissionType = MissionType.MISSION) -> tuple[MissionItem, ...]:
    """The items numbered from 0, the first of a mission marked current."""
    return tuple(
        replace(item, seq=seq, current=seq == 0 and kind == MissionType.MISSION, mission_type=kind)
        for seq, item in enumerate(items)
    )
