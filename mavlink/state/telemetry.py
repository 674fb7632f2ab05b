"""Messages to the state of a vehicle.

``updated`` folds one message into a state; every message it knows has one small function in a table.

Source: MAVLink ``common.xml``; the message is named beside each field's unit.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from mavlink.state.events import read_event
from mavlink.state.modes import (
    BOOT_MODE,
    Autopilot,
    VehicleType,
    autopilot_name,
    mode_name,
    vehicle_type_name,
)
from mavlink.wire.messages import Message

_ARMED: Final = 0x80
_BOOT: Final = 1  # MAV_STATE_BOOT
#: Texts of the vehicle that its state keeps.
KEPT_TEXTS: Final = 20
_MISSION_STATES: Final = {1: "none", 2: "not_started", 3: "active", 4: "paused", 5: "complete"}
_GPS_FIXES: Final = {0: "none", 1: "none", 2: "2d", 3: "3d", 4: "dgps", 5: "rtk_float", 6: "rtk_fixed"}


@dataclass(frozen=True, slots=True)
class StatusText:
    """What the vehicle said (STATUSTEXT, EVENT); severity 0 emergency to 7 debug (MAV_SEVERITY).

    ``against_mission``: it says with this that it will not fly the mission it holds.
    """

    heard_s: float
    severity: int
    text: str
    id: int = 0
    against_mission: bool = False


#: The doubt that two aircraft hear what one is sent.
TWO_AIRCRAFT: Final = "two-aircraft"


@dataclass(frozen=True, slots=True)
class Doubt:
    """Why it is not certain that orders reach the vehicle meant, and it alone: only stops are sent.

    Parameters
    ----------
    rule
        Its name, e.g. ``two-aircraft``.
    fix
        What resolves it.
    """

    rule: str
    message: str
    fix: str


@dataclass(frozen=True, slots=True)
class VehicleState:
    """All that is known of a vehicle now; None where it has not said.

    Parameters
    ----------
    connected
        Something was heard from it lately; decided by the client.
    other_system
        System id of another autopilot that answers while the vehicle is silent: a swapped aircraft.
    restarts
        How often it has started anew since it was heard first: what it held then may be gone.
    address
        Where it is heard from, on a port where anybody may speak.
    strangers
        Other addresses heard there lately: neither believed nor sent to.
    signing
        ``verified``: its frames are signed with the key known here. ``no_key``: they are signed, and no key
        is known. ``unsigned``, ``wrong_key``, ``replayed``: a key is known, and for this they do not count.
        None: it does not sign.
    doubt
        Why orders are refused that make it fly or change what it holds; None where all is certain.
    heard_s
        When it last told something of itself, in the client's clock.
    position_heard_s
        When it last told where it is, in the same clock.
    time_s
        The vehicle's own time since boot.
    firmware
        The version of the autopilot's firmware, e.g. ``4.6.3``.
    mode
        In words, as ``modes.mode_name`` gives it.
    booting
        It is still starting, and stores nothing yet.
    altitude_amsl_m, relative_altitude_m
        Above mean sea level; above home.
    velocity_north_m_s, velocity_east_m_s, velocity_down_m_s
        Over ground.
    heading_deg
        Where the nose points, clockwise from true north.
    course_deg
        Where it moves over ground; None below 0.5 m/s.
    mission_heard_s
        When it last told which item it flies to, in the client's clock.
    mission_current, mission_total
        The item flown, and the number of items held, the home row included where there is one.
    mission_state
        ``none`` ``not_started`` ``active`` ``paused`` ``complete``.
    mission_reached
        The last item reached.
    mission_id, fence_id, rally_points_id
        The vehicle's own ids of the lists it holds; None where it holds or gives none.
    sensor_on
        The payload's switch as reported: NAMED_VALUE_INT ``SAR_ON``.
    output_on
        What the output shows that the payload in use switches; None where it is not known or not told.
    sensor_silent
        Whether that report came again and again and comes no more: whatever it said last, nobody knows.
    sensor_since_s
        Since when ``sensor_shown`` is what it is, in the client's clock.
    relays_on
        Bit mask of RELAY_STATUS.
    """

    system_id: int = 0
    component_id: int = 0
    connected: bool = False
    other_system: int | None = None
    restarts: int = 0
    address: str | None = None
    strangers: tuple[str, ...] = ()
    signing: str | None = None
    doubt: Doubt | None = None
    heard_s: float | None = None
    position_heard_s: float | None = None
    time_s: float | None = None
    autopilot: Autopilot = "generic"
    firmware: str | None = None
    type: VehicleType = "other"
    armed: bool = False
    mode: str = ""
    booting: bool = False
    landed: bool | None = None
    lon_deg: float | None = None
    lat_deg: float | None = None
    altitude_amsl_m: float | None = None
    relative_altitude_m: float | None = None
    velocity_north_m_s: float | None = None
    velocity_east_m_s: float | None = None
    velocity_down_m_s: float | None = None
    heading_deg: float | None = None
    course_deg: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    ground_speed_m_s: float | None = None
    airspeed_m_s: float | None = None
    battery_percent: float | None = None
    battery_voltage_v: float | None = None
    gps_fix: str | None = None
    satellites: int | None = None
    home_lon_deg: float | None = None
    home_lat_deg: float | None = None
    home_altitude_amsl_m: float | None = None
    mission_current: int | None = None
    mission_heard_s: float | None = None
    mission_total: int | None = None
    mission_state: str | None = None
    mission_reached: int | None = None
    mission_id: int | None = None
    fence_id: int | None = None
    rally_points_id: int | None = None
    sensor_on: bool | None = None
    output_on: bool | None = None
    sensor_silent: bool = False
    sensor_since_s: float | None = None
    relays_on: int | None = None
    texts: tuple[StatusText, ...] = ()

    @property
    def sensor_shown(self) -> bool | None:
        """Whether the sensor is on: by its own report, else by the output; None where nothing tells.

        One whose report has ceased may be dead, whatever its output says; without an output it is off.
        """
        if self.sensor_silent:
            return False if self.output_on is False else None
        return self.output_on if self.sensor_on is None else self.sensor_on


def updated(state: VehicleState, message: Message, now_s: float) -> VehicleState:
    """The state after one of the vehicle's messages; the same object when the message tells nothing of it."""
    update = _UPDATES.get(message.name)
    return state if update is None else update(replace(state, heard_s=now_s), message)


