"""What each kind of sensor sees beside its course, and the passes that see a strip of ground with it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.errors import InfeasibleError
from planner.route import CollectPass, Look
from planner.search.values import Swath
from planner.sensors import camera_view, view
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.sensors.sar import SarSensor
from planner.sensors.strip import strip_on

Floats = NDArray[np.float64]
Place = tuple[float, float]

#: A camera's pass is no shorter than this.
LEAST_PASS_M = 2.0
#: What is seen is told for so many courses, and between them on lines: by passes so much longer than high.
COURSES, LONG = 240, 20.0


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
    _seen: dict[Look, NDArray[np.float64]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

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
        return replace(found, nominal=self._nominal(course_rad, look))

    def _nominal(self, course_rad: float, look: Look) -> Swath:
        """What it sees beside a course with no margin used up, as the judge has it."""
        if look not in self._seen:
            courses = 2.0 * math.pi * np.arange(COURSES + 1) / COURSES
            self._seen[look] = np.array([self.footprint(course, look) for course in courses.tolist()])
        at = COURSES * (course_rad / (2.0 * math.pi) % 1.0)
        low = min(int(at), COURSES - 1)
        table = self._seen[look]
        return Swath(*(table[low] + (at - low) * (table[low + 1] - table[low])).tolist())

    def footprint(self, course_rad: float, look: Look) -> tuple[float, float, float, float]:
        """Edges aside of what a long pass sees, and its run before and behind that on their mean."""
        long_m = LONG * self.height_m
        end = (long_m * math.cos(course_rad), long_m * math.sin(course_rad))
        seen, _ = _SEEN[self.sensor.kind](self.sensor, self.height_m, (0.0, 0.0), end, look)
        along = np.array([math.cos(course_rad), math.sin(course_rad)])
        own = shapely.get_coordinates(seen) @ np.stack([along, [-along[1], along[0]]], axis=1)
        turned = Polygon(own)
        right_m, left_m = float(own[:, 1].min()), float(own[:, 1].max())
        middle_m = float(turned.centroid.x)
        first = turned.intersection(shapely.box(-4.0 * long_m, right_m - 1.0, middle_m, left_m + 1.0))
        last = turned.intersection(shapely.box(middle_m, right_m - 1.0, 5.0 * long_m, left_m + 1.0))
        width_m = left_m - right_m
        return (right_m, left_m, middle_m - first.area / width_m, long_m - middle_m - last.area / width_m)

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
