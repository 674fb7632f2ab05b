"""How the sensor is switched on and off: the item right behind the waypoint at each end of a collect."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, cast, get_args

from mavlink.wire.items import Command, Frame, MissionItem
from planner.plan import Trigger

Parameters = tuple[float, float, float, float, float, float, float]

_NOTHING: Parameters = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


OutputGroup = Literal["main", "aux"]
#: PX4's groups of outputs, in the order of SERVO_OUTPUT_RAW's ports, and the most outputs a board has there.
PX4_OUTPUTS: Mapping[OutputGroup, int] = {"main": 16, "aux": 8}
_FIRST_ACTUATOR_FUNCTION = 301
#: Between two payloads; numbers may have a plus, too.
_JOINED = re.compile(r"\+(?=\s*[a-z])")
_STOPS: Mapping[Trigger, Command] = {
    "distance": Command.DO_SET_CAM_TRIGG_DIST,
    "time": Command.IMAGE_STOP_CAPTURE,
    "video": Command.VIDEO_STOP_CAPTURE,
}


class PayloadError(ValueError):
    """A payload that cannot be switched as asked."""


@dataclass(frozen=True, slots=True)
class RelayPayload:
    """A relay, closed while the sensor is on: DO_SET_RELAY."""

    relay: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.relay <= 15:
            raise PayloadError(f"relay {self.relay}: ArduPilot counts relays from 0 to 15")


@dataclass(frozen=True, slots=True)
class ServoPayload:
    """A servo output with two positions, pulse widths in microseconds: DO_SET_SERVO."""

    servo: int
    on_pwm_us: int = 1900
    off_pwm_us: int = 1100

    def __post_init__(self) -> None:
        if not 1 <= self.servo <= 32:
            raise PayloadError(f"servo {self.servo}: outputs are numbered 1 to 32")
        for pwm_us in (self.on_pwm_us, self.off_pwm_us):
            if not 500 <= pwm_us <= 2500:
                raise PayloadError(f"pulse width {pwm_us} µs: between 500 and 2500 is meant")


@dataclass(frozen=True, slots=True)
class Px4Output:
    """One of PX4's outputs by the name on its case, MAIN or AUX, and its number there from 1."""

    group: OutputGroup
    number: int

    def __post_init__(self) -> None:
        most = PX4_OUTPUTS[self.group]
        if not 1 <= self.number <= most:
            raise PayloadError(f"{self}: {self.group.upper()} outputs are numbered 1 to {most}")

    def __str__(self) -> str:
        return f"{self.group.upper()} {self.number}"

    @property
    def function_parameter(self) -> str:
        """The parameter that says what the output follows."""
        return f"PWM_{self.group.upper()}_FUNC{self.number}"


@dataclass(frozen=True, slots=True)
class ActuatorPayload:
    """One of PX4's actuators by function, values -1 to 1: DO_SET_ACTUATOR.

    Actuators 5 and 6 travel in the integers of an item, where "unchanged" cannot be said: each order centres
    them, so they must not be in use for anything else.

    Parameters
    ----------
    output
        The output that must follow the actuator; None for whichever does. No mission item names outputs: the
        vehicle's own parameters say what each of them follows.
    """

    actuator: int = 1
    on_value: float = 1.0
    off_value: float = -1.0
    output: Px4Output | None = None

    def __post_init__(self) -> None:
        if not 1 <= self.actuator <= 4:
            raise PayloadError(f"actuator {self.actuator}: 1 to 4 can be set by a mission item")
        for value in (self.on_value, self.off_value):
            if not -1.0 <= value <= 1.0:
                raise PayloadError(f"actuator value {value}: between -1 and 1 is meant")

    @property
    def function(self) -> int:
        """What an output's parameter holds when it follows this actuator: 301 is Actuator Set 1."""
        return _FIRST_ACTUATOR_FUNCTION + self.actuator - 1


@dataclass(frozen=True, slots=True)
class CameraPayload:
    """A shutter released every so many metres: DO_SET_CAM_TRIGG_DIST."""

    distance_m: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.distance_m) and self.distance_m > 0.0):
            raise PayloadError(f"shutter distance {self.distance_m} m: a positive number is meant")


@dataclass(frozen=True, slots=True)
class ImagePayload:
    """A camera of the camera protocol: IMAGE_START_CAPTURE and IMAGE_STOP_CAPTURE."""

    interval_s: float = 1.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.interval_s) and self.interval_s > 0.0):
            raise PayloadError(f"interval {self.interval_s} s: a positive number is meant")


