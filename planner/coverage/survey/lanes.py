"""Lanes of photos over a region at a heading: how many, where, and from where to where.

In axes turned by the heading θ, x̂ ahead and ŷ to the left, a region spans w across. Each lane answers for the
ground within half a spacing d of it, so that n = ⌈w / d⌉ lanes do, and its first and last photos lie half an
interval inside. Every place of the region, edges included, then lies as near to the middle of a photo as one
between lanes and photos does, so that overlaps hold everywhere. What n lanes have to spare, s = n·d − w, is
taken from their distances and from what the outer ones see beyond the edges.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.strips.classify import ROUNDING_M, hull_points, spans_at
from planner.coverage.strips.kernels import strip_extents
from planner.coverage.survey.frame import Frames, frames, runs_m
from planner.sensors.camera import CameraSensor

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Headings that leave hardly any spacing take no more lanes than this.
MOST_LANES = 2000
#: Each lane is flown onward, at the heading, or back.
STATES = 2


@dataclass(frozen=True, slots=True)
class Survey:
    """Ground to be seen with a camera from a height over it.

    Parameters
    ----------
    ground
        What lanes are laid over.
    wanted
        What of it is to be seen; the rest is flown over.
    """

    ground: Polygon
    wanted: BaseGeometry
    camera: CameraSensor
    height_m: float

    def frames(self, angles_rad: Floats) -> Frames:
        """The camera's figures at headings."""
        return frames(self.camera, self.height_m, angles_rad)

    def across_m(self, angles_rad: Floats) -> Floats:
        """The ground's width across headings."""
        return spans_at(hull_points(self.ground), angles_rad).across_m

    def counts(self, angles_rad: Floats) -> Ints:
        """How many lanes each heading takes."""
        across_m = self.across_m(angles_rad)
        spacing_m = np.maximum(self.frames(angles_rad).spacing_m, across_m / MOST_LANES)
        return np.maximum(np.ceil((across_m - ROUNDING_M) / spacing_m), 1.0).astype(np.int64)


@dataclass(frozen=True, slots=True)
class Lanes:
    """Lanes at several headings with equally many of them, and several offsets.

    Parameters
    ----------
    headings_rad
        Of each state, shape (M, 2): onward and back.
    lines
        Shape (M, K, N, 2, 2, 2): heading, offset, lane from right to left, state, start and end.
    low_m, high_m
        ŷ of the edges of the strip that each lane answers for, (M, K, N).
    """

    headings_rad: Floats
    lines: Floats
    low_m: Floats
    high_m: Floats


def lanes_at(survey: Survey, angles_rad: Floats, etas: Floats, count: int) -> Lanes:
    """Lanes at headings (M,) that all take ``count`` of them, and at offsets η (K,).

    η is the part of what the outer lanes can spare beyond the edges that they do: at 0 lanes are as far apart
    as can be, at 1 the outer ones as far inside.
    """
    laid = survey.frames(angles_rad)
    spans = spans_at(hull_points(survey.ground), angles_rad)
    places_m = _places(laid, spans.y_min_m, spans.y_max_m, etas, count)
    between_m = (places_m[..., 1:] + places_m[..., :-1]) / 2.0
    edge = (len(angles_rad), len(etas), 1)
    low_m = np.concatenate([np.broadcast_to(spans.y_min_m[:, None, None], edge), between_m], axis=2)
    high_m = np.concatenate([between_m, np.broadcast_to(spans.y_max_m[:, None, None], edge)], axis=2)
    extent_m = strip_extents(edges_of(survey.ground), angles_rad, low_m, high_m)
    states, headings = [], []
    for way in (1, -1):
        courses_rad = angles_rad if way == 1 else angles_rad + math.pi
        run_in_m, run_out_m = (run[:, None, None] for run in _runs(survey, courses_rad))
        first_m, last_m = (extent_m[..., 0], extent_m[..., 1])[::way]
        x_m = np.stack([first_m - way * run_in_m, last_m + way * run_out_m], axis=-1)
        x_m = _at_least(x_m, way, laid.photos_m[:, None, None])
        cos, sin = np.cos(angles_rad)[:, None, None, None], np.sin(angles_rad)[:, None, None, None]
        east_m = cos * x_m - sin * places_m[..., None]
        north_m = sin * x_m + cos * places_m[..., None]
        states.append(np.stack([east_m, north_m], axis=-1))
        headings.append(courses_rad)
    return Lanes(np.stack(headings, axis=1), np.stack(states, axis=3), low_m, high_m)


