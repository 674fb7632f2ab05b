"""What an onboard log tells of a flight, whatever its format."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

from mavlink.encoding.payload import Payload
from mavlink.state.modes import Autopilot
from mavlink.state.outputs import RelayOutput, ServoOutput, output_of, switched_by
from mavlink.state.photos import PhotoTaken, photos_among
from mavlink.state.track import SensorEvent, TrackPoint

#: Pulses are logged several times a second: an older one tells nothing.
PULSE_S: Final = 2.0

#: Whether the sensor was on at a time of the vehicle's clock; None where the log does not tell.
Switch = Callable[[float], bool | None]


@dataclass(frozen=True, slots=True)
class OnboardLog:
    """A log from boot on.

    Parameters
    ----------
    points
        In order, times since boot; ``sensor_on`` only where the log itself says it.
    photos
        Taken by cameras.
    relays
        Number to its changes: time, and whether it is closed from then on; open before the first.
    pulses
        Number of an output, counted over the ports from 1, to its pulses: time and microseconds, in order.
    unix_minus_boot_s
        What its clock is behind that of the world; None where no receiver told.
    """

    autopilot: Autopilot
    points: tuple[TrackPoint, ...]
    photos: tuple[SensorEvent, ...] = ()
    relays: Mapping[int, tuple[tuple[float, bool], ...]] = field(default_factory=dict)
    pulses: Mapping[int, tuple[tuple[float, float], ...]] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    unix_minus_boot_s: float | None = None

    @property
    def taken(self) -> tuple[PhotoTaken, ...]:
        """The photos in order of time."""
        return photos_among(self.photos)


def switch_of(log: OnboardLog, payload: Payload) -> Switch | None:
    """When a payload was on; None where the log tells nothing of what switches it."""
    if any(point.sensor_on is not None for point in log.points):
        told = [(point.time_s, bool(point.sensor_on)) for point in log.points]
        return _steps(told, PULSE_S)
    output = output_of(switched_by(payload, log.autopilot), log.autopilot, log.parameters)
    match output:
        case RelayOutput(relay) if relay in log.relays:
            return _steps(log.relays[relay], None)
        case ServoOutput() if output.index in log.pulses:
            pulses = log.pulses[output.index]
            on = [(at_s, _is_on(output, pulse_us)) for at_s, pulse_us in pulses]
            return _steps(on, PULSE_S)
    return None


def _is_on(output: ServoOutput, pulse_us: float) -> bool:
    return pulse_us > 0.0 and abs(pulse_us - output.on_us) < abs(pulse_us - output.off_us)


def _steps(changes: list[tuple[float, bool]] | tuple[tuple[float, bool], ...], old_s: float | None) -> Switch:
    """What was last told; changes hold until the next one, readings for a while."""
    times_s = [at_s for at_s, _ in changes]

    def at(time_s: float) -> bool | None:
        row = bisect_right(times_s, time_s) - 1
        if row < 0:
            return False if old_s is None else None
        return changes[row][1] if old_s is None or time_s - times_s[row] <= old_s else None

    return at
