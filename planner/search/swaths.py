"""What each kind of sensor sees beside its course, and the passes that see a strip of ground with it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from shapely.geometry import Polygon

from planner.errors import InfeasibleError
from planner.route import CollectPass, Look
from planner.search.values import Swath
from planner.sensors import camera_view, view
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.sensors.sar import SarSensor
from planner.sensors.strip import strip_on

Place = tuple[float, float]

#: A camera's pass is no shorter than this.
LEAST_PASS_M = 2.0


@dataclass(frozen=True, slots=True)
class Looking:
    """A sensor at a height over the ground.

    Parameters
    ----------
    names
        Of the regions that make up the ground.
    height_m
        Over the mean ground.
    """

    sensor: Sensor
    height_m: float
    names: tuple[str, ...]

    @property
    def looks(self) -> tuple[Look, ...]:
        """The sides it can look to."""
        return self.sensor.looks

    def swath(self, course_rad: float, look: Look) -> Swath:
        """What it sees beside a course.

        Raises
        ------
        InfeasibleError
            ``"sensor"``: searches know no such kind; ``"swath"``: its margins leave nothing.
        """
        known = _SWATHS.get(self.sensor.kind)
        if known is None:
            raise InfeasibleError(
                "sensor",
                f"sensor {self.sensor.name}",
                f"is of the kind {self.sensor.kind}, with which nothing is searched",
                f"Search with one of: {', '.join(_SWATHS)}.",
            )
        found = known(self.sensor, self.height_m, course_rad, look)
        if found.width_m <= 0.0:
            raise InfeasibleError(
                "swath",
                f"sensor {self.sensor.name}",
                f"sees nothing from {self.height_m:.0f} m with its margins taken off",
                "Fly higher, or lower pointing_margin_deg or position_margin_m.",
            )
        return found

    def narrowest_m(self) -> float:
        """Width of the narrowest strip of any course."""
        courses = (math.radians(k * 15.0) for k in range(24))
        return min(self.swath(course, look).width_m for course in courses for look in self.looks)

    def collect(self, start: Place, end: Place, look: Look) -> CollectPass:
        """The pass along a line."""
        seen, apart_m = _SEEN[self.sensor.kind](self.sensor, self.height_m, start, end, look)
        return CollectPass(self.names, self.sensor.name, look, start, end, 0.5, seen, apart_m)


def _camera(sensor: CameraSensor, height_m: float, course_rad: float, _look: Look) -> Swath:
    half_m = sensor.half_width_m(height_m, course_rad)
    run_m = (sensor.seen_in_m(height_m, course_rad), sensor.seen_out_m(height_m, course_rad))
    return Swath(-half_m, half_m, *run_m)


def _radar(sensor: SarSensor, height_m: float, course_rad: float, look: Look) -> Swath:
    strip = strip_on(sensor, height_m, course_rad, look)
    near_m, swath_m = float(strip.near_m[0]), float(strip.swath_m[0])
    edges_m = (-near_m - swath_m, -near_m) if look == "right" else (near_m, near_m + swath_m)
    return Swath(*edges_m, float(strip.run_in_m[0]), float(strip.run_out_m[0]))


def _seen_by_camera(
    sensor: CameraSensor, height_m: float, start: Place, end: Place, _look: Look
) -> tuple[Polygon, float | None]:
    course_rad = math.atan2(end[1] - start[1], end[0] - start[0])
    seen = camera_view.seen_on_flat(sensor, (start, end), height_m)
    return seen, sensor.photo_spacing_m(height_m, course_rad)


def _seen_by_radar(
    sensor: SarSensor, height_m: float, start: Place, end: Place, look: Look
) -> tuple[Polygon, float | None]:
    return view.seen_on_flat(sensor, (start, end), look, height_m), None


_SWATHS: dict[str, Callable[[Any, float, float, Look], Swath]] = {"camera": _camera, "sar": _radar}
_SEEN: dict[str, Callable[[Any, float, Place, Place, Look], tuple[Polygon, float | None]]] = {
    "camera": _seen_by_camera,
    "sar": _seen_by_radar,
}
