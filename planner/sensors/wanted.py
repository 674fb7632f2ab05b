"""From how high a sensor still gives the quality that a region asks for.

Heights are over the lowest ground seen, which is seen from farthest and so worst.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.sensors.sar import SarSensor
from planner.sensors.worth import worth_of
from planner.wishes import Region


@dataclass(frozen=True, slots=True)
class Wanted:
    """One wish of a region, and what it asks of the height.

    Parameters
    ----------
    wish, asked
        The property, and its value.
    height_m
        The greatest height that gives it; 0 where none does.
    given
        What a height gives, in the property's own terms.
    """

    wish: str
    asked: float
    height_m: float
    given: Callable[[float], float]

    def allowed(self, height_m: float) -> float:
        """The wish that a height just gives, on the safe side."""
        value = self.given(height_m)
        digits = 3 - math.floor(math.log10(abs(value))) if value else 3
        scale = 10.0 ** min(max(digits, 0), 8)
        rounded = math.floor(value * scale) if self.wish == "min_niirs" else math.ceil(value * scale)
        return rounded / scale


class UnknownQualityError(Exception):
    """A sensor's quality is not known: why, and what would tell it."""

    def __init__(self, message: str, fix: str) -> None:
        super().__init__(message)
        self.message, self.fix = message, fix


def wanted_of(region: Region, sensor: Sensor) -> tuple[Wanted, ...]:
    """The wishes whose keeping depends on the height.

    Raises
    ------
    UnknownQualityError
        NIIRS is asked of a sensor that does not say enough of itself.
    """
    if isinstance(sensor, CameraSensor):
        return _of_camera(region, sensor)
    if region.min_niirs is None:
        return ()
    if not isinstance(sensor, SarSensor):
        raise UnknownQualityError(
            f"asks for min_niirs of {sensor.name}, a {sensor.kind}, whose NIIRS nothing tells",
            "Leave min_niirs out.",
        )
    return (Wanted("min_niirs", region.min_niirs, _radar_height_m(sensor, region.min_niirs), _niirs(sensor)),)


def _of_camera(region: Region, sensor: CameraSensor) -> tuple[Wanted, ...]:
    found = [
        Wanted(wish, asked_m, asked_m / sensor.worst_gsd, lambda height_m: sensor.worst_gsd * height_m)
        for wish, asked_m in (("gsd_m", region.gsd_m), ("min_resolution_m", region.min_resolution_m))
        if asked_m is not None
    ]
    if region.min_niirs is not None:
        if sensor.quality is None:
            raise UnknownQualityError(
                f"asks for min_niirs, and camera {sensor.name} says neither rer nor snr, which decide it",
                f"Add rer and snr to sensor {sensor.name}, or ask for gsd_m.",
            )
        largest_m = sensor.quality.largest_gsd_m(region.min_niirs)
        found.append(Wanted("min_niirs", region.min_niirs, largest_m / sensor.worst_gsd, _niirs(sensor)))
    return tuple(found)


def _niirs(sensor: CameraSensor | SarSensor) -> Callable[[float], float]:
    def given(height_m: float) -> float:
        worst = worth_of(sensor, height_m, 0.0, 0.0).niirs
        assert worst is not None
        return worst

    return given


def _radar_height_m(sensor: SarSensor, niirs: float) -> float:
    """The worst NIIRS falls with the height, whichever edge of the beam it is at."""
    given = _niirs(sensor)
    if niirs > given(0.0):
        return 0.0
    low_m, high_m = 0.0, 1.0
    while given(high_m) >= niirs:
        low_m, high_m = high_m, 2.0 * high_m
    for _ in range(60):
        middle_m = (low_m + high_m) / 2.0
        low_m, high_m = (middle_m, high_m) if given(middle_m) >= niirs else (low_m, middle_m)
    return low_m
