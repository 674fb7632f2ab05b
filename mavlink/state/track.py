"""What was flown: positions in the vehicle's time, and what its sensors reported meanwhile.

Source: MAVLink ``common.xml`` and ``ardupilotmega.xml``: GLOBAL_POSITION_INT, CAMERA_FEEDBACK (180),
CAMERA_IMAGE_CAPTURED (263), CAMERA_CAPTURE_STATUS (262), NAMED_VALUE_INT (252), SERVO_OUTPUT_RAW (36),
RELAY_STATUS (376), SYSTEM_TIME (2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, Literal

from mavlink.state.energy import Energy, EnergyMeter
from mavlink.state.mount import MOUNT_MESSAGES, MountAttitude, MountWatch
from mavlink.state.mount import angles_deg as angles_of
from mavlink.state.outputs import CameraOutput, PhotoOutput, RelayOutput, SensorOutput, ServoOutput
from mavlink.state.photos import PhotoSource, PhotoTaken, photos_among
from mavlink.state.sensor import TOLD_SHOWS_S
from mavlink.state.telemetry import VehicleState, finite, is_sensor_switch
from mavlink.wire.messages import Message

# Older than this before the last point is a reboot, not a datagram that was overtaken.
_REBOOT_S: Final = 5.0
# Fourteen hours at 4 Hz; afterwards every second point is dropped and the rate halves.
_MOST_POINTS: Final = 200_000
# SERVO_OUTPUT_RAW counts microseconds in 32 bits: it begins anew every 71.6 minutes.
_WRAP_S: Final = 2**32 / 1e6
# An attitude is that of a place when it is no older: it comes several times a second.
_ATTITUDE_S: Final = 2.0
# A camera's clock that says less or more than this beside the vehicle's is another clock.
_SAME_CLOCK_S: Final = 5.0

#: Told by a camera, which is often a component of its own beside the autopilot.
CAMERA_MESSAGES: Final = frozenset({"CAMERA_FEEDBACK", "CAMERA_IMAGE_CAPTURED", "CAMERA_CAPTURE_STATUS"})

#: MAV_COMP_ID_CAMERA to CAMERA6.
_CAMERAS: Final = range(100, 106)

EventSource = Literal["camera", "payload", "relay", "servo"]
_SOURCES: Final[dict[type, EventSource]] = {
    RelayOutput: "relay",
    ServoOutput: "servo",
    CameraOutput: "camera",
    PhotoOutput: "camera",
}


@dataclass(frozen=True, slots=True)
class TrackPoint:
    """Where the aircraft was; ``time_s`` is the vehicle's time since boot, angles as in VehicleState.

    ``mount`` is where the gimbal pointed that holds the sensor; None without one.
    """

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
    mount: MountAttitude | None = None


@dataclass(frozen=True, slots=True)
class SensorEvent:
    """Something a sensor did.

    Parameters
    ----------
    kind
        ``photo``; ``on`` and ``off`` of the payload's switch.
    source
        ``camera`` (feedback and capture status), ``payload`` (``SAR_ON``), ``relay`` and ``servo`` (with
        ``index``).
    time_s
        The vehicle's time since boot.
    lon_deg, lat_deg, relative_m
        Where: as the camera says, else the track's last position; None before the first.
    index
        Image, relay or servo number.
    amsl_m, heading_deg, roll_deg, pitch_deg
        Of a photo, as the camera says; None where it does not.
    attitude_of
        Whose attitude a photo tells: the airframe's, by the ``autopilot``, or that of the ``camera`` itself.
    """

    time_s: float
    kind: Literal["on", "off", "photo"]
    source: EventSource
    lon_deg: float | None = None
    lat_deg: float | None = None
    relative_m: float | None = None
    index: int | None = None
    amsl_m: float | None = None
    heading_deg: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    attitude_of: PhotoSource = "autopilot"


@dataclass(frozen=True, slots=True)
class Track:
    """A recorded flight, in order of time unless the vehicle rebooted."""

    points: tuple[TrackPoint, ...] = ()
    events: tuple[SensorEvent, ...] = ()
    energy: Energy | None = None

    @property
    def photos(self) -> tuple[PhotoTaken, ...]:
        """The photos taken, in order of time."""
        return photos_among(self.events)


class TrackRecorder:
    """Collects a track from a vehicle's messages and the state after each.

    Parameters
    ----------
    output
        What the payload in use switches; a sensor that reports itself is believed before it.
    clock
        The recording's clock where the messages come from one: seconds since 1970, None while not known.
    in_gimbal
        Whether a gimbal holds the sensor: where it tells where it points, that is the attitude of photos.
    """

    def __init__(
        self,
        output: SensorOutput | None = None,
        clock: Callable[[], float | None] | None = None,
        in_gimbal: bool = False,
    ) -> None:
        self.output = output
        self.in_gimbal = in_gimbal
        self._mount = MountWatch()
        self._clock = clock
        self._began_s: float | None = None
        self._went_on_s: float | None = None
        self._points: list[TrackPoint] = []
        self._events: list[SensorEvent] = []
        self._sensor_on: bool | None = None
        self._sensor_s: float | None = None
        self._sensor_repeats = False
        self._output_on: bool | None = None
        self._output_s: float | None = None
        self._relays_on: int | None = None
        self._unix_minus_boot_s: float | None = None
        self._keep_every = 1
        self._skipped = 0
        self._images: set[tuple[int, int, int, int]] = set()
        self._meter = EnergyMeter()
        #: The place last told when the last attitude came.
        self._attitude_s: float | None = None
        self._attitude_heard = False

    def track(self) -> Track:
        """What was recorded so far."""
        return Track(tuple(self._points), tuple(self._events), self._meter.energy)

    @property
    def recorded(self) -> tuple[float, float] | None:
        """First and last of what was recorded by the recording's clock; None without one, or without any."""
        if self._began_s is None or self._went_on_s is None:
            return None
        return self._began_s, max(self._began_s, self._went_on_s)

    def forget(self) -> None:
        """Drop what was recorded so far, but not how relays stand; a sensor that is on is on anew."""
        self._points.clear()
        self._events.clear()
        self._images.clear()
        self._meter.forget()
        self._sensor_on = self._output_on = None
        self._began_s = self._went_on_s = None
        self._keep_every, self._skipped = 1, 0

    def take(self, message: Message, state: VehicleState) -> None:
        """Take one message, and the state it led to."""
        if message.name == "GLOBAL_POSITION_INT":
            self._position(state)
            if self._clock is not None:
                self._went_on_s = self._clock()
                self._began_s = self._went_on_s if self._began_s is None else self._began_s
        elif is_sensor_switch(message):
            on = bool(message.integer("value"))
            self._sensor_repeats |= on == self._sensor_on
            self._sensor_s = state.time_s
            if on != self._sensor_on:
                self._sensor_on = on
                self._event(state, "on" if on else "off", "payload", time_s=_boot_s(message))
        elif message.name == "RELAY_STATUS":
            self._relays(message, state)
        elif message.name in ("CAMERA_FEEDBACK", "CAMERA_IMAGE_CAPTURED"):
            self._photo(message, state)
        elif message.name == "SYSTEM_TIME":
            if message.integer("time_unix_usec"):
                self._unix_minus_boot_s = message.integer("time_unix_usec") / 1e6 - _boot_s(message)
        elif message.name in ("SERVO_OUTPUT_RAW", "CAMERA_CAPTURE_STATUS"):
            self._switched(message, state)
        elif message.name in MOUNT_MESSAGES:
            self._mount.take(message, state)
        elif message.name == "ATTITUDE":
            self._attitude_heard, self._attitude_s = True, state.time_s
        else:
            self._meter.take(message, state.time_s)

    def _switched(self, message: Message, state: VehicleState) -> None:
        """The output that switches the sensor, where this message tells of it."""
        output = self.output
        on = None if output is None else output.reads(message)
        if output is None or on is None:
            return
        before, self._output_on = self._output_on, on
        self._output_s = state.time_s
        if on == bool(before):
            return
        if message.name == "SERVO_OUTPUT_RAW":
            time_s = unwrapped_s(message.integer("time_usec") / 1e6, state.time_s)
        else:
            time_s = _boot_s(message)
        self._event(state, "on" if on else "off", _SOURCES[type(output)], time_s=time_s, index=output.index)

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
        if self._attitude_heard and self._attitude_s is None:
            self._attitude_s = time_s
        level = self._attitude_s is not None and abs(time_s - self._attitude_s) <= _ATTITUDE_S
        self._points.append(
            TrackPoint(
                time_s,
                lon_deg,
                lat_deg,
                relative_m,
                amsl_m,
                state.heading_deg,
                state.course_deg,
                state.roll_deg if level else None,
                state.pitch_deg if level else None,
                state.ground_speed_m_s,
                self._told(state, time_s),
                state.mission_current,
                self._mount.at(time_s) if self.in_gimbal else None,
            )
        )
        if len(self._points) > _MOST_POINTS:
            del self._points[1::2]
            self._keep_every *= 2

    def _told(self, state: VehicleState, time_s: float) -> bool | None:
        """Whether the sensor is on, by its own report, else by its output; None where nothing tells.

        One that repeats itself and has fallen silent may be dead, whatever was ordered; one that tells
        changes alone still counts.
        """
        if state.sensor_on is None:
            return self._shown(time_s)
        if not self._sensor_repeats or self._sensor_s is None or abs(time_s - self._sensor_s) <= TOLD_SHOWS_S:
            return state.sensor_on
        return False if self._shown(time_s) is False else None

    def _shown(self, time_s: float) -> bool | None:
        """What the output says now: for a while, unless it goes on saying so.

        Cameras tell of their captures when these begin and end.
        """
        if self._output_on is None or not isinstance(self.output, (RelayOutput, ServoOutput)):
            return self._output_on
        self._output_s = time_s if self._output_s is None else self._output_s
        return self._output_on if abs(time_s - self._output_s) <= TOLD_SHOWS_S else None

    def _relays(self, message: Message, state: VehicleState) -> None:
        present, on = message.integer("present"), message.integer("on")
        before = on if self._relays_on is None else self._relays_on
        self._relays_on = on
        if isinstance(self.output, RelayOutput):
            self._output_on = self.output.reads(message)
            self._output_s = state.time_s
        for number in range(16):
            bit = 1 << number
            if present & bit and (before ^ on) & bit:
                self._event(
                    state, "on" if on & bit else "off", "relay", time_s=_boot_s(message), index=number
                )

    def _photo(self, message: Message, state: VehicleState) -> None:
        if message.name == "CAMERA_FEEDBACK":
            index, lon, camera = (
                message.integer("img_idx"),
                message.integer("lng"),
                message.integer("cam_idx"),
            )
            relative_m, amsl_m = finite(message, "alt_rel"), finite(message, "alt_msl")
            angles_deg = tuple(finite(message, name) for name in ("roll", "pitch", "yaw"))
            time_s = self._camera_clock_s(message.integer("time_usec") / 1e6, state.time_s)
        else:
            if message.integer("capture_result") != 1:
                return
            index, lon, camera = message.integer("image_index"), message.integer("lon"), message.component_id
            relative_m, amsl_m = (message.number(name) / 1000.0 for name in ("relative_alt", "alt"))
            angles_deg = angles_of(message.fields.get("q")) or (None, None, None)
            time_s = _boot_s(message)
        lat = message.integer("lat")
        image = (camera, index, lat, lon)
        if image in self._images:
            return  # the same feedback again, by another way
        self._images.add(image)
        if lat == 0 and lon == 0:
            # A camera without a position says zero.
            place, relative_m = (state.lon_deg, state.lat_deg), state.relative_altitude_m
            amsl_m = state.altitude_amsl_m
        else:
            place = (lon / 1e7, lat / 1e7)
        roll_deg, pitch_deg, yaw_deg = angles_deg
        source: PhotoSource = "camera" if message.component_id in _CAMERAS else "autopilot"
        mount = self._mount.at(state.time_s) if self.in_gimbal and source == "autopilot" else None
        if mount is not None:
            roll_deg, pitch_deg, yaw_deg = mount.roll_deg, mount.pitch_deg, mount.yaw_deg
            source = "camera"
        self._events.append(
            SensorEvent(
                time_s if time_s is not None else state.time_s or 0.0,
                "photo",
                "camera",
                *place,
                relative_m,
                index,
                amsl_m,
                None if yaw_deg is None else yaw_deg % 360.0,
                roll_deg,
                pitch_deg,
                source,
            )
        )

    def _camera_clock_s(self, told_s: float, near_s: float | None) -> float | None:
        """The vehicle's time of a time in the camera's clock: since boot or since 1970."""
        for offset_s in (0.0, self._unix_minus_boot_s):
            if (
                near_s is not None
                and offset_s is not None
                and abs(told_s - offset_s - near_s) < _SAME_CLOCK_S
            ):
                return told_s - offset_s
        return near_s

    def _event(
        self,
        state: VehicleState,
        kind: Literal["on", "off"],
        source: EventSource,
        *,
        time_s: float,
        index: int | None = None,
    ) -> None:
        place = (state.lon_deg, state.lat_deg, state.relative_altitude_m)
        self._events.append(SensorEvent(time_s, kind, source, *place, index))


def unwrapped_s(told_s: float, near_s: float | None) -> float:
    """A time of 32 bits of microseconds, made whole with one that lies near it."""
    if near_s is None:
        return told_s
    return told_s + round((near_s - told_s) / _WRAP_S) * _WRAP_S


def _boot_s(message: Message) -> float:
    return message.number("time_boot_ms") / 1000.0