def _heartbeat(state: VehicleState, message: Message) -> VehicleState:
    autopilot = autopilot_name(message.integer("autopilot"))
    vehicle_type = vehicle_type_name(message.integer("type"))
    if vehicle_type == "fixed_wing" and state.type == "vtol":
        vehicle_type = "vtol"  # ArduPlane's quadplanes say so in EXTENDED_SYS_STATE alone
    mode = mode_name(autopilot, vehicle_type, message.integer("custom_mode"))
    return replace(
        state,
        system_id=message.system_id,
        component_id=message.component_id,
        autopilot=autopilot,
        type=vehicle_type,
        armed=bool(message.integer("base_mode") & _ARMED),
        mode=mode,
        # ArduPlane says "calibrating" meanwhile, as others do long after their start.
        booting=mode == BOOT_MODE or message.integer("system_status") == _BOOT,
    )


def _global_position(state: VehicleState, message: Message) -> VehicleState:
    north, east, down = (message.number(name) / 100.0 for name in ("vx", "vy", "vz"))  # cm/s
    heading = message.integer("hdg")  # centidegrees
    moving = math.hypot(north, east) >= 0.5
    return replace(
        state,
        position_heard_s=state.heard_s,
        time_s=message.number("time_boot_ms") / 1000.0,
        lat_deg=message.integer("lat") / 1e7,
        lon_deg=message.integer("lon") / 1e7,
        altitude_amsl_m=message.number("alt") / 1000.0,  # mm
        relative_altitude_m=message.number("relative_alt") / 1000.0,
        velocity_north_m_s=north,
        velocity_east_m_s=east,
        velocity_down_m_s=down,
        heading_deg=state.heading_deg if heading == 0xFFFF else heading / 100.0,
        course_deg=math.degrees(math.atan2(east, north)) % 360.0 if moving else None,
    )


def _attitude(state: VehicleState, message: Message) -> VehicleState:
    roll, pitch, yaw = (finite(message, name) for name in ("roll", "pitch", "yaw"))
    return replace(
        state,
        roll_deg=None if roll is None else math.degrees(roll),
        pitch_deg=None if pitch is None else math.degrees(pitch),
        heading_deg=state.heading_deg if yaw is None else math.degrees(yaw) % 360.0,
    )


def _vfr_hud(state: VehicleState, message: Message) -> VehicleState:
    return replace(
        state, airspeed_m_s=finite(message, "airspeed"), ground_speed_m_s=finite(message, "groundspeed")
    )


def _sys_status(state: VehicleState, message: Message) -> VehicleState:
    percent, millivolts = message.integer("battery_remaining"), message.integer("voltage_battery")
    return replace(
        state,
        battery_percent=state.battery_percent if percent < 0 else float(percent),
        battery_voltage_v=state.battery_voltage_v if millivolts == 0xFFFF else millivolts / 1000.0,
    )


def _battery_status(state: VehicleState, message: Message) -> VehicleState:
    percent = message.integer("battery_remaining")
    if message.integer("id") != 0 or percent < 0:
        return state
    return replace(state, battery_percent=float(percent))


