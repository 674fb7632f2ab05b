"""Footprint sweeps fitted into free ground, the footprint as the unit (Majeed and Lee 2019, 3.3 and 3.4).

All here is done with the ground turned so that sweeps run eastward; ``Fitting`` turns them back.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.lanes_kernels import level_pieces
from planner.coverage.urban.measures import Sweep
from planner.coverage.urban.visibility import edges_of

Floats = NDArray[np.float64]

#: Offsets of the first lane that are tried, as parts of F_w.
OFFSETS = np.arange(0.0, 1.0, 0.125)
#: What is left to be seen counts from here on; so do sweeps.
LEAST_M2 = 1e-3
LEAST_SWEEP_M = 1e-3
#: Lanes along the edge of the ground are flown this far inside of it.
EDGE_M = 1e-4
#: Overlays snap to this grid.
GRID_M = 1e-6


@dataclass(frozen=True, slots=True)
class Fitting:
    """The footprint that is fitted.

    Parameters
    ----------
    width_m
        Across the sweep, F_w.
    ahead_m
        How far a frame sees beyond the ends of a sweep: half of F_l. Sweeps run to the edge of free ground,
        as the line "passes from the middle of the ground one" for its whole length (3.4); what a frame sees
        beyond counts for corners that a slanted edge leaves over, not to shorten them.
    """

    width_m: float
    ahead_m: float

    @classmethod
    def of(cls, urban: UrbanArea) -> Fitting:
        """The footprint of an area's camera."""
        return cls(urban.width_m, urban.length_m / 2.0)

    def sweeps(
        self, ground: BaseGeometry, direction_rad: float, within: BaseGeometry | None = None
    ) -> tuple[Sweep, ...]:
        """Sweeps along a direction that see all of the ground, from one side of it to the other.

        Lanes a footprint's width apart, cut where they leave the ground, at the offset that needs the fewest;
        what they leave over between lane and obstacle is seen by sweeps of its own.

        Parameters
        ----------
        within
            Where they may be flown; the ground itself where not given.
        """
        lanes, extras = self.lanes(ground, direction_rad, within)
        return lanes + extras

    def lanes(
        self, ground: BaseGeometry, direction_rad: float, within: BaseGeometry | None = None
    ) -> tuple[tuple[Sweep, ...], tuple[Sweep, ...]]:
        """The same sweeps, lanes and those over what lanes leave apart."""
        turned = _turned(ground, -direction_rad)
        room = turned if within is None else _turned(within, -direction_rad)
        lanes = list(self._chords(turned, self._offset(turned)))
        extras = self._left_over(turned, room, lanes)
        return (
            tuple(_back(line, direction_rad) for line in lanes),
            tuple(_back(line, direction_rad) for line in extras),
        )

    def lanes_needed(self, ground: BaseGeometry, direction_rad: float) -> int:
        """How many pieces of lane a direction cuts the ground into, at its best offset."""
        turned = _turned(ground, -direction_rad)
        return min(len(self._chords(turned, offset)) for offset in self._offsets(turned))

    def _offsets(self, turned: BaseGeometry) -> Iterator[float]:
        """Offsets of the lowest lane over the ground's lowest place that need no more lanes than the span."""
        _, south, _, north = turned.bounds
        fewest = max(math.ceil((north - south) / self.width_m - 1e-9), 1)
        spare_m = fewest * self.width_m - (north - south)
        for part in OFFSETS:
            yield self.width_m / 2.0 - float(part) * spare_m

    def _offset(self, turned: BaseGeometry) -> float:
        return min(self._offsets(turned), key=lambda offset: len(self._chords(turned, offset)))

    def _chords(self, turned: BaseGeometry, offset_m: float) -> Floats:
        """Pieces of lanes within the ground, (K, 2, 2)."""
        edges = edges_of(turned)
        south, north = float(edges[:, 1].min()), float(edges[:, 1].max())
        heights = np.arange(south + offset_m, north + self.width_m / 2.0 - 1e-9, self.width_m)
        # a lane beyond the ground's edge is flown along the edge
        heights = np.clip(heights, south + EDGE_M, north - EDGE_M)
        ends, owners = level_pieces(edges, heights, LEAST_SWEEP_M)
        return np.stack([ends, np.repeat(heights[owners][:, None], 2, axis=1)], axis=2)

    def _left_over(self, turned: BaseGeometry, room: BaseGeometry, lanes: list[Floats]) -> list[Floats]:
        """Sweeps over what lanes do not see."""
        found: list[Floats] = []
        seen = shapely.union_all([self._seen(line) for line in lanes], grid_size=GRID_M)
        waiting = list(shapely.get_parts(shapely.difference(turned, seen, grid_size=GRID_M)))
        while waiting:
            piece = waiting.pop()
            if not isinstance(piece, Polygon) or piece.area < LEAST_M2:
                continue
            line = self._best(piece, room)
            found.append(line)
            waiting.extend(shapely.get_parts(shapely.difference(piece, self._seen(line), grid_size=GRID_M)))
        return found

    def _best(self, piece: Polygon, room: BaseGeometry) -> Floats:
        """The sweep that sees most of a piece, the shortest of those that see as much."""
        west, south, east, north = piece.bounds
        half_m = self.width_m / 2.0
        inside = piece.point_on_surface()
        rank: list[tuple[float, float, Floats]] = []
        for height in (north - half_m, south + half_m, (south + north) / 2.0, inside.y, piece.centroid.y):
            for line in self._through(room, west, east, height):
                left_m2 = shapely.difference(piece, self._seen(line)).area
                rank.append((round(left_m2, 3), float(line[1, 0] - line[0, 0]), line))
            if rank and min(rank, key=lambda each: each[:2])[0] == 0.0:
                break
        own = _extent(LineString([(west, inside.y), (east, inside.y)]).intersection(piece))
        if not rank:
            return own
        left_m2, _, best = min(rank, key=lambda each: each[:2])
        return best if left_m2 < piece.area - LEAST_M2 else own

    def _through(self, room: BaseGeometry, west: float, east: float, height: float) -> Iterator[Floats]:
        """Pieces of a level line within the room and the abscissas asked for."""
        line = LineString([(west, height), (max(east, west + 2.0 * LEAST_SWEEP_M), height)])
        for part in shapely.get_parts(shapely.intersection(line, room)):
            if part.geom_type == "LineString" and part.length > LEAST_SWEEP_M:
                yield _extent(part)

    def _seen(self, line: Floats) -> Polygon:
        (west, south), (east, _) = line
        half_m = self.width_m / 2.0
        seen: Polygon = shapely.box(west - self.ahead_m, south - half_m, east + self.ahead_m, south + half_m)
        return seen


