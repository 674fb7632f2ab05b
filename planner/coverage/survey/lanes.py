"""Lanes of photos over a region at a heading: how many, where, and from where to where.

In axes turned by the heading θ, x̂ ahead and ŷ to the left, a region spans w across. The outer lanes run e
inside its edges, the others no more than a spacing d apart, n = ⌈(w − 2e) / d⌉ + 1; one does where w ≤ d.
On their own lines the first and the last photo lie as far inside as the edge is still in two, an interval at
most, and half of one where photos overlap by less than half; lanes go farther where ground between two would
not be in two photos of the one and in view of the other. So places at the edges of a region are seen from two
lanes and twice, as those between lanes and photos are. What n lanes have to spare is taken from their
distances or from e. Of a camera that need not keep its overlap at the edges (``edge_overlap``)
each lane answers for the ground halfway to the next one, and the outer ones for all up to the edge.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.strips.classify import ROUNDING_M, hull_points, spans_at
from planner.coverage.strips.kernels import strip_extents
from planner.coverage.survey.ends_kernels import lane_ends
from planner.coverage.survey.frame import Frames, Runs, frames, lengthened_m, runs
from planner.sensors.camera import TWICE, CameraSensor

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Ground on a lane's line is looked for this far beside it.
LINE_M = 1e-3
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
    least
        Lanes at least.
    """

    ground: Polygon
    wanted: BaseGeometry
    camera: CameraSensor
    height_m: float
    least: int = 1

    def frames(self, angles_rad: Floats) -> Frames:
        """The camera's figures at headings."""
        return frames(self.camera, self.height_m, angles_rad)

    def runs(self, courses_rad: Floats) -> Runs:
        """Runs of lanes flown on courses."""
        return runs(self.camera, self.height_m, courses_rad)

    def across_m(self, angles_rad: Floats) -> Floats:
        """The ground's width across headings."""
        return spans_at(hull_points(self.ground), angles_rad).across_m

    def needed(self, angles_rad: Floats, spacing_m: Floats, inset_m: Floats) -> Floats:
        """Lanes that headings take with these figures, not rounded up; inf where none do."""
        across_m = self.across_m(angles_rad) - ROUNDING_M
        good = spacing_m > 0.0
        several = np.full(len(across_m), np.inf)
        np.divide(across_m - 2.0 * inset_m, spacing_m, out=several, where=good)
        lanes = np.where(good & (across_m <= spacing_m), 1.0, np.maximum(several, 0.5) + 1.0)
        return np.maximum(lanes, self.least)

    def counts(self, angles_rad: Floats) -> Ints:
        """How many lanes each heading takes."""
        laid = self.frames(angles_rad)
        needed = self.needed(angles_rad, laid.spacing_m, laid.inset_m)
        return np.ceil(np.minimum(needed, MOST_LANES)).astype(np.int64)


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
    places_m = places_across(laid, spans.y_min_m, spans.y_max_m, etas, count)
    between_m = (places_m[..., 1:] + places_m[..., :-1]) / 2.0
    edge = (len(angles_rad), len(etas), 1)
    low_m = np.concatenate([np.broadcast_to(spans.y_min_m[:, None, None], edge), between_m], axis=2)
    high_m = np.concatenate([between_m, np.broadcast_to(spans.y_max_m[:, None, None], edge)], axis=2)
    cells_m = np.concatenate(
        [np.broadcast_to(spans.y_min_m[:, None, None], edge), places_m,
         np.broadcast_to(spans.y_max_m[:, None, None], edge)], axis=2,
    )  # fmt: skip
    edges = edges_of(survey.ground)
    line_m = strip_extents(edges, angles_rad, places_m - LINE_M, places_m + LINE_M)
    paired = count > 1 and survey.camera.side_overlap >= TWICE and survey.camera.edge_overlap
    if paired:
        low, high = cells_m[..., :-1], cells_m[..., 1:]
        # What lies so near to a lane the one beyond it sees, too.
        seen_m = np.minimum(laid.inset_m, laid.half_m - laid.spacing_m)[:, None, None]
        strips = [(low, high), (low, high - seen_m), (low + seen_m, high)]
    else:
        strips = [(low_m, high_m)]
    beside_m = [strip_extents(edges, angles_rad, *strip) for strip in strips]
    states, headings = [], []
    for way in (1, -1):
        courses_rad = angles_rad if way == 1 else angles_rad + math.pi
        x_m = _ends(line_m, beside_m, survey.runs(courses_rad), way)
        x_m = _at_least(x_m, way, laid.photos_m[:, None, None])
        photos_m, least_m = laid.photos_m[:, None, None], laid.least_m[:, None, None]
        length_m = way * (x_m[..., 1] - x_m[..., 0])
        x_m = _at_least(x_m, way, length_m + lengthened_m(length_m, photos_m, least_m))
        cos, sin = np.cos(angles_rad)[:, None, None, None], np.sin(angles_rad)[:, None, None, None]
        east_m = cos * x_m - sin * places_m[..., None]
        north_m = sin * x_m + cos * places_m[..., None]
        states.append(np.stack([east_m, north_m], axis=-1))
        headings.append(courses_rad)
    return Lanes(np.stack(headings, axis=1), np.stack(states, axis=3), low_m, high_m)