@dataclass(frozen=True, slots=True)
class TriggerPayload:
    """The cameras of a plan, released where it has its photos; ``encoding.trigger`` says how.

    Parameters
    ----------
    spacing
        Largest distance (m) or interval (s) between two photos of a collect; None for a video, and where the
        plan is still to be asked.
    """

    by: Trigger
    spacing: float | None = None

    def __post_init__(self) -> None:
        if self.by not in get_args(Trigger):
            raise PayloadError(f"trigger {self.by!r}: distance, time or video is meant")
        if self.spacing is not None and not (math.isfinite(self.spacing) and self.spacing > 0.0):
            raise PayloadError(f"photo spacing {self.spacing}: a positive number is meant")


@dataclass(frozen=True, slots=True)
class CommandPayload:
    """Any command, with its seven parameters for on and for off.

    Parameters five and six travel as integers; fractions are refused.
    """

    on_command: int
    on: Parameters
    off_command: int
    off: Parameters

    def __post_init__(self) -> None:
        for command in (self.on_command, self.off_command):
            if not 0 < command <= 65535:
                raise PayloadError(f"command {command}: 1 to 65535 is meant")
        for parameters in (self.on, self.off):
            for number in (5, 6):
                value = parameters[number - 1]
                if not (math.isfinite(value) and value == round(value)):
                    raise PayloadError(f"parameter {number} travels as an integer, {value} does not fit")


#: Switched by one item on and one off.
OutputPayload = RelayPayload | ServoPayload | ActuatorPayload | CameraPayload | ImagePayload | CommandPayload


@dataclass(frozen=True, slots=True)
class JointPayload:
    """Several payloads of one vehicle: an output for what is no camera, and the plan's cameras."""

    parts: tuple[OutputPayload | TriggerPayload, ...]


Payload = OutputPayload | TriggerPayload | JointPayload


def parts_of(payload: Payload) -> tuple[OutputPayload | TriggerPayload, ...]:
    """The payloads that a payload is made of; itself where it is one alone."""
    return payload.parts if isinstance(payload, JointPayload) else (payload,)


def off_items(payload: Payload) -> tuple[MissionItem, ...]:
    """The items that switch a payload off and take no photo, not yet numbered."""
    found: list[MissionItem] = []
    for part in parts_of(payload):
        if isinstance(part, TriggerPayload):
            found.append(_item(_STOPS[part.by]))
        else:
            found.append(switch_items(part)[1])
    return tuple(found)


def switch_items(payload: OutputPayload) -> tuple[MissionItem, MissionItem]:
    """The items that switch a payload on and off, in the frame of items without a place, not yet numbered."""
    if isinstance(payload, RelayPayload):
        return _item(Command.DO_SET_RELAY, payload.relay, 1.0), _item(
            Command.DO_SET_RELAY, payload.relay, 0.0
        )
    if isinstance(payload, ServoPayload):
        return (
            _item(Command.DO_SET_SERVO, payload.servo, payload.on_pwm_us),
            _item(Command.DO_SET_SERVO, payload.servo, payload.off_pwm_us),
        )
    if isinstance(payload, ActuatorPayload):
        return _actuator(payload.actuator, payload.on_value), _actuator(payload.actuator, payload.off_value)
    if isinstance(payload, CameraPayload):
        # Param 3 takes the first picture at once: at the collect's start, not a spacing later.
        return (
            _item(Command.DO_SET_CAM_TRIGG_DIST, payload.distance_m, 0.0, 1.0),
            _item(Command.DO_SET_CAM_TRIGG_DIST, 0.0),
        )
    if isinstance(payload, ImagePayload):
        return (
            _item(Command.IMAGE_START_CAPTURE, 0.0, payload.interval_s, 0.0),
            _item(Command.IMAGE_STOP_CAPTURE, 0.0),
        )
    return _raw(payload.on_command, payload.on), _raw(payload.off_command, payload.off)