def directions(area: Polygon, ground: MultiPolygon, fitting: Fitting) -> tuple[float, float]:
    """The two axes of the span, the coverage direction first, radians (section 3.3).

    Axes are those of the least rectangle round the area's hull, which is the paper's "approximate regular
    shape" of an irregular area. The direction is "parallel to the maximal span axis and considering the free
    spaces tendency", with no formula for the latter: here the axis along which lanes are cut into fewer
    pieces, and of two that are equal the one of the larger span. On ground without obstacles the larger span
    has the fewer lanes.
    """
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(area.convex_hull))[:3]
    sides = np.diff(corners, axis=0)
    spans_m = np.hypot(sides[:, 0], sides[:, 1])
    angles = [math.atan2(north, east) % math.pi for east, north in sides]
    rank = sorted(
        range(2), key=lambda k: (fitting.lanes_needed(ground, angles[k]), -round(float(spans_m[k]), 3), k)
    )
    return angles[rank[0]], angles[rank[1]]


def _turned(shape: BaseGeometry, angle_rad: float) -> BaseGeometry:
    turned: BaseGeometry = rotate(shape, angle_rad, origin=(0.0, 0.0), use_radians=True)
    return turned


def _extent(line: BaseGeometry) -> Floats:
    """From the western end of a level line to its eastern."""
    west, south, east, _ = line.bounds
    return np.array([[west, south], [east, south]])


def _back(line: Floats, direction_rad: float) -> Sweep:
    cosine, sine = math.cos(direction_rad), math.sin(direction_rad)
    (a, b), (c, d) = line.tolist()
    return Sweep(
        (cosine * a - sine * b, sine * a + cosine * b), (cosine * c - sine * d, sine * c + cosine * d)
    )
