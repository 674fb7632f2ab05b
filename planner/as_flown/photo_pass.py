"""The photos of one pass: those taken beside those planned, and how far they overlap."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.as_flown.passes import PlannedPass
from planner.plan import Photos

Floats = NDArray[np.float64]

#: Further apart than this times the interval: a photo is missing between two.
MISSING_PART = 1.5
#: Lanes next to each other run within this of parallel; so many to either side are looked at.
PARALLEL_RAD, NEIGHBOURS = math.radians(10.0), 2
#: Of each pass side overlaps are measured at so many photos at most.
MOST_MEASURED = 60


@dataclass(frozen=True, slots=True)
class PhotoPass:
    """The photos of one collect.

    Parameters
    ----------
    planned, taken
        How many; ``lost`` where they are missing: from and to along the collect, and how many.
    untold
        How many more the camera counted than it told of.
    """

    vehicle: str
    seq: int
    roi: str
    sensor: str
    planned: int
    taken: int
    lost: tuple[tuple[float, float, int], ...]
    untold: int

    @property
    def missing(self) -> int:
        """How many are missing."""
        return sum(count for _, _, count in self.lost)


@dataclass(frozen=True, slots=True)
class Taken:
    """Photos of one pass in order along it.

    Parameters
    ----------
    along_m
        Along the collect, (N,).
    index
        In the camera's count; NaN where untold, (N,).
    corners
        On the ground, (N, 4, 2); see ``photo.outlines``.
    """

    along_m: Floats
    index: Floats
    corners: Floats

    @classmethod
    def joined(cls, parts: Sequence[Taken]) -> Self:
        """Photos of several flights of one pass, in order along it."""
        along_m = np.concatenate([np.zeros(0), *(part.along_m for part in parts)])
        index = np.concatenate([np.zeros(0), *(part.index for part in parts)])
        corners = np.concatenate([np.zeros((0, 4, 2)), *(part.corners for part in parts)])
        order = np.argsort(along_m, kind="stable")
        return cls(along_m[order], index[order], corners[order])


def photo_pass(planned: PlannedPass, photos: Photos, taken: Taken, reported: bool) -> PhotoPass:
    """What was taken of what was planned; of an autopilot that reports no photos nobody knows of losses."""
    interval_m = photos.interval_m
    at_m = np.concatenate([[-interval_m], taken.along_m, [planned.length_m + interval_m]])
    lost = []
    for k, gap_m in enumerate(np.diff(at_m).tolist() if reported else []):
        count = round(gap_m / interval_m) - 1
        if gap_m > MISSING_PART * interval_m and count > 0:
            from_m, to_m = max(float(at_m[k]), 0.0), min(float(at_m[k + 1]), planned.length_m)
            lost.append((from_m, to_m, count))
    collect = planned.collect
    return PhotoPass(
        collect.vehicle,
        collect.seq,
        collect.roi,
        collect.sensor,
        len(photos.places),
        len(taken.along_m),
        tuple(lost),
        sum(count for _, _, count in untold(taken)),
    )


def untold(taken: Taken) -> list[tuple[float, float, int]]:
    """Between which places along a pass the camera counted photos that nobody heard of, and how many."""
    found = []
    for k in range(len(taken.along_m) - 1):
        skipped = taken.index[k + 1] - taken.index[k] - 1.0
        if skipped > 0.0:
            found.append((float(taken.along_m[k]), float(taken.along_m[k + 1]), int(skipped)))
    return found


@dataclass(frozen=True, slots=True)
class Reached:
    """An overlap as reached: the least and the mean of its measurements; None where there is none."""

    least: float | None = None
    mean: float | None = None

    @classmethod
    def of(cls, values: Sequence[float]) -> Reached:
        """Of some measurements."""
        return cls(min(values), sum(values) / len(values)) if values else cls()


def forward_overlaps(taken: Taken, area: BaseGeometry) -> list[float]:
    """Part of each photo that the next sees again, where both see some of an area."""
    prints = _polygons(taken.corners)
    within = shapely.intersects(prints, area)
    pairs = np.flatnonzero(within[:-1] & within[1:])
    if not len(pairs):
        return []
    shared = shapely.area(shapely.intersection(prints[pairs], prints[pairs + 1]))
    return [float(part) for part in shared / np.maximum(shapely.area(prints[pairs]), 1e-9)]


def side_overlaps(
    passes: Mapping[int, PlannedPass], taken: Mapping[int, Taken], area: BaseGeometry
) -> list[float]:
    """Part of each photo's width that the lane beside it sees again, wherever a lane has to be beside it.

    It has to be where the photo's own edge lies within the area.
    """
    strips = {
        row: shapely.union_all(_polygons(photos.corners))
        for row, photos in taken.items()
        if len(photos.along_m)
    }
    found: list[float] = []
    for row, photos in taken.items():
        if row not in strips:
            continue
        beside = _beside(row, passes, list(strips))
        for side, (rear, front) in ((-1, (0, 3)), (1, (1, 2))):
            lanes = [other for other, off_m in beside if off_m * side > 0.0][:NEIGHBOURS]
            shape = shapely.union_all([strips[other] for other in lanes])
            corners = photos.corners[_some(len(photos.along_m))]
            near = (corners[:, rear] + corners[:, front]) / 2.0
            far = (corners[:, 1 - rear] + corners[:, 5 - front]) / 2.0
            needed = ~np.isnan(corners).any(axis=(1, 2)) & shapely.contains_xy(area, near[:, 0], near[:, 1])
            if not needed.any():
                continue
            across = shapely.linestrings(np.stack([near, far], axis=1)[needed])
            shared = shapely.length(shapely.intersection(across, shape))
            found += [float(part) for part in shared / np.maximum(shapely.length(across), 1e-9)]
    return found


def _beside(row: int, passes: Mapping[int, PlannedPass], rows: Sequence[int]) -> list[tuple[int, float]]:
    """Parallel lanes with how far to the right of a pass they lie, the nearest first."""
    mine = passes[row]
    right = np.array([mine.ahead[1], -mine.ahead[0]])
    middle = mine.first + mine.ahead * mine.length_m / 2.0
    found = []
    for other in rows:
        its = passes[other]
        if other == row or abs(float(its.ahead @ mine.ahead)) < math.cos(PARALLEL_RAD):
            continue
        # Beside the pass's middle, along the other lane's own direction.
        off_m = float((its.first - middle) @ right)
        slope = float(its.ahead @ right) / float(its.ahead @ mine.ahead)
        off_m -= slope * float((its.first - middle) @ mine.ahead)
        if abs(off_m) > 1e-6:
            found.append((other, off_m))
    return sorted(found, key=lambda each: abs(each[1]))


def _some(count: int) -> list[int]:
    return [int(k) for k in np.unique(np.linspace(0, count - 1, min(count, MOST_MEASURED)).astype(int))]


def _polygons(corners: Floats) -> NDArray[np.object_]:
    """Photos as polygons; empty where a corner meets no ground."""
    found = np.full(len(corners), Polygon(), dtype=object)
    whole = ~np.isnan(corners).any(axis=(1, 2))
    found[whole] = shapely.polygons(corners[whole])
    return found
