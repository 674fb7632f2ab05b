"""What laying lanes needs to know of a camera's photos, at headings and from a height."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.sensors.camera import TWICE, CameraSensor

Floats = NDArray[np.float64]

#: Lanes are longer by this at either end than they have to be.
SPARE_M = 0.01
#: Lengths equal but for rounding take the same photos.
ROUNDING_M = 1e-6
#: A length that a height and a heading give.
Figure = Callable[[float, float], float]


@dataclass(frozen=True, slots=True)
class Frames:
    """A camera's figures at headings, (M,) each, metres.

    Parameters
    ----------
    spacing_m
        Between lanes at most; not more than 0 where no lanes keep the overlap.
    half_m
        How far to either side of a lane all is seen.
    inset_m
        How far inside a region's edge the outermost lane may run: half a spacing, and no farther than it sees
        the edge; where lanes overlap by half or more a spacing, and no farther than the next one sees it; a
        spacing, and no farther than it sees the edge itself, where the overlap need not be kept there.
    photos_m, least_m
        Between photos at most, and at least for the camera to take them.
    """

    spacing_m: Floats
    half_m: Floats
    inset_m: Floats
    photos_m: Floats
    least_m: Floats

    @property
    def good(self) -> NDArray[np.bool_]:
        """At which headings lanes keep the overlaps, and the camera the time."""
        kept = (self.spacing_m > 0.0) & (self.photos_m > 0.0) & (self.least_m <= self.photos_m)
        return np.asarray(kept, dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class Runs:
    """How far before ground lanes flown at headings begin, and how far beyond it they end, (M,) each, metres.

    Parameters
    ----------
    line_in_m, line_out_m
        Ground on the lane's own line.
    beside_in_m, beside_out_m
        Ground that the lane answers for: in two of its photos where they overlap by half or more.
    other_in_m, other_out_m
        Ground that its neighbours answer for, in its first or last photo.
    """

    line_in_m: Floats
    line_out_m: Floats
    beside_in_m: Floats
    beside_out_m: Floats
    other_in_m: Floats
    other_out_m: Floats


def frames(camera: CameraSensor, height_m: float, angles_rad: Floats) -> Frames:
    """The figures for lanes flown to and fro: the lesser of both ways."""

    def lesser(figure: Figure) -> Floats:
        ways = (angles_rad, angles_rad + math.pi)
        return np.minimum(*(_each(camera, figure, height_m, way_rad) for way_rad in ways))

    spacing_m, half_m = lesser(camera.lane_spacing_m), lesser(camera.half_width_m)
    # What one lane alone sees counts as if the next were as far from it on the other side.
    beside_m = half_m - spacing_m if camera.side_overlap >= TWICE else np.minimum(half_m, spacing_m / 2.0)
    if not camera.edge_overlap:
        beside_m = half_m
    least_m = -lesser(lambda _, angle_rad: -camera.least_spacing_m(angle_rad))
    photos_m = lesser(camera.photo_spacing_m)
    return Frames(spacing_m, half_m, np.minimum(spacing_m, beside_m), photos_m, least_m)


def runs(camera: CameraSensor, height_m: float, angles_rad: Floats) -> Runs:
    """Runs of lanes flown at headings (M,)."""

    def each(figure: Figure) -> Floats:
        return _each(camera, figure, height_m, angles_rad)

    line = (each(camera.run_in_m), each(camera.run_out_m))
    seen = (each(camera.seen_in_m), each(camera.seen_out_m))
    beside = (each(camera.kept_in_m), each(camera.kept_out_m))
    if not camera.edge_overlap:
        interval_m = each(camera.photo_spacing_m)
        line, beside = (np.maximum(seen[0], -interval_m), np.maximum(seen[1], -interval_m)), seen
    return Runs(*(run_m + SPARE_M for run_m in (*line, *beside, *seen)))


def lengthened_m(length_m: Floats, photos_m: Floats, least_m: Floats) -> Floats:
    """By how much lanes are to be longer for photos at equal distances, neither too wide nor too close."""
    gaps = np.maximum(np.ceil((length_m - ROUNDING_M) / photos_m), 1.0)
    return np.asarray(np.maximum(gaps * least_m - length_m, 0.0), dtype=np.float64)


def _each(camera: CameraSensor, figure: Figure, height_m: float, angles_rad: Floats) -> Floats:
    if not camera.crabs:
        return np.full(len(angles_rad), figure(height_m, 0.0))
    return np.array([figure(height_m, angle_rad) for angle_rad in angles_rad.tolist()], dtype=np.float64)
