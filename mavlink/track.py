"""What was flown: positions in the vehicle's time, and what its sensors reported meanwhile.

Source: MAVLink ``common.xml`` and ``ardupilotmega.xml``: GLOBAL_POSITION_INT, CAMERA_FEEDBACK (180),
CAMERA_IMAGE_CAPTURED (263), NAMED_VALUE_INT (252), RELAY_STATUS (376).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from mavlink.messages import Message
from mavlink.telemetry import VehicleState, finite, is_sensor_switch

# Older than this before the last point is a reboot, not a datagram that was overtaken.
_REBOOT_S: Final = 5.0
# Fourteen hours at 4 Hz; afterwards every second point is dropped and the rate halves.
_MOST_POINTS: Final = 200_000


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """Where the aircraft was; ``time_s`` is the vehicle's time since boot, angles as in VehicleState."""

    time_s: float
    lon_deg: float
    lat_deg: float
    relative_m: float
    amsl_m: float
    heading_deg: float | None = None
    course_deg: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    ground_speed_m_s: float | None = None
    sensor_on: bool | None = None
    mission_current: int | None = None


@dataclass(frozen=True, slots=True)
class SensorEvent:
    """Something a sensor did.

    Parameters
    ----------
    kind
        ``photo``; ``on`` and ``off`` of the payload's switch.
    source
        ``camera`` (feedback messages), ``payload`` (``SAR_ON``), ``relay`` (with ``index``).
    time_s
        The vehicle's time since boot.
    lon_deg, lat_deg, relative_m
        Where: as the camera says, else the track's last position; None before the first.
    index
        Image or relay number.
    """

    time_s: float
    kind: Literal["on", "off", "photo"]
    source: Literal["camera", "payload", "relay"]
    lon_deg: float | None = None
    lat_deg: float | None = None
    relative_m: float | None = None
    index: int | None = None


@dataclass(frozen=True, slots=True)
class Track:
    """A recorded flight, in order of time unless the vehicle rebooted."""

    points: tuple[TrackPoint, ...] = ()
    events: tuple[SensorEvent, ...] = ()


class TrackRecorder:
    """Collects a track from a vehicle's messages and the state after each."""

    def __init__(self) -> None:
        self._points: list[TrackPoint] = []
        self._events: list[SensorEvent] = []
        self._sensor_on: bool | None = None
        self._relays_on: int | None = None
        self._keep_every = 1
        self._skipped = 0
        self._images: set[int] = set()

    def track(self) -> Track:
        """What was recorded so far."""
        return Track(tuple(self._points), tuple(self._events))

    def take(self, message: Message, state: VehicleState) -> None:
        """Take one message, and the state it led to."""
        if message.name == "GLOBAL_POSITION_INT":
            self._position(state)
        elif is_sensor_switch(message):
            on = bool(message.integer("value"))
            if on != self._sensor_on:
                self._sensor_on = on
                self._event(state, "on" if on else "off", "payload", time_s=_boot_s(message))
        elif message.name == "RELAY_STATUS":
            self._relays(message, state)
        elif message.name in ("CAMERA_FEEDBACK", "CAMERA_IMAGE_CAPTURED"):
            self._photo(message, state)

    def _position(self, state: VehicleState) -> None:
        time_s, lon_deg, lat_deg = state.time_s, state.lon_deg, state.lat_deg
        amsl_m, relative_m = state.altitude_amsl_m, state.relative_altitude_m
        if time_s is None or lon_deg is None or lat_deg is None or amsl_m is None or relative_m is None:
            return
        if self._points and 0.0 <= self._points[-1].time_s - time_s < _REBOOT_S:
            return
        self._skipped += 1
        if self._skipped < self._keep_every:
            return
        self._skipped = 0
        self._points.append(
            TrackPoint(
                time_s,
                lon_deg,
                lat_deg,
                relative_m,
                amsl_m,
                state.heading_deg,
                state.course_deg,
                state.roll_deg,
                state.pitch_deg,
                state.ground_speed_m_s,
                state.sensor_on,
                state.mission_current,
            )
        )
        if len(self._points) > _MOST_POINTS:
            del self._points[1::2]
            self._keep_every *= 2

    def _relays(self, message: Message, state: VehicleState) -> None:
        present, on = message.integer("present"), message.integer("on")
        before = on if self._relays_on is None else self._relays_on
        self._relays_on = on
        for number in range(16):
            bit = 1 << number
            if present & bit and (before ^ on) & bit:
                kind: Literal["on", "off"] = "on" if on & bit else "off"
                self._event(state, kind, "relay", time_s=_boot_s(message), index=number)

    def _photo(self, message: Message, state: VehicleState) -> None:
        if message.name == "CAMERA_FEEDBACK":
            index, lon = message.integer("img_idx"), message.integer("lng")
            relative_m, time_s = finite(message, "alt_rel"), state.time_s
        else:
            if message.integer("capture_result") != 1:
                return
            index, lon = message.integer("image_index"), message.integer("lon")
            relative_m, time_s = message.number("relative_alt") / 1000.0, _boot_s(message)
        if index in self._images:
            return  # the same feedback again, by another way
        self._images.add(index)
        place = (lon / 1e7, message.integer("lat") / 1e7, relative_m)
        self._event(state, "photo", "camera", time_s=time_s, index=index, place=place)

    def _event(
        self,
        state: VehicleState,
        kind: Literal["on", "off", "photo"],
        source: Literal["camera", "payload", "relay"],
        *,
        time_s: float | None,
        index: int | None = None,
        place: tuple[float | None, float | None, float | None] | None = None,
    ) -> None:
        lon_deg, lat_deg, relative_m = place or (state.lon_deg, state.lat_deg, state.relative_altitude_m)
        when_s = time_s if time_s is not None else state.time_s or 0.0
        self._events.append(SensorEvent(when_s, kind, source, lon_deg, lat_deg, relative_m, index))


def _boot_s(message: Message) -> float:
    return message.number("time_boot_ms") / 1000.0
