"""Where a vehicle shows whether its sensor is on: the output that the payload in use switches.

A sensor that reports itself (``SAR_ON``) is believed first; most do not, and then the output tells what the
autopilot ordered.

Source: MAVLink ``common.xml`` (SERVO_OUTPUT_RAW 36, CAMERA_CAPTURE_STATUS 262, RELAY_STATUS 376); PX4
``mixer_module`` (functions 301 to 306 are actuator sets 1 to 6; PWM_*_MIN, _MAX and _REV say how a value
becomes a pulse).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from mavlink.encoding.payload import (
    PX4_OUTPUTS,
    ActuatorPayload,
    CameraPayload,
    ImagePayload,
    JointPayload,
    Payload,
    Px4Output,
    RelayPayload,
    ServoPayload,
    TriggerPayload,
)
from mavlink.state.modes import Autopilot
from mavlink.wire.messages import Message

SERVO_OUTPUT_RAW: Final = 36
CAMERA_CAPTURE_STATUS: Final = 262
RELAY_STATUS: Final = 376

_CHANNELS: Final = 16
#: An output without pulses, and one that is not there.
_NO_PULSE_US: Final = frozenset({0, 65535})
_GROUPS: Final = tuple(PX4_OUTPUTS)
_PX4_PULSES_US: Final = (1000.0, 2000.0)
#: CAMERA_CAPTURE_STATUS.image_status from here on: an interval is set.
_INTERVAL_SET: Final = 2


@dataclass(frozen=True, slots=True)
class RelayOutput:
    """A relay by its number from 0."""

    relay: int

    @property
    def index(self) -> int:
        """Its number in events."""
        return self.relay

    def reads(self, message: Message) -> bool | None:
        """Whether it is closed; None when the message does not tell."""
        bit = 1 << self.relay
        if message.name != "RELAY_STATUS" or not message.integer("present") & bit:
            return None
        return bool(message.integer("on") & bit)


@dataclass(frozen=True, slots=True)
class ServoOutput:
    """A servo output by port and its number there from 1; on is whatever lies nearer to on than to off."""

    port: int
    channel: int
    on_us: float
    off_us: float

    @property
    def index(self) -> int:
        """Its number in events, counted over the ports."""
        return self.port * _CHANNELS + self.channel

    def reads(self, message: Message) -> bool | None:
        """Whether its pulses say on; None when the message does not tell."""
        if message.name != "SERVO_OUTPUT_RAW" or message.integer("port") != self.port:
            return None
        pulse_us = message.integer(f"servo{self.channel}_raw")
        if pulse_us in _NO_PULSE_US:
            return False
        return abs(pulse_us - self.on_us) < abs(pulse_us - self.off_us)


@dataclass(frozen=True, slots=True)
class CameraOutput:
    """A camera told to take pictures at an interval, or a video; photos are recorded whatever is switched."""

    index: int | None = None
    video: bool = False

    def reads(self, message: Message) -> bool | None:
        """Whether an interval is set, or a video taken; None when the message does not tell."""
        if message.name != "CAMERA_CAPTURE_STATUS":
            return None
        if self.video:
            return message.integer("video_status") > 0
        return message.integer("image_status") >= _INTERVAL_SET


@dataclass(frozen=True, slots=True)
class PhotoOutput:
    """A shutter released by distance: nothing shows whether it would be, but each photo that it was."""

    index: int | None = None

    def reads(self, message: Message) -> bool | None:
        """True for a photo; None when the message is none, which tells nothing."""
        taken = message.name == "CAMERA_FEEDBACK" or (
            message.name == "CAMERA_IMAGE_CAPTURED" and message.integer("capture_result") == 1
        )
        return True if taken else None


SensorOutput = RelayOutput | ServoOutput | CameraOutput | PhotoOutput

#: Messages that outputs are read from which the autopilot sends only when asked, and how often a second.
INTERVALS_HZ: Final[Mapping[type, Mapping[int, float]]] = {
    RelayOutput: {RELAY_STATUS: 10.0},
    ServoOutput: {SERVO_OUTPUT_RAW: 10.0},
    CameraOutput: {CAMERA_CAPTURE_STATUS: 4.0},
    PhotoOutput: {},
}


def switched_by(payload: Payload, autopilot: Autopilot) -> Payload:
    """The payload as an autopilot switches it: PX4 has no relays, an actuator stands for each."""
    if autopilot == "px4" and isinstance(payload, RelayPayload):
        return ActuatorPayload(payload.relay + 1)
    if autopilot == "px4" and isinstance(payload, JointPayload):
        return JointPayload(
            tuple(ActuatorPayload(p.relay + 1) if isinstance(p, RelayPayload) else p for p in payload.parts)
        )
    return payload


def function_parameters(payload: Payload, autopilot: Autopilot) -> tuple[str, ...]:
    """Parameters that say which output a payload is; none where the payload says so itself."""
    if autopilot != "px4" or not isinstance(payload, ActuatorPayload):
        return ()
    return tuple(output.function_parameter for output in px4_outputs(payload))


def px4_outputs(payload: ActuatorPayload) -> tuple[Px4Output, ...]:
    """The outputs that may follow an actuator: the one that is named, else all."""
    if payload.output is not None:
        return (payload.output,)
    return tuple(Px4Output(group, n) for group, count in PX4_OUTPUTS.items() for n in range(1, count + 1))


def pulse_parameters(
    payload: Payload, autopilot: Autopilot, functions: Mapping[str, float]
) -> tuple[str, ...]:
    """Parameters that say how the output's values become pulses, once its function is known."""
    if autopilot != "px4" or not isinstance(payload, ActuatorPayload):
        return ()
    place = _place(payload, functions)
    if place is None:
        return ()
    group, number = f"PWM_{place.group.upper()}", place.number
    return (f"{group}_MIN{number}", f"{group}_MAX{number}", f"{group}_REV")