def _gps_raw(state: VehicleState, message: Message) -> VehicleState:
    satellites = message.integer("satellites_visible")
    return replace(
        state,
        gps_fix=_GPS_FIXES.get(message.integer("fix_type"), "3d"),
        satellites=None if satellites == 0xFF else satellites,
    )


def _home_position(state: VehicleState, message: Message) -> VehicleState:
    return replace(
        state,
        home_lat_deg=message.integer("latitude") / 1e7,
        home_lon_deg=message.integer("longitude") / 1e7,
        home_altitude_amsl_m=message.number("altitude") / 1000.0,
    )


def _mission_current(state: VehicleState, message: Message) -> VehicleState:
    total = message.integer("total")
    known = 0 < total < 0xFFFF
    # ArduPilot leaves its home row out of the total.
    rows = total + (state.autopilot == "ardupilot") if known else None
    return replace(
        state,
        mission_current=message.integer("seq"),
        mission_heard_s=state.heard_s,
        mission_total=rows,
        mission_state=_MISSION_STATES.get(message.integer("mission_state")),
        mission_id=message.integer("mission_id") or None,
        fence_id=message.integer("fence_id") or None,
        rally_points_id=message.integer("rally_points_id") or None,
    )


def _mission_reached(state: VehicleState, message: Message) -> VehicleState:
    return replace(state, mission_reached=message.integer("seq"))


def _extended_state(state: VehicleState, message: Message) -> VehicleState:
    landed = message.integer("landed_state")  # MAV_LANDED_STATE: 0 undefined, 1 on ground
    # MAV_VTOL_STATE: 0 for all that have no transition to make. ArduPlane's quadplanes are fixed wings in
    # their heartbeats unless Q_MAV_TYPE says otherwise.
    vtol = message.integer("vtol_state") != 0 and state.type == "fixed_wing"
    return replace(state, landed=None if landed == 0 else landed == 1, type="vtol" if vtol else state.type)


def _autopilot_version(state: VehicleState, message: Message) -> VehicleState:
    version = message.integer("flight_sw_version")
    major, minor, patch = (version >> shift & 0xFF for shift in (24, 16, 8))
    return replace(state, firmware=f"{major}.{minor}.{patch}") if major else state


def _named_int(state: VehicleState, message: Message) -> VehicleState:
    return replace(state, sensor_on=bool(message.integer("value"))) if is_sensor_switch(message) else state


def _relay_status(state: VehicleState, message: Message) -> VehicleState:
    return replace(state, relays_on=message.integer("on") & message.integer("present"))


def _status_text(state: VehicleState, message: Message) -> VehicleState:
    text, identity = message.text("text"), message.integer("id")
    heard_s = state.heard_s or 0.0
    texts = state.texts
    if identity and message.integer("chunk_seq") and texts and texts[-1].id == identity:
        return replace(state, texts=(*texts[:-1], replace(texts[-1], text=texts[-1].text + text)))
    # PX4 ends texts that an event says again with a tab.
    entry = StatusText(heard_s, message.integer("severity"), text.removesuffix("\t"), identity)
    return replace(state, texts=(*texts[1 - KEPT_TEXTS :], entry))


def _event(state: VehicleState, message: Message) -> VehicleState:
    event = read_event(message)
    if event is None:
        return state
    heard_s = state.heard_s or 0.0
    entry = StatusText(heard_s, event.severity, event.text, against_mission=event.against_mission)
    return replace(state, texts=(*state.texts[1 - KEPT_TEXTS :], entry))


def finite(message: Message, name: str) -> float | None:
    """A float field; None for NaN and infinity, the wire's words for "not measured"."""
    value = message.number(name)
    return value if math.isfinite(value) else None


def is_sensor_switch(message: Message) -> bool:
    """True for the report of the sensor's switch: NAMED_VALUE_INT called ``SAR_ON``."""
    return message.name == "NAMED_VALUE_INT" and message.text("name") == "SAR_ON"


_UPDATES: Final[dict[str, Callable[[VehicleState, Message], VehicleState]]] = {
    "HEARTBEAT": _heartbeat,
    "GLOBAL_POSITION_INT": _global_position,
    "ATTITUDE": _attitude,
    "VFR_HUD": _vfr_hud,
    "SYS_STATUS": _sys_status,
    "BATTERY_STATUS": _battery_status,
    "GPS_RAW_INT": _gps_raw,
    "HOME_POSITION": _home_position,
    "MISSION_CURRENT": _mission_current,
    "MISSION_ITEM_REACHED": _mission_reached,
    "EXTENDED_SYS_STATE": _extended_state,
    "AUTOPILOT_VERSION": _autopilot_version,
    "NAMED_VALUE_INT": _named_int,
    "RELAY_STATUS": _relay_status,
    "STATUSTEXT": _status_text,
    "EVENT": _event,
}
