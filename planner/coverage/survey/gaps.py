"""Where lanes cross what is not to be seen: photos are taken on the parts over ground that is."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.coverage.survey.frame import lengthened_m
from planner.coverage.survey.lanes import LINE_M, STATES, Lanes, Survey

Floats = NDArray[np.float64]


def photographed(
    survey: Survey, lanes: Lanes, order: NDArray[np.int64], least_gap_m: float
) -> list[list[Floats]]:
    """Of lanes at one heading and offset, in flight order, the parts (2, 2) with photos.

    Parameters
    ----------
    order
        2 · lane + state of each.
    least_gap_m
        Gaps that are shorter are photographed, too.
    """
    angle_rad = float(lanes.headings_rad[0, 0])
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    turned = shapely.transform(survey.wanted, lambda p: p @ np.array([[cos, -sin], [sin, cos]]))
    west_m, _, east_m, _ = turned.bounds
    places_m = lanes.lines[0, 0, :, 0, 0] @ np.array([-sin, cos])
    laid = survey.frames(lanes.headings_rad[0, :1])
    # What else a lane sees it may have to stand in for.
    half_m, photos_m = float(laid.half_m[0]), float(laid.photos_m[0])
    low_m = np.stack([places_m - LINE_M, lanes.low_m[0, 0], places_m - half_m])
    high_m = np.stack([places_m + LINE_M, lanes.high_m[0, 0], places_m + half_m])
    west, east = np.full_like(low_m, west_m - 1.0), np.full_like(low_m, east_m + 1.0)
    strips = shapely.box(west, low_m, east, high_m)
    parts, index = shapely.get_parts(shapely.intersection(turned, strips).ravel(), return_index=True)
    kept = ~shapely.is_empty(parts)
    x_m = shapely.bounds(parts[kept])[:, [0, 2]]
    kind, lane = np.divmod(index[kept], len(places_m))
    laid = survey.frames(lanes.headings_rad[0, :1])
    photos_m, least_m = float(laid.photos_m[0]), float(laid.least_m[0])
    runs_m = []
    for course_rad in lanes.headings_rad[0]:
        run = survey.runs(np.array([course_rad]))
        in_m = np.concatenate([run.line_in_m, run.beside_in_m, run.other_in_m])
        runs_m.append((in_m, np.concatenate([run.line_out_m, run.beside_out_m, run.other_out_m])))
    found = []
    for number in order.tolist():
        at, state = divmod(number, STATES)
        way = 1.0 if state == 0 else -1.0
        own, (in_m, out_m) = lane == at, runs_m[state]
        along_m = np.sort(way * x_m[own], axis=1)
        spans_m = np.column_stack([along_m[:, 0] - in_m[kind[own]], along_m[:, 1] + out_m[kind[own]]])
        found.append(_cut(lanes.lines[0, 0, at, state], spans_m, photos_m, least_m, least_gap_m))
    return found


def _cut(line: Floats, spans_m: Floats, photos_m: float, least_m: float, least_gap_m: float) -> list[Floats]:
    """The parts of a line within spans along it, from its own beginning to its own end."""
    unit = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))
    begin_m, end_m = (float(end @ unit) for end in line)
    joined: list[list[float]] = []
    for first, last in sorted(spans_m.tolist()):
        first, last = max(first, begin_m), min(last, end_m)
        if last <= first:
            # What lies beyond its ends its neighbours see.
            continue
        short_m = max(photos_m - (last - first), 0.0) / 2.0
        first, last = first - short_m, last + short_m
        if joined and first - joined[-1][1] < least_gap_m:
            joined[-1][1] = max(joined[-1][1], last)
        else:
            joined.append([first, last])
    if not joined:
        return [line]
    joined[0][0], joined[-1][1] = begin_m, end_m
    for k, piece in enumerate(joined[:-1]):
        # Into the gap: the line's own ends stay.
        piece[1] += _longer_m(piece, photos_m, least_m)
        if k == len(joined) - 2:
            joined[-1][0] -= _longer_m(joined[-1], photos_m, least_m)
    return [line[0] + (np.array(piece)[:, None] - begin_m) * unit for piece in joined]


def _longer_m(piece: list[float], photos_m: float, least_m: float) -> float:
    length_m, photos, least = (np.array([value]) for value in (piece[1] - piece[0], photos_m, least_m))
    return float(lengthened_m(length_m, photos, least)[0])