def edges_of(ground: Polygon) -> Floats:
    """Both ends of each edge of its outline, (E, 4)."""
    ring = np.asarray(shapely.get_coordinates(ground.exterior), dtype=np.float64)
    return np.concatenate([ring[:-1], ring[1:]], axis=1)


def places_across(laid: Frames, low_m: Floats, high_m: Floats, etas: Floats, count: int) -> Floats:
    """ŷ of lanes, (M, K, N)."""
    across_m = high_m - low_m
    if count == 1:
        spare_m = np.maximum(laid.spacing_m - across_m, 0.0)
        middle_m = (low_m + high_m)[:, None] / 2.0 + (etas[None, :] - 0.5) * spare_m[:, None]
        return middle_m[:, :, None]
    least_m = np.minimum((across_m - (count - 1) * laid.spacing_m) / 2.0, laid.inset_m)
    # Lanes that are more than there have to be come no nearer than half a spacing.
    most_m = np.maximum(
        least_m, np.minimum(laid.inset_m, (across_m - (count - 1) * laid.spacing_m / 2.0) / 2.0)
    )
    inset_m = least_m[:, None] + etas[None, :] * (most_m - least_m)[:, None]
    step_m = (across_m[:, None] - 2.0 * inset_m) / (count - 1)
    places_m: Floats = (low_m[:, None] + inset_m)[:, :, None] + step_m[:, :, None] * np.arange(count)
    return places_m


def _ends(line_m: Floats, beside_m: Sequence[Floats], run: Runs, way: int) -> Floats:
    """Where lanes begin and end, x̂ (…, 2), for extents (…, 2) of ground on their lines and beside them.

    Parameters
    ----------
    beside_m
        Of what is beside each as its own; or of what is between two, whole and in the parts of ``lane_ends``.
    """
    shape, sides = line_m.shape[:3], []
    for side, (line_out_m, beside_out_m, other_out_m) in enumerate(
        (
            (run.line_in_m, run.beside_in_m, run.other_in_m),
            (run.line_out_m, run.beside_out_m, run.other_out_m),
        )
    ):
        # Both ends of either state as the same question: how far something goes.
        outward = 1.0 if (side == 1) == (way == 1) else -1.0
        column = 1 if outward > 0.0 else 0
        own_m = outward * line_m[..., column] + line_out_m[:, None, None]
        line_back_m = run.line_out_m if side == 0 else run.line_in_m
        back_m = outward * line_m[..., 1 - column] - line_back_m[:, None, None]
        there_m = [outward * each[..., column] for each in beside_m]
        if len(there_m) > 1:
            rows = shape[0] * shape[1]
            whole_m, nearer_m, farther_m = (each.reshape(rows, -1) for each in there_m)
            far_m = lane_ends(
                own_m.reshape(rows, -1),
                back_m.reshape(rows, -1),
                whole_m,
                nearer_m,
                farther_m,
                np.repeat(-beside_out_m, shape[1]),
                np.repeat(-other_out_m, shape[1]),
            ).reshape(shape)
        else:
            far_m = np.maximum(own_m, there_m[0] + beside_out_m[:, None, None])
        sides.append(outward * far_m)
    return np.stack(sides, axis=-1)


def _at_least(x_m: Floats, way: int, least_m: Floats) -> Floats:
    """Lanes (…, 2) no shorter than this, lengthened at both ends: a photo's interval at least."""
    short_m = np.maximum(least_m - way * (x_m[..., 1] - x_m[..., 0]), 0.0) / 2.0
    return x_m + way * np.stack([-short_m, short_m], axis=-1)