def parse_payload(text: str) -> Payload:
    """The payload of a specification.

    ``relay:0`` · ``servo:9:1900:1100`` (output, on, off in µs) · ``actuator:1:1:-1`` (number, on, off) ·
    ``aux:3:1:1:-1`` or ``main:…`` (PX4's output, the actuator it follows, on, off) ·
    ``camera:distance=25`` (m) · ``image:interval=2`` (s) · ``trigger:distance``, ``trigger:time`` or
    ``trigger:video`` (the plan's cameras) · ``command:2000:0,2,0/2001:0`` (command and parameters for on,
    then for off; the off command may be left out when it is the same). Several are joined by ``+``.

    Raises
    ------
    PayloadError
        Naming what is not understood.
    """
    if _JOINED.search(text):
        return _joint(text)
    kind, _, rest = text.strip().partition(":")
    try:
        if kind == "relay":
            return RelayPayload(int(rest or "0"))
        if kind == "servo":
            return ServoPayload(*(int(part) for part in rest.split(":")))
        if kind == "actuator":
            number, *values = rest.split(":") if rest else ["1"]
            return ActuatorPayload(int(number), *_on_off(values))
        for group in PX4_OUTPUTS:
            if kind == group:
                output, number, *values = rest.split(":") if ":" in rest else [rest, "1"]
                return ActuatorPayload(int(number), *_on_off(values), Px4Output(group, int(output)))
        if kind == "camera":
            return CameraPayload(_named(rest, "distance"))
        if kind == "image":
            return ImagePayload(_named(rest, "interval"))
        if kind == "trigger":
            by, equals, spacing = rest.partition("=")
            return TriggerPayload(cast(Trigger, by), float(spacing) if equals else None)
        if kind == "command":
            return _parse_command(rest)
    except PayloadError:
        raise
    except (TypeError, ValueError) as error:
        raise PayloadError(f"payload {text!r}: {error}") from error
    raise PayloadError(
        f"payload {text!r}: begins with none of relay, servo, actuator, main, aux, camera, image, trigger,"
        " command"
    )


def separated(text: str) -> list[str]:
    """The specifications that one joins."""
    return [each.strip() for each in _JOINED.split(text)]


def _joint(text: str) -> JointPayload:
    parts = [part for each in separated(text) for part in parts_of(parse_payload(each))]
    outputs = [part for part in parts if not isinstance(part, TriggerPayload)]
    triggers = [part.by for part in parts if isinstance(part, TriggerPayload)]
    if len(outputs) > 1 or len(set(triggers)) < len(triggers):
        raise PayloadError(f"payload {text!r}: one output, and each trigger once, are joined by +")
    return JointPayload(tuple(parts))


def _on_off(values: Sequence[str]) -> tuple[float, float]:
    """The values for on and off that were written, else those of an actuator's ends."""
    on, off, *others = [*values, *("1", "-1")[len(values) :]]
    if others:
        raise PayloadError(f"an actuator has a value for on and one for off, not {len(values)}")
    return float(on), float(off)


def _parse_command(text: str) -> CommandPayload:
    on_text, slash, off_text = text.partition("/")
    if not slash:
        raise PayloadError(f"command payload {text!r}: on and off are divided by a slash")
    on_command, _, on_parameters = on_text.partition(":")
    off_command, colon, off_parameters = off_text.partition(":")
    if not colon:
        off_command, off_parameters = on_command, off_text
    return CommandPayload(
        int(on_command), _parameters(on_parameters), int(off_command), _parameters(off_parameters)
    )


def _parameters(text: str) -> Parameters:
    values = [float(part) for part in text.split(",")] if text else []
    if len(values) > len(_NOTHING):
        raise PayloadError(f"{len(values)} parameters, a command has seven")
    p1, p2, p3, p4, p5, p6, p7 = [*values, *_NOTHING[len(values) :]]
    return (p1, p2, p3, p4, p5, p6, p7)


def _named(text: str, name: str) -> float:
    key, equals, value = text.partition("=")
    if key != name or not equals:
        raise PayloadError(f"{text!r}: {name}=… is meant")
    return float(value)


def _item(command: int, param1: float = 0.0, param2: float = 0.0, param3: float = 0.0) -> MissionItem:
    return MissionItem(
        0, Frame.MISSION, command, param1=float(param1), param2=float(param2), param3=float(param3)
    )


def _actuator(actuator: int, value: float) -> MissionItem:
    param1, param2, param3, param4 = (value if actuator == n else math.nan for n in (1, 2, 3, 4))
    return MissionItem(
        0,
        Frame.MISSION,
        Command.DO_SET_ACTUATOR,
        param1=param1,
        param2=param2,
        param3=param3,
        param4=param4,
    )


def _raw(command: int, values: Parameters) -> MissionItem:
    param1, param2, param3, param4, x, y, z = values
    return MissionItem(
        0,
        Frame.MISSION,
        command,
        param1=param1,
        param2=param2,
        param3=param3,
        param4=param4,
        x=round(x),
        y=round(y),
        z=z,
    )
