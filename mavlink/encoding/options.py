"""What a mission leaves to choose."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from mavlink.encoding.gimbal import Gimbal
from mavlink.encoding.payload import Payload, RelayPayload

Arcs = Literal["auto", "points", "loiter"]

#: What switches a sensor that is no camera, where nothing else is said.
DEFAULT_PAYLOAD = RelayPayload(relay=0)


class EncodeError(ValueError):
    """A plan that cannot be said in the dialect asked for, or not with these options."""


@dataclass(frozen=True, slots=True)
class EncodeOptions:
    """Choices a mission leaves open.

    Parameters
    ----------
    chord_error_m
        Largest distance between an arc of the path and the lines between its waypoints.
    arcs
        How arcs are said: ``points`` along them, or ``loiter`` turns round their centres, on ArduPlane alone
        and where the item can hold them. ``auto`` takes turns where they were measured to be flown better.
    payload
        How the sensor is switched; None for the plan's own way, its cameras by their triggers and all else by
        ``DEFAULT_PAYLOAD``. PX4 has no relays: there a relay becomes the actuator of the same place.
    acceptance_radius_m
        Distance at which a waypoint counts as reached, where the autopilot lets items say it; None for the
        vehicle's own.
    off_delay_m
        How far past a collect's end the sensor is switched off, for autopilots that pass waypoints early.
        None for what the autopilot needs: on PX4's fixed wings how early it turns, elsewhere 0.
    home_altitude_m
        Height of home above sea level, where known.
    rally_at_home
        Whether home becomes a rally point too.
    gimbal
        What points the sensor at every collect; None where it is bolted on.
    sortie
        Which of its vehicle's flights.
    """

    chord_error_m: float = 2.0
    arcs: Arcs = "auto"
    payload: Payload | None = None
    acceptance_radius_m: float | None = None
    off_delay_m: float | None = None
    home_altitude_m: float = 0.0
    rally_at_home: bool = False
    gimbal: Gimbal | None = None
    sortie: int = 1

    def __post_init__(self) -> None:
        if self.arcs not in get_args(Arcs):
            raise EncodeError(f"arcs is {self.arcs!r}: auto, points or loiter is meant")
        if not (math.isfinite(self.chord_error_m) and self.chord_error_m > 0.0):
            raise EncodeError(f"chord_error_m is {self.chord_error_m}: a positive number is meant")
        if self.acceptance_radius_m is not None and not 1.0 <= self.acceptance_radius_m <= 255.0:
            raise EncodeError(f"acceptance_radius_m is {self.acceptance_radius_m}: 1 to 255 is meant")
        if self.off_delay_m is not None and not (math.isfinite(self.off_delay_m) and self.off_delay_m >= 0.0):
            raise EncodeError(f"off_delay_m is {self.off_delay_m}: 0 or more is meant")
