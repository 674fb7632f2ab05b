"""Zigzag baselines of section 5.3.1 of Li, Chen, Wang, Li (2018): flying without planning for the sensor.

All regions are taken as one; a rectangle round them is cut into strips one swath wide, and one lane is flown
along each strip that holds ground to be seen. A side-looking sensor sees the strip from a line beside it: a
lane one way has the strip on its other side than a lane the other way.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.intervals import Interval, collection_length_m, duty_cycle, operating_intervals
from planner.coverage.merge import GRID_M
from planner.route import Point, Terminal
from planner.sensors.sar import SarSensor

Direction = Literal["vertical", "horizontal"]


@dataclass(frozen=True, slots=True)
class Zigzag:
    """A zigzag route of straight lines, as the paper measures it.

    Parameters
    ----------
    waypoints
        float64, shape (N, 2), east_m and north_m: the start, both ends of each lane, the end.
    length_m
        Of the whole line.
    collection_length_m, duty_cycle, on_intervals
        Path length with the sensor on, its part of the whole, and where: begin and end along the path.
    turns
        Turns from one lane to the next.
    footprints
        Ground seen at full resolution, a rectangle for each time the sensor is on.
    """

    waypoints: NDArray[np.float64]
    length_m: float
    collection_length_m: float
    duty_cycle: float
    turns: int
    on_intervals: tuple[Interval, ...]
    footprints: tuple[Polygon, ...]


@dataclass(frozen=True, slots=True)
class _Strip:
    """One swath in axes (across, along): its edges across, and the spans along it that hold ground to see."""

    low_m: float
    high_m: float
    spans_m: tuple[Interval, ...]

    @property
    def first_m(self) -> float:
        return self.spans_m[0][0]

    @property
    def last_m(self) -> float:
        return self.spans_m[-1][1]


@dataclass(frozen=True, slots=True)
class _Lane:
    strip: _Strip
    across_m: float
    from_m: float
    to_m: float


def zigzag(
    areas: Sequence[BaseGeometry],
    sensor: SarSensor,
    height_m: float,
    ends: tuple[Terminal, Terminal],
    direction: Direction,
) -> Zigzag:
    """The shortest zigzag from start to end with lanes north–south or east–west.

    Strips are laid from either edge of the rectangle, the sweep begins at either, and the first lane is flown
    either way: of these eight, by where start and end are, the shortest is taken. Lanes without anything to
    see are left out, and each lane reaches as far as it or the lane next to it needs, half an aperture beyond
    the regions. The operating area and threats are not looked at, as in the paper.

    Parameters
    ----------
    areas
        Of the regions.
    direction
        Of the lanes: ``"vertical"`` is north–south.
    """
    regions = shapely.union_all(list(areas), grid_size=GRID_M)
    swap = direction == "horizontal"
    if swap:
        regions = shapely.transform(regions, _swapped)
    start, end = (_turn(terminal.position, swap) for terminal in ends)
    found: list[tuple[float, int, list[_Lane]]] = []
    for from_high_edge, descending, forward_first in itertools.product((False, True), repeat=3):
        strips = _strips(regions, sensor.swath_m(height_m), from_high_edge)
        strips.sort(key=lambda strip: strip.low_m, reverse=descending)
        lanes = _lanes(strips, sensor, height_m, forward_first, swap)
        found.append((_length_m(_corners(start, lanes, end)), len(found), lanes))
    _, _, lanes = min(found, key=lambda candidate: candidate[:2])
    return _measured(start, lanes, end, sensor, height_m, swap)


def _strips(regions: BaseGeometry, swath_m: float, from_high_edge: bool) -> list[_Strip]:
    across_min, along_min, across_max, along_max = regions.bounds
    count = max(1, math.ceil((across_max - across_min) / swath_m - 1e-9))
    strips = []
    for number in range(count):
        low_m = across_max - (number + 1) * swath_m if from_high_edge else across_min + number * swath_m
        window = shapely.box(low_m, along_min - 1.0, low_m + swath_m, along_max + 1.0)
        inside = shapely.intersection(regions, window, grid_size=GRID_M)
        parts = [part for part in shapely.get_parts(inside) if part.area > 0.0]
        if parts:
            spans_m = operating_intervals((part.bounds[1], part.bounds[3]) for part in parts)
            strips.append(_Strip(low_m, low_m + swath_m, spans_m))
    return strips


def _lanes(
    strips: list[_Strip], sensor: SarSensor, height_m: float, forward_first: bool, swap: bool
) -> list[_Lane]:
    near_m, half_m = sensor.near_m(height_m), _run_in_m(sensor, height_m)
    # Flying forward, which is north or east, the right-hand side lies towards higher across only when north.
    sees_higher_forward = ("right" in sensor.looks) != swap
    lanes = []
    for number, strip in enumerate(strips):
        forward = forward_first == (number % 2 == 0)
        across_m = strip.low_m - near_m if forward == sees_higher_forward else strip.high_m + near_m
        first_m, last_m = strip.first_m, strip.last_m
        # Even lanes end where odd ones begin: the turn is made where both have seen what they must.
        for other, shares_far_end in ((number - 1, not forward), (number + 1, forward)):
            if 0 <= other < len(strips):
                if shares_far_end:
                    last_m = max(last_m, strips[other].last_m)
                else:
                    first_m = min(first_m, strips[other].first_m)
        ends = (first_m - half_m, last_m + half_m)
        lanes.append(_Lane(strip, across_m, *(ends if forward else ends[::-1])))
    return lanes


def _run_in_m(sensor: SarSensor, height_m: float) -> float:
    """Half an aperture and the margins; the paper's sensors look abeam."""
    return replace(sensor, squint_rad=0.0).run_in_m(height_m)


def _corners(start: Point, lanes: list[_Lane], end: Point) -> NDArray[np.float64]:
    corners = [start]
    for lane in lanes:
        corners += [(lane.across_m, lane.from_m), (lane.across_m, lane.to_m)]
    return np.array([*corners, end], dtype=np.float64)


def _length_m(corners: NDArray[np.float64]) -> float:
    return float(np.hypot(*np.diff(corners, axis=0).T).sum())


def _measured(
    start: Point, lanes: list[_Lane], end: Point, sensor: SarSensor, height_m: float, swap: bool
) -> Zigzag:
    corners = _corners(start, lanes, end)
    reached_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
    half_m = _run_in_m(sensor, height_m)
    on: list[Interval] = []
    footprints: list[BaseGeometry] = []
    for number, lane in enumerate(lanes):
        for first_m, last_m in operating_intervals(
            (first_m - half_m, last_m + half_m) for first_m, last_m in lane.strip.spans_m
        ):
            begin_m = (first_m - lane.from_m) if lane.to_m > lane.from_m else (lane.from_m - last_m)
            begin_m += float(reached_m[1 + 2 * number])
            on.append((begin_m, begin_m + last_m - first_m))
            footprints.append(
                shapely.box(lane.strip.low_m, first_m + half_m, lane.strip.high_m, last_m - half_m)
            )
    length_m = float(reached_m[-1])
    if swap:
        corners = _swapped(corners)
        footprints = [shapely.transform(footprint, _swapped) for footprint in footprints]
    intervals = operating_intervals(on)
    return Zigzag(
        corners,
        length_m,
        collection_length_m(intervals),
        duty_cycle(intervals, length_m),
        len(lanes) - 1,
        intervals,
        tuple(footprint for footprint in footprints if isinstance(footprint, Polygon)),
    )


def _swapped(places: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.ascontiguousarray(places[:, ::-1])


def _turn(place: Point, swap: bool) -> Point:
    return (place[1], place[0]) if swap else place
