"""Messages the simulated aircraft sends by itself, built from its state.

Source: MAVLink ``common.xml`` for units and scales.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from mavlink.sim.atmosphere import true_over_equivalent
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour, Mode, custom_mode
from mavlink.sim.settings import SimSettings
from mavlink.sim.shutter import quaternion
from mavlink.wire.messages import Message

_CELLS = 6
_FULL_CELL_V, _EMPTY_CELL_V = 4.2, 3.5
_UINT16_MAX = 65535
_ARMED_FLAG, _CUSTOM_FLAG, _AUTO_FLAG, _STABILIZE_FLAG, _GUIDED_FLAG = 128, 1, 4, 16, 8
#: ArduPlane's mode while it starts, and MAV_STATE then: ArduPlane says "calibrating", PX4 "booting".
_INITIALISING = 16
_BOOTING = {Flavour.ARDUPILOT: 2, Flavour.PX4: 1}
#: MAV_SYS_STATUS: gyroscopes, accelerometers, compass, static and pitot pressure, GPS; logging is none here.
_SENSORS = 1 | 2 | 4 | 8 | 16 | 32
_FENCE = 1 << 20
_PREARM_CHECK = 1 << 28
_CAPABILITIES = 1 | 2 | 4 | 8 | 8192 | 16384 | 32768


@dataclass(frozen=True, slots=True)
class Snapshot:
    """What telemetry is built from; ``list_ids`` are those of mission, fence and rally points;
    ``fenced`` is whether a fence is stored."""

    state: AircraftState
    home: Place
    mode: Mode
    armed: bool
    consumed_j: float
    current: int
    total: int
    mission_complete: bool
    paused: bool = False
    list_ids: tuple[int, ...] = (0, 0, 0)
    fenced: bool = False


def build(name: str, snapshot: Snapshot, settings: SimSettings) -> Message:
    """One message of ``STREAMS`` that needs no more than a snapshot."""
    return _BUILDERS[name](snapshot, settings)


def _ms(snapshot: Snapshot) -> int:
    return round(snapshot.state.time_s * 1000.0)


def _heartbeat(snapshot: Snapshot, settings: SimSettings) -> Message:
    ardupilot = settings.autopilot is Flavour.ARDUPILOT
    booting = snapshot.state.time_s < settings.boot_s
    base = _CUSTOM_FLAG | _STABILIZE_FLAG
    if snapshot.mode is not Mode.MANUAL:
        base |= _AUTO_FLAG | _GUIDED_FLAG
    if snapshot.armed:
        base |= _ARMED_FLAG
    return Message(
        "HEARTBEAT",
        {
            "type": 2 if settings.hovers else 1,
            "autopilot": 3 if ardupilot else 12,
            "base_mode": base,
            "custom_mode": (
                _INITIALISING
                if booting and ardupilot and not settings.hovers
                else custom_mode(settings.autopilot, snapshot.mode, hovers=settings.hovers)
            ),
            "system_status": _BOOTING[settings.autopilot] if booting else 4 if snapshot.armed else 3,
            "mavlink_version": 3,
        },
    )


def _battery(snapshot: Snapshot, settings: SimSettings) -> tuple[int, float, float]:
    """Per cent left, volts, amperes."""
    full_j = settings.battery_wh * 3600.0
    left = max(1.0 - snapshot.consumed_j / full_j, 0.0)
    volts = _CELLS * (_EMPTY_CELL_V + (_FULL_CELL_V - _EMPTY_CELL_V) * left)
    return round(100.0 * left), volts, snapshot.state.power_w / volts


def _sys_status(snapshot: Snapshot, settings: SimSettings) -> Message:
    percent, volts, amperes = _battery(snapshot, settings)
    sensors = _SENSORS | _PREARM_CHECK
    enabled = sensors | _FENCE if snapshot.fenced else sensors
    return Message(
        "SYS_STATUS",
        {
            # The fence is kept, whether or not it is in force: nothing here leaves it.
            "onboard_control_sensors_present": sensors | _FENCE,
            "onboard_control_sensors_enabled": enabled,
            "onboard_control_sensors_health": sensors | _FENCE,
            "load": 100,
            "voltage_battery": round(volts * 1000.0),
            "current_battery": min(round(amperes * 100.0), 32767),
            "battery_remaining": percent,
            "drop_rate_comm": 0,
            "errors_comm": 0,
            "errors_count1": 0,
            "errors_count2": 0,
            "errors_count3": 0,
            "errors_count4": 0,
        },
    )


def _battery_status(snapshot: Snapshot, settings: SimSettings) -> Message:
    percent, volts, amperes = _battery(snapshot, settings)
    used_ah = snapshot.consumed_j / 3600.0 / volts
    return Message(
        "BATTERY_STATUS",
        {
            "id": 0,
            "battery_function": 1,
            "type": 1,
            "temperature": 32767,
            "voltages": (round(volts * 1000.0), *(_UINT16_MAX,) * 9),
            "current_battery": min(round(amperes * 100.0), 32767),
            "current_consumed": round(used_ah * 1000.0),
            # hectojoules
            "energy_consumed": round(snapshot.consumed_j / 100.0),
            "battery_remaining": percent,
        },
    )


def _gps_raw(snapshot: Snapshot, settings: SimSettings) -> Message:
    state = snapshot.state
    course_deg = math.degrees(math.atan2(state.east_m_s, state.north_m_s)) % 360.0
    return Message(
        "GPS_RAW_INT",
        {
            "time_usec": round(state.time_s * 1e6),
            "fix_type": 3,
            "lat": round(state.lat_deg * 1e7),
            "lon": round(state.lon_deg * 1e7),
            "alt": round(state.altitude_m * 1000.0),
            "eph": 80,
            "epv": 120,
            "vel": round(state.ground_speed_m_s * 100.0),
            "cog": round(course_deg * 100.0) % 36000,
            "satellites_visible": 14,
        },
    )


def _attitude(snapshot: Snapshot, settings: SimSettings) -> Message:
    state = snapshot.state
    yaw_rad = state.heading_rad if state.heading_rad <= math.pi else state.heading_rad - 2.0 * math.pi
    return Message(
        "ATTITUDE",
        {
            "time_boot_ms": _ms(snapshot),
            "roll": state.bank_rad,
            "pitch": state.pitch_rad,
            "yaw": yaw_rad,
            "rollspeed": 0.0,
            "pitchspeed": 0.0,
            "yawspeed": state.turn_rate_rad_s,
        },
    )


def _attitude_quaternion(snapshot: Snapshot, settings: SimSettings) -> Message:
    state = snapshot.state
    q1, q2, q3, q4 = quaternion(state.bank_rad, state.pitch_rad, state.heading_rad)
    return Message(
        "ATTITUDE_QUATERNION",
        {
            "time_boot_ms": _ms(snapshot),
            **{"q1": q1, "q2": q2, "q3": q3, "q4": q4},
            "rollspeed": 0.0,
            "pitchspeed": 0.0,
            "yawspeed": state.turn_rate_rad_s,
        },
    )


def _altitude(snapshot: Snapshot, settings: SimSettings) -> Message:
    state = snapshot.state
    above_home_m = state.altitude_m - snapshot.home.altitude_m
    above_ground_m = state.altitude_m - settings.home.altitude_m
    return Message(
        "ALTITUDE",
        {
            "time_usec": round(state.time_s * 1e6),
            "altitude_monotonic": state.altitude_m,
            "altitude_amsl": state.altitude_m,
            "altitude_local": above_home_m,
            "altitude_relative": above_home_m,
            # The ground is flat here, as high as where it started.
            "altitude_terrain": above_ground_m,
            "bottom_clearance": above_ground_m,
        },
    )


def _global_position(snapshot: Snapshot, settings: SimSettings) -> Message:
    state = snapshot.state
    return Message(
        "GLOBAL_POSITION_INT",
        {
            "time_boot_ms": _ms(snapshot),
            "lat": round(state.lat_deg * 1e7),
            "lon": round(state.lon_deg * 1e7),
            "alt": round(state.altitude_m * 1000.0),
            "relative_alt": round((state.altitude_m - snapshot.home.altitude_m) * 1000.0),
            "vx": round(state.north_m_s * 100.0),
            "vy": round(state.east_m_s * 100.0),
            "vz": round(-state.climb_m_s * 100.0),
            "hdg": round(math.degrees(state.heading_rad) * 100.0) % 36000,
        },
    )


def _mission_current(snapshot: Snapshot, settings: SimSettings) -> Message:
    ardupilot = settings.autopilot is Flavour.ARDUPILOT
    total = max(snapshot.total - 1, 0) if ardupilot else snapshot.total
    if snapshot.total == 0:
        mission_state = 1
    elif snapshot.mission_complete:
        mission_state = 5
    elif snapshot.armed and snapshot.mode is Mode.AUTO and not snapshot.paused:
        mission_state = 3
    else:
        mission_state = 2 if snapshot.state.on_ground else 4
    seq = min(snapshot.current, max(snapshot.total - 1, 0))
    return Message(
        "MISSION_CURRENT",
        {
            "seq": seq,
            "total": total,
            "mission_state": mission_state,
            "mission_mode": 1 if snapshot.mode is Mode.AUTO else 2,
            "mission_id": snapshot.list_ids[0],
            "fence_id": snapshot.list_ids[1],
            "rally_points_id": snapshot.list_ids[2],
        },
    )


def _vfr_hud(snapshot: Snapshot, settings: SimSettings) -> Message:
    state = snapshot.state
    thin = 1.0 if settings.hovers else true_over_equivalent(state.altitude_m)
    return Message(
        "VFR_HUD",
        {
            "airspeed": state.airspeed_m_s / thin,
            "groundspeed": state.ground_speed_m_s,
            "heading": round(math.degrees(state.heading_rad)) % 360,
            "throttle": round(100.0 * state.throttle),
            "alt": state.altitude_m,
            "climb": state.climb_m_s,
        },
    )


def _home_position(snapshot: Snapshot, settings: SimSettings) -> Message:
    return Message(
        "HOME_POSITION",
        {
            "latitude": round(snapshot.home.lat_deg * 1e7),
            "longitude": round(snapshot.home.lon_deg * 1e7),
            "altitude": round(snapshot.home.altitude_m * 1000.0),
            "x": 0.0,
            "y": 0.0,
            "z": 0.0,
            "q": quaternion(0.0, 0.0, math.radians(settings.heading_deg or 0.0)),
            "approach_x": 0.0,
            "approach_y": 0.0,
            "approach_z": 0.0,
        },
    )


def _extended_sys_state(snapshot: Snapshot, settings: SimSettings) -> Message:
    return Message(
        "EXTENDED_SYS_STATE", {"vtol_state": 0, "landed_state": 1 if snapshot.state.on_ground else 2}
    )


def _wind(snapshot: Snapshot, settings: SimSettings) -> Message:
    north, east = snapshot.state.wind_north_m_s, snapshot.state.wind_east_m_s
    return Message(
        "WIND",
        {
            # The direction it blows from.
            "direction": math.degrees(math.atan2(-east, -north)) % 360.0,
            "speed": math.hypot(north, east),
            "speed_z": 0.0,
        },
    )


def _system_time(snapshot: Snapshot, settings: SimSettings) -> Message:
    # 0 is "not known", as before the first fix.
    unix_s = settings.started_unix_s + snapshot.state.time_s if settings.started_unix_s > 0.0 else 0.0
    return Message("SYSTEM_TIME", {"time_unix_usec": round(unix_s * 1e6), "time_boot_ms": _ms(snapshot)})


def _autopilot_version(snapshot: Snapshot, settings: SimSettings) -> Message:
    major, minor = settings.version
    name = tuple(b"swathsim")
    return Message(
        "AUTOPILOT_VERSION",
        {
            "capabilities": _CAPABILITIES,
            "flight_sw_version": major << 24 | minor << 16 | 0xFF,
            "middleware_sw_version": 0,
            "os_sw_version": 0,
            "board_version": 0,
            "flight_custom_version": name,
            "middleware_custom_version": name,
            "os_custom_version": name,
            "vendor_id": 0,
            "product_id": 0,
            "uid": settings.system_id,
        },
    )


_BUILDERS: dict[str, Callable[[Snapshot, SimSettings], Message]] = {
    "HEARTBEAT": _heartbeat,
    "SYS_STATUS": _sys_status,
    "SYSTEM_TIME": _system_time,
    "GPS_RAW_INT": _gps_raw,
    "ATTITUDE": _attitude,
    "ATTITUDE_QUATERNION": _attitude_quaternion,
    "ALTITUDE": _altitude,
    "GLOBAL_POSITION_INT": _global_position,
    "MISSION_CURRENT": _mission_current,
    "VFR_HUD": _vfr_hud,
    "BATTERY_STATUS": _battery_status,
    "AUTOPILOT_VERSION": _autopilot_version,
    "WIND": _wind,
    "HOME_POSITION": _home_position,
    "EXTENDED_SYS_STATE": _extended_sys_state,
}
