"""What a flight over an area comes to: length, turns, overlap, coverage, time (section 4 of the paper)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import Place, UrbanArea
from planner.coverage.urban.free import FreeSpace

Floats = NDArray[np.float64]

#: A corner that turns less is none.
LEAST_TURN_RAD = math.radians(1.0)


@dataclass(frozen=True, slots=True)
class Sweep:
    """A footprint sweep F_i = (a_i, b_i), flown in this direction (eq. 2)."""

    start: Place
    end: Place

    @property
    def length_m(self) -> float:
        """Of the line flown."""
        return math.dist(self.start, self.end)

    @property
    def midpoint(self) -> Place:
        """The midpoint m_i (section 3.4)."""
        return ((self.start[0] + self.end[0]) / 2.0, (self.start[1] + self.end[1]) / 2.0)

    def reversed(self) -> Sweep:
        """The same flown the other way."""
        return Sweep(self.end, self.start)

    def seen(self, width_m: float, ahead_m: float) -> Polygon:
        """Ground below it: ``width_m`` across, and as far as a frame looks beyond its ends."""
        along = np.subtract(self.end, self.start)
        length_m = float(np.hypot(*along))
        unit = along / length_m if length_m > 0.0 else np.array([1.0, 0.0])
        side = np.array([-unit[1], unit[0]]) * width_m / 2.0
        first, last = np.asarray(self.start) - unit * ahead_m, np.asarray(self.end) + unit * ahead_m
        return Polygon([first - side, last - side, last + side, first + side])


@dataclass(frozen=True, slots=True)
class Flown:
    """What a method gives.

    Parameters
    ----------
    sweeps
        In the order, and the direction, that they are flown in.
    line
        The whole flight from start to end, (N, 3): east_m, north_m, metres over the ground. Corners where the
        aircraft turns on the spot; curves are sampled.
    turns
        How often it turns; None where each corner of the line is one.
    """

    sweeps: tuple[Sweep, ...]
    line: Floats
    turns: int | None = None


@dataclass(frozen=True, slots=True)
class Measures:
    """What section 4 compares methods by.

    Parameters
    ----------
    length_m
        Of the whole line, start to end.
    sweep_m, sweeps
        Of the sweeps alone, and how many there are.
    turns
        Corners, or arcs.
    overlap_m
        Metres of sweep over ground that others see too: the seen area counted once for each sweep, less that
        of their union, over F_w. The paper gives metres, and no formula.
    coverage
        Part of the free ground that can be reached and is seen: the paper's C_ratio.
    duration_s
        Of the flight.
    """

    length_m: float
    sweep_m: float
    sweeps: int
    turns: int
    overlap_m: float
    coverage: float
    duration_s: float


def measure(urban: UrbanArea, free: FreeSpace, flown: Flown) -> Measures:
    """The measures of a flight. A frame sees half its length beyond both ends of a sweep."""
    turns = corners(flown.line) if flown.turns is None else flown.turns
    length_m = line_m(flown.line)
    stops_s = turns * urban.stop_s if urban.turn_radius_m == 0.0 else 0.0
    return Measures(
        length_m=length_m,
        sweep_m=sum(sweep.length_m for sweep in flown.sweeps),
        sweeps=len(flown.sweeps),
        turns=turns,
        overlap_m=overlap_m(flown.sweeps, free.ground, urban.width_m),
        coverage=coverage(flown.sweeps, free.ground, urban.width_m, urban.length_m / 2.0),
        duration_s=length_m / urban.speed_m_s + stops_s,
    )


def line_m(line: Floats) -> float:
    """Length of a line in three dimensions."""
    return float(np.sqrt((np.diff(line, axis=0) ** 2).sum(axis=1)).sum())


def corners(line: Floats) -> int:
    """How many corners a line has, seen from above or from the side."""
    steps = np.diff(line, axis=0)
    lengths = np.sqrt((steps**2).sum(axis=1))
    steps = steps[lengths > 1e-6] / lengths[lengths > 1e-6, None]
    if len(steps) < 2:
        return 0
    cosines = np.clip((steps[1:] * steps[:-1]).sum(axis=1), -1.0, 1.0)
    return int((np.arccos(cosines) > LEAST_TURN_RAD).sum())


def overlap_m(sweeps: Sequence[Sweep], ground: BaseGeometry, width_m: float) -> float:
    """Metres of sweep over free ground that another sweep sees."""
    shapes = [shapely.intersection(sweep.seen(width_m, 0.0), ground) for sweep in sweeps]
    each_m2 = sum(shape.area for shape in shapes)
    return float(max(each_m2 - shapely.union_all(shapes, grid_size=1e-6).area, 0.0)) / width_m


def coverage(sweeps: Sequence[Sweep], ground: BaseGeometry, width_m: float, ahead_m: float) -> float:
    """Part of the ground that sweeps see."""
    seen = shapely.union_all([sweep.seen(width_m, ahead_m) for sweep in sweeps], grid_size=1e-6)
    return float(shapely.intersection(seen, ground).area / ground.area)
