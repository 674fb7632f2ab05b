"""Ground that may have been seen while nothing was recorded, or nothing told of the sensor: neither seen
nor missed.
"""

from __future__ import annotations

import math
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely import union_all
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.as_flown.passes import PlannedPass, courses, runs
from planner.as_flown.track import Floats, Gap, Line
from planner.frames import LocalFrame

#: Places of a pass are asked for so far apart.
STEP_M = 5.0
#: An aircraft flies no faster than this many times its speed in the wind.
FASTER = 1.2
#: A record of a pass is one flown in its direction, however badly.
ALONG_COSINE = math.cos(math.radians(45.0))


@dataclass(frozen=True, slots=True)
class UnknownPart:
    """A part of a collect, metres along it, that may have been flown in a gap, or with the sensor on."""

    vehicle: str
    seq: int
    start_m: float
    end_m: float


def unknown_parts(
    passes: Sequence[PlannedPass],
    lines: Sequence[Line],
    gaps: Sequence[Gap],
    frame: LocalFrame,
    speed_m_s: float,
    by_photos: Container[str],
) -> tuple[UnknownPart, ...]:
    """Parts of the passes of one aircraft that no record tells of and that gaps left time to fly.

    Parameters
    ----------
    lines
        Everything recorded of the aircraft.
    speed_m_s
        Over the ground, the most it flies.
    by_photos
        Sensors whose photos tell of them, whatever is told of a switch.
    """
    found = []
    told = [(line, courses(line)) for line in lines if len(line.places) > 1]
    for planned in passes:
        count = max(2, math.ceil(planned.length_m / STEP_M) + 1)
        at_m = np.linspace(0.0, planned.length_m, count)
        places = planned.first + at_m[:, None] * planned.ahead
        open_ = np.zeros(count, dtype=bool)
        for gap in gaps:
            open_ |= _within_reach(places, gap, frame, speed_m_s)
        if not open_.any():
            continue
        for line, course in told:
            told_by_photos = planned.collect.sensor in by_photos
            open_ &= ~_recorded(planned, line, course, at_m, line.sensor_told | told_by_photos)
        turns = np.flatnonzero(np.diff(np.concatenate([[0], open_.astype(np.int8), [0]])))
        half_m = (at_m[1] - at_m[0]) / 2.0
        for a, b in zip(turns[::2].tolist(), turns[1::2].tolist(), strict=True):
            start_m, end_m = max(at_m[a] - half_m, 0.0), min(at_m[b - 1] + half_m, planned.length_m)
            found.append(UnknownPart(*planned.key, float(start_m), float(end_m)))
    return tuple(found)


def untold_parts(planned: PlannedPass, line: Line, untold: NDArray[np.bool_]) -> tuple[UnknownPart, ...]:
    """Parts of a pass flown while nothing told whether its sensor worked, or where it looked.

    Parameters
    ----------
    untold
        The places of the line at which it was flown so, (N,).
    """
    found = []
    for run in runs(untold, line):
        # From the last place that was told of to the next one.
        same = [k for k in range(max(run.start - 1, 0), run.stop + 1) if k < len(untold)]
        rows = [k for k in same if line.piece[k] == line.piece[run.start]]
        along_m = np.clip(planned.along_m(line.places[rows]), 0.0, planned.length_m)
        start_m, end_m = float(along_m.min()), float(along_m.max())
        if end_m > start_m:
            found.append(UnknownPart(*planned.key, start_m, end_m))
    return tuple(found)


def _within_reach(places: Floats, gap: Gap, frame: LocalFrame, speed_m_s: float) -> NDArray[np.bool_]:
    """Which places can be flown to and from within a gap."""
    if gap.duration_s is None:
        return np.ones(len(places), dtype=bool)
    reach_m = FASTER * speed_m_s * gap.duration_s + 2.0 * STEP_M
    way_m = np.zeros(len(places))
    for end in gap.places:
        if end is not None:
            way_m += np.hypot(*(places - frame.to_local([end])[0]).T)
    found: NDArray[np.bool_] = way_m <= reach_m
    return found


def _recorded(
    planned: PlannedPass, line: Line, course: Floats, at_m: Floats, told: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Which places of a pass a record tells of: flown beside, in its direction, the sensor told on or off."""
    found = np.zeros(len(at_m), dtype=bool)
    near = (planned.across_m(line.places) <= planned.beside_m) & (course @ planned.ahead >= ALONG_COSINE)
    near &= told
    steps = np.flatnonzero(line.pieces() & near[1:] & near[:-1])
    along_m = planned.along_m(line.places)
    for k in steps.tolist():
        low, high = np.searchsorted(at_m, sorted((along_m[k], along_m[k + 1])))
        found[low : high + 1] |= (at_m[low : high + 1] >= along_m[k] - STEP_M) & (
            at_m[low : high + 1] <= along_m[k + 1]
        )
    return found


def unknown_ground(
    parts: Iterable[UnknownPart],
    passes: Mapping[tuple[str, int], PlannedPass],
    footprints: Mapping[tuple[str, int], BaseGeometry],
    margins_m: Mapping[tuple[str, int], tuple[float, float]],
) -> dict[tuple[str, int], BaseGeometry]:
    """Ground of the planned footprints whose apertures fall into unknown parts, pass by pass.

    Parameters
    ----------
    margins_m
        How far behind and ahead of a place of the line ground is seen from it or from an aperture with it;
        infinite where all of the pass is needed to see any.
    """
    found: dict[tuple[str, int], list[BaseGeometry]] = {}
    for part in parts:
        key = (part.vehicle, part.seq)
        planned, ground, (behind_m, ahead_m) = passes[key], footprints[key], margins_m[key]
        if math.isfinite(behind_m):
            ground = ground.intersection(_band(planned, part.start_m - behind_m, part.end_m + ahead_m))
        found.setdefault(key, []).append(ground)
    return {key: union_all(shapes) for key, shapes in found.items()}


def _band(planned: PlannedPass, from_m: float, until_m: float) -> Polygon:
    """All ground abeam of a part of a line."""
    across = np.array([planned.ahead[1], -planned.ahead[0]])
    wide_m = 1e6
    corners = [
        planned.first + at_m * planned.ahead + aside_m * across
        for at_m, aside_m in ((from_m, -wide_m), (until_m, -wide_m), (until_m, wide_m), (from_m, wide_m))
    ]
    return Polygon(corners)