def output_of(
    payload: Payload, autopilot: Autopilot, values: Mapping[str, float] | None = None
) -> SensorOutput | None:
    """The output to watch; None when the payload has none, is several, or the parameters name none.

    Parameters
    ----------
    payload
        As the autopilot switches it.
    values
        Parameters by name: ``function_parameters``, and of ``pulse_parameters`` those the vehicle has.
    """
    match payload:
        case RelayPayload():
            return RelayOutput(payload.relay)
        case ServoPayload():
            port, channel = divmod(payload.servo - 1, _CHANNELS)
            return ServoOutput(port, channel + 1, float(payload.on_pwm_us), float(payload.off_pwm_us))
        case ActuatorPayload():
            return _actuator(payload, values or {})
        case TriggerPayload(by="video"):
            # ArduPilot tells of no video.
            return CameraOutput(video=True) if autopilot == "px4" else None
        case CameraPayload() | TriggerPayload(by="distance"):
            return PhotoOutput()
        case ImagePayload() | TriggerPayload():
            return CameraOutput()
    return None


def _actuator(payload: ActuatorPayload, values: Mapping[str, float]) -> ServoOutput | None:
    place = _place(payload, values)
    if place is None:
        return None
    group, number = f"PWM_{place.group.upper()}", place.number
    least_us = values.get(f"{group}_MIN{number}", _PX4_PULSES_US[0])
    most_us = values.get(f"{group}_MAX{number}", _PX4_PULSES_US[1])
    turned = round(values.get(f"{group}_REV", 0.0)) >> (number - 1) & 1

    def pulse_us(value: float) -> float:
        part = (1.0 - value if turned else 1.0 + value) / 2.0
        return least_us + part * (most_us - least_us)

    return ServoOutput(
        _GROUPS.index(place.group), number, pulse_us(payload.on_value), pulse_us(payload.off_value)
    )


def _place(payload: ActuatorPayload, values: Mapping[str, float]) -> Px4Output | None:
    """The first output with the actuator's function."""
    for output in px4_outputs(payload):
        if round(values.get(output.function_parameter, 0.0)) == payload.function:
            return output
    return None