def pieces_m(
    survey: Survey, lanes: Lanes, lane: int, state: int, line: Floats, least_gap_m: float
) -> list[Floats]:
    """Parts of a lane at the first heading and offset with photos, in flight order: gaps left out.

    Parameters
    ----------
    line
        The lane in its state, (2, 2).
    least_gap_m
        Gaps without ground that are shorter are photographed, too.
    """
    angle_rad, course_rad = float(lanes.headings_rad[0, 0]), float(lanes.headings_rad[0, state])
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    turned = shapely.transform(survey.wanted, lambda p: p @ np.array([[cos, -sin], [sin, cos]]))
    west_m, _, east_m, _ = turned.bounds
    strip = shapely.box(west_m - 1.0, lanes.low_m[0, 0, lane], east_m + 1.0, lanes.high_m[0, 0, lane])
    bounds = shapely.bounds(shapely.get_parts(shapely.intersection(turned, strip)))
    if len(bounds) == 0:
        return [line]
    run_in_m, run_out_m = (float(run[0]) for run in _runs(survey, np.array([course_rad])))
    unit = np.array([cos, sin]) * (1.0 if state == 0 else -1.0)
    along_m = np.sort(bounds[:, [0, 2]] * (1.0 if state == 0 else -1.0), axis=1)
    spans = along_m[np.argsort(along_m[:, 0])] + np.array([-run_in_m, run_out_m])
    photos_m = float(survey.frames(np.array([angle_rad])).photos_m[0])
    begin_m, end_m = (float(end @ unit) for end in line)
    joined: list[list[float]] = []
    for first, last in spans.tolist():
        if last - first < photos_m:
            first, last = (first + last - photos_m) / 2.0, (first + last + photos_m) / 2.0
        if joined and first - joined[-1][1] < least_gap_m:
            joined[-1][1] = max(joined[-1][1], last)
        else:
            joined.append([first, last])
    joined[0][0], joined[-1][1] = begin_m, end_m
    return [line[0] + (np.array(piece)[:, None] - begin_m) * unit for piece in joined]


def edges_of(ground: Polygon) -> Floats:
    """Both ends of each edge of its outline, (E, 4)."""
    ring = np.asarray(shapely.get_coordinates(ground.exterior), dtype=np.float64)
    return np.concatenate([ring[:-1], ring[1:]], axis=1)


def _places(laid: Frames, low_m: Floats, high_m: Floats, etas: Floats, count: int) -> Floats:
    """ŷ of lanes, (M, K, N)."""
    across_m = high_m - low_m
    spare_m = np.maximum(count * laid.spacing_m - across_m, 0.0)
    if count == 1:
        middle_m = (low_m + high_m)[:, None] / 2.0 + (etas[None, :] - 0.5) * spare_m[:, None]
        return middle_m[:, :, None]
    # Where there is enough to spare, the outer lanes run where their places are seen from the next one, too.
    least_m = (across_m - (count - 1) * laid.spacing_m) / 2.0
    most_m = np.maximum(least_m, np.minimum(laid.spacing_m / 2.0, laid.twice_m))
    inset_m = least_m[:, None] + etas[None, :] * (most_m - least_m)[:, None]
    step_m = (across_m[:, None] - 2.0 * inset_m) / (count - 1)
    return (low_m[:, None] + inset_m)[:, :, None] + step_m[:, :, None] * np.arange(count)


def _runs(survey: Survey, courses_rad: Floats) -> tuple[Floats, Floats]:
    return runs_m(survey.camera, survey.height_m, courses_rad)


def _at_least(x_m: Floats, way: int, least_m: Floats) -> Floats:
    """Lanes (…, 2) no shorter than this, lengthened at both ends: a photo's interval at least."""
    short_m = np.maximum(least_m - way * (x_m[..., 1] - x_m[..., 0]), 0.0) / 2.0
    return x_m + way * np.stack([-short_m, short_m], axis=-1)
