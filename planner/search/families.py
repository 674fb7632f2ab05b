"""Search patterns as strips of ground, each a middle line in flight order: what manuals of search know.

Names are those of the IAMSAR Manual, vol. II (parallel sweep, creeping line, expanding square, sector), and
the rectangular spiral inwards. Strips are as wide as told; a pattern over ground cut by its own edges has the
parts of a strip one after the other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate
from shapely.geometry import MultiPolygon, Polygon, box
from shapely.geometry.base import BaseGeometry

Floats = NDArray[np.float64]
Ground = Polygon | MultiPolygon

FAMILIES = ("parallel", "creeping", "spiral", "square", "sector")
#: Strips shorter than this are left out.
LEAST_M = 1.0
#: Legs of a sector search are turned by this much, and it has so many triangles.
SECTOR_RAD, TRIANGLES = math.radians(120.0), 9


@dataclass(frozen=True, slots=True)
class Pattern:
    """Strips in flight order.

    Parameters
    ----------
    family
        ``parallel``, ``creeping``, ``spiral``, ``square``, ``sector``.
    strips
        Middle lines, shape (N, 2, 2): strip, first and last place.
    """

    family: str
    strips: Floats

    def reversed(self) -> Pattern:
        """The same flown from its end."""
        return Pattern(self.family, self.strips[::-1, ::-1])


def lanes(ground: Ground, angle_rad: float, width_m: float) -> Floats:
    """Strips to and fro across the heading, evenly apart, no more than a width."""
    turned = rotate(ground, -angle_rad, origin=(0.0, 0.0), use_radians=True)
    west_m, south_m, east_m, north_m = turned.bounds
    count = max(1, math.ceil((north_m - south_m) / width_m - 1e-6))
    step_m = (north_m - south_m) / count
    found: list[tuple[tuple[float, float], tuple[float, float]]] = []
    for k in range(count):
        low_m = south_m + k * step_m
        band = shapely.intersection(turned, box(west_m, low_m, east_m, low_m + step_m))
        spans = _spans(band)
        middle_m = low_m + 0.5 * step_m
        row = [((first_m, middle_m), (last_m, middle_m)) for first_m, last_m in spans]
        found += row if k % 2 == 0 else [(end, start) for start, end in reversed(row)]
    return _back(found, angle_rad)


def spiral(ground: Ground, width_m: float, angle_rad: float, left: bool) -> Floats:
    """Sides of the rectangle round the ground at a heading, inwards to its middle."""
    west_m, south_m, east_m, north_m = rotate(ground, -angle_rad, origin=(0.0, 0.0), use_radians=True).bounds
    rings = max(1, math.ceil(min(east_m - west_m, north_m - south_m) / (2.0 * width_m) - 1e-6))
    step_m = min(east_m - west_m, north_m - south_m) / (2.0 * rings)
    found: list[tuple[tuple[float, float], tuple[float, float]]] = []
    for k in range(rings):
        in_m = (k + 0.5) * step_m
        w, s, e, n = west_m + in_m, south_m + in_m, east_m - in_m, north_m - in_m
        if e - w < LEAST_M and n - s < LEAST_M:
            break
        # The last side ends a step short, where the next ring begins.
        corners = [(w, s), (e, s), (e, n), (w, n), (w, min(s + step_m, n))]
        if left:
            found += list(pairwise(corners))
        else:
            mirrored = [(w + e - x, y) for x, y in corners]
            found += list(pairwise(mirrored))
    return _back([pair for pair in found if math.dist(*pair) >= LEAST_M], angle_rad)


def sector(centre: tuple[float, float], radius_m: float, angle_rad: float) -> Floats:
    """Legs through a datum, 120° turned one from the next, one set of triangles beside the other."""
    found = []
    first_rad = angle_rad
    for _ in range(TRIANGLES // 3):
        heading_rad = first_rad
        for _ in range(3):
            ahead = radius_m * np.array([math.cos(heading_rad), math.sin(heading_rad)])
            found.append((tuple(np.array(centre) - ahead), tuple(np.array(centre) + ahead)))
            heading_rad += SECTOR_RAD
        first_rad += SECTOR_RAD / (TRIANGLES / 3.0)
    return np.array(found)


def patterns(
    ground: Ground, width_m: float, headings_rad: Floats, datum: tuple[float, float]
) -> Iterator[Pattern]:
    """Every family at the headings, flown from either end.

    Parameters
    ----------
    datum
        Where the ground is worth most: the middle of expanding squares and sectors.
    """
    long_rad = _long_axis_rad(ground)
    for angle_rad in headings_rad.tolist():
        strips = lanes(ground, angle_rad, width_m)
        along = abs(math.remainder(angle_rad - long_rad, math.pi)) <= math.pi / 4.0
        family = "parallel" if along else "creeping"
        if len(strips):
            # To and fro, from either side, each lane first one way or the other.
            for laid in (Pattern(family, strips), Pattern(family, strips[:, ::-1])):
                yield laid
                yield laid.reversed()
    for angle_rad in (long_rad, long_rad + math.pi / 2.0):
        for turned_rad in (angle_rad, angle_rad + math.pi):
            for left in (True, False):
                inward = Pattern("spiral", spiral(ground, width_m, turned_rad, left))
                if len(inward.strips):
                    yield inward
                    yield Pattern("square", inward.reversed().strips)
    west_m, south_m, east_m, north_m = ground.bounds
    radius_m = 0.5 * min(east_m - west_m, north_m - south_m)
    for angle_rad in headings_rad[::3].tolist():
        yield Pattern("sector", sector(datum, radius_m, angle_rad))


def _long_axis_rad(ground: Ground) -> float:
    """Direction of the longer side of the least rectangle round the ground."""
    around = shapely.minimum_rotated_rectangle(ground)
    corners = shapely.get_coordinates(around)
    if len(corners) < 4:
        return 0.0
    sides = np.diff(corners[:3], axis=0)
    longer = sides[int(np.argmax(np.hypot(*sides.T)))]
    return math.atan2(longer[1], longer[0])


def _spans(band: BaseGeometry) -> list[tuple[float, float]]:
    """From where to where along it each part of a band reaches, those that overlap together."""
    ends = sorted(
        (part.bounds[0], part.bounds[2])
        for part in shapely.get_parts(band)
        if isinstance(part, Polygon) and part.area > 0.0
    )
    merged: list[tuple[float, float]] = []
    for first_m, last_m in ends:
        if merged and first_m <= merged[-1][1] + LEAST_M:
            merged[-1] = (merged[-1][0], max(merged[-1][1], last_m))
        else:
            merged.append((first_m, last_m))
    return [span for span in merged if span[1] - span[0] >= LEAST_M]


def _back(found: list[tuple[tuple[float, float], tuple[float, float]]], angle_rad: float) -> Floats:
    """Lines in turned axes back in the local frame, (N, 2, 2)."""
    if not found:
        return np.empty((0, 2, 2))
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    lines: Floats = np.array(found) @ np.array([[cos, sin], [-sin, cos]])
    return lines
