"""A flight as the plan publishes it: vertices with altitude, pieces with an even slope, phases."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.dubins.path import Path
from planner.plan import FlownPath, LonLat, LonLatAlt, PathSegment, Phase
from planner.profile.flight import Flight, Stretch
from planner.profile.lines import cut
from planner.vehicle.model import FlightModel

ToLonLats = Callable[[ArrayLike], tuple[LonLat, ...]]

#: Vertices of the published line on arcs; the contract asks for at most 10 m. Closer on tight ones, so that
#: chords stay near the arc and hardly shorter than it.
MAX_ARC_EDGE_M = 5.0
MAX_ARC_EDGE_RAD = 0.08


def flown_path(
    flight: Flight,
    model: FlightModel,
    energy_wh: float | None,
    lonlats: ToLonLats,
    edge_m: float,
    heading_deg: float | None,
) -> FlownPath:
    """The whole line of one aircraft.

    Parameters
    ----------
    lonlats
        Longitudes and latitudes of local places.
    edge_m
        Longest edge of a straight.
    heading_deg
        Of the take-off, from true north.
    """
    radii = [s.radius_m for s in flight.path.segments if s.kind != "straight"]
    return FlownPath(
        vehicle=model.name,
        line=_line(flight, lonlats, edge_m),
        segments=_segments(flight, lonlats),
        length_m=flight.length_m,
        duration_s=flight.duration_s,
        energy_wh=energy_wh,
        min_turn_radius_m=min(radii) if radii else None,
        phases=tuple(Phase(*phase) for phase in flight.phases()),
        take_off_heading_deg=heading_deg if model.aircraft.type != "multirotor" else None,
    )


def line_between(
    flight: Flight, from_m: float, until_m: float, lonlats: ToLonLats, edge_m: float
) -> tuple[LonLatAlt, ...]:
    """The line between two distances over the ground."""
    points = cut(flight.path, from_m, until_m).sample(_arc_edge_m(flight), edge_m)
    along_m = np.union1d(points[:, 3] + from_m, _knots_between(flight, from_m, until_m))
    places = _places(flight.path, along_m)
    altitudes_m = flight.heights.at(along_m)
    return _with_altitudes(lonlats(places), altitudes_m)


def _line(flight: Flight, lonlats: ToLonLats, edge_m: float) -> tuple[LonLatAlt, ...]:
    """Both ends of every stretch, and what lies between them on arcs and on long straights."""
    rows: list[NDArray[np.float64]] = []
    for stretch in flight.stretches:
        if stretch.segment is None:
            place = stretch.pose.position
            points = np.array([[*place, stretch.start_altitude_m], [*place, stretch.end_altitude_m]])
        else:
            sampled = Path((stretch.segment,)).sample(_arc_edge_m(flight), edge_m)
            part = sampled[:, 3] / max(stretch.ground_m, 1e-12)
            rise_m = stretch.end_altitude_m - stretch.start_altitude_m
            points = np.column_stack([sampled[:, :2], stretch.start_altitude_m + part * rise_m])
        rows.append(points if not rows else points[1:])
    every = np.concatenate(rows)
    return _with_altitudes(lonlats(every[:, :2]), every[:, 2])


def _arc_edge_m(flight: Flight) -> float:
    tightest_m = min(segment.radius_m for segment in flight.path.segments)
    return min(MAX_ARC_EDGE_M, MAX_ARC_EDGE_RAD * tightest_m)


def _with_altitudes(places: tuple[LonLat, ...], altitudes_m: NDArray[np.float64]) -> tuple[LonLatAlt, ...]:
    return tuple(
        (lon, lat, float(altitude_m)) for (lon, lat), altitude_m in zip(places, altitudes_m, strict=True)
    )


def _knots_between(flight: Flight, from_m: float, until_m: float) -> list[float]:
    return [at_m for at_m, _ in flight.heights.knots if from_m < at_m < until_m]


def _places(path: Path, along_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """East and north at distances along a line, in order."""
    ends_m = np.cumsum([segment.length_m for segment in path.segments])
    index = np.minimum(np.searchsorted(ends_m, along_m - 1e-9), len(ends_m) - 1)
    starts_m = np.concatenate([[0.0], ends_m[:-1]])
    return np.array(
        [
            path.segments[k].at(float(at_m - starts_m[k])).position
            for k, at_m in zip(index.tolist(), along_m, strict=True)
        ]
    )


def _segments(flight: Flight, lonlats: ToLonLats) -> tuple[PathSegment, ...]:
    ends = lonlats([s.pose.position for s in flight.stretches] + [flight.path.end.position])
    rows = zip(flight.stretches, flight.starts_m[:-1], pairwise(ends), strict=True)
    return tuple(_segment(stretch, start_m, *pair, lonlats) for stretch, start_m, pair in rows)


def _segment(stretch: Stretch, start_m: float, start: LonLat, end: LonLat, lonlats: ToLonLats) -> PathSegment:
    segment = stretch.segment
    heights = (stretch.start_altitude_m, stretch.end_altitude_m)
    if segment is None:
        return PathSegment("vertical", start, start, start_m, stretch.length_m, None, None, None, *heights)
    if segment.centre is None:
        return PathSegment("straight", start, end, start_m, stretch.length_m, None, None, None, *heights)
    centre = lonlats([segment.centre, segment.start.position])
    turn_deg = abs(math.degrees(segment.turn_rad))
    return PathSegment(
        segment.kind, start, end, start_m, stretch.length_m, segment.radius_m, centre[0], turn_deg, *heights
    )
