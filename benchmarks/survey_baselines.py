"""What other programs make of a survey, written after what they say of themselves: lines flown, in order.

*Fields2Cover* (Mier, Valente, de Bruin, IEEE RA-L 8, 2023): one cell, the heading with the fewest swaths, as
wide as the tool, the first half of one inside the edge, cut where they leave the field; in boustrophedon or
snake order, every other swath out and the others back; joined by Dubins turns. *QGroundControl* (survey items
of its ``.plan`` files): transects a spacing apart on a lattice from the middle of the polygon's bounding box
less half of its larger side and a kilometre, turned about that middle, each from the first to the last of its
crossings with the polygon, lane after lane or every other one out and the others back.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon

from planner.dubins.kernels import dubins_lengths

Floats = NDArray[np.float64]

#: How far QGroundControl flies on beyond transects where its item says nothing else, with multirotors.
QGC_TURNAROUND_M = 10.0
#: QGroundControl adds this to the larger side of the bounding box.
QGC_SLACK_M = 2000.0


def flown_m(lines: Floats, radius_m: float) -> tuple[float, float]:
    """Metres on lines (N, 2, 2) in order, and in the Dubins turns between them."""
    ahead = lines[:, 1] - lines[:, 0]
    angles_rad = np.arctan2(ahead[:, 1], ahead[:, 0])
    leaving = np.column_stack([lines[:, 1], angles_rad])[:-1]
    arriving = np.column_stack([lines[:, 0], angles_rad])[1:]
    turns_m = dubins_lengths(np.ascontiguousarray(leaving), np.ascontiguousarray(arriving), radius_m)
    return float(np.hypot(ahead[:, 0], ahead[:, 1]).sum()), float(turns_m.sum())


def swaths(area: Polygon, angle_rad: float, spacing_m: float) -> list[Floats]:
    """Lines (2, 2) at a heading where they lie inside, a spacing apart, the first half of one inside."""
    ahead, left = _axes(angle_rad)
    corners = shapely.get_coordinates(area.convex_hull)
    low_m, high_m = float((corners @ left).min()), float((corners @ left).max())
    reach_m = 2.0 * area.convex_hull.length
    found: list[Floats] = []
    for y_m in np.arange(low_m + spacing_m / 2.0, high_m + spacing_m / 2.0 - 1e-9, spacing_m):
        line = LineString([y_m * left - reach_m * ahead, y_m * left + reach_m * ahead])
        inside = shapely.get_parts(area.intersection(line))
        pieces = [np.asarray(part.coords) for part in inside if isinstance(part, LineString)]
        found += sorted(pieces, key=lambda piece: float(piece[0] @ ahead))
    return found


def fewest_swaths_rad(area: Polygon, spacing_m: float, step_rad: float = math.radians(1.0)) -> float:
    """The heading, of those a step apart and the edges', with the fewest swaths."""
    edges = np.diff(shapely.get_coordinates(area.exterior), axis=0)
    along_rad = np.mod(np.arctan2(edges[:, 1], edges[:, 0]), math.pi)
    angles_rad = np.concatenate([along_rad, np.arange(0.0, math.pi, step_rad)])
    corners = shapely.get_coordinates(area.convex_hull)
    across_m = [float(np.ptp(corners @ _axes(angle)[1])) for angle in angles_rad.tolist()]
    return float(angles_rad[int(np.argmin(np.ceil(np.array(across_m) / spacing_m - 1e-9)))])


def snake(count: int) -> list[int]:
    """Every other swath out, the others back."""
    return [*range(0, count, 2), *(k for k in range(count - 1, 0, -1) if k % 2 == 1)]


def to_and_fro(lines: Sequence[Floats], order: Sequence[int]) -> Floats:
    """Lines in an order, every second one flown back."""
    return np.array([lines[k][::-1] if flown % 2 else lines[k] for flown, k in enumerate(order)])


def fields2cover(area: Polygon, spacing_m: float, radius_m: float) -> dict[str, tuple[int, float, float]]:
    """By order: how many swaths, metres on them and in turns, from the better of both ends of the first."""
    lines = swaths(area, fewest_swaths_rad(area, spacing_m), spacing_m)
    found = {}
    for name, order in (("boustrophedon", list(range(len(lines)))), ("snake", snake(len(lines)))):
        ways = [flown_m(to_and_fro([line[::step] for line in lines], order), radius_m) for step in (1, -1)]
        found[name] = (len(lines), *min(ways, key=math.fsum))
    return found


def qgc_transects(area: Polygon, azimuth_deg: float, spacing_m: float) -> list[Floats]:
    """A survey item's transects, (2, 2) each, from one side to the other, all in one direction."""
    west_m, south_m, east_m, north_m = area.bounds
    middle = np.array([(west_m + east_m) / 2.0, (south_m + north_m) / 2.0])
    half_m = (max(east_m - west_m, north_m - south_m) + QGC_SLACK_M) / 2.0
    # Drawn northwards, turned clockwise by the grid's angle.
    azimuth_rad = math.radians(azimuth_deg)
    ahead = np.array([math.sin(azimuth_rad), math.cos(azimuth_rad)])
    right = np.array([ahead[1], -ahead[0]])
    found = []
    for x_m in itertools.takewhile(lambda x: x < half_m, itertools.count(-half_m, spacing_m)):
        at = middle + x_m * right
        inside = area.exterior.intersection(LineString([at - half_m * ahead, at + half_m * ahead]))
        met = shapely.get_coordinates(inside)
        if len(met) >= 2:
            along_m = (met - at) @ ahead
            found.append(np.array([at + along_m.min() * ahead, at + along_m.max() * ahead]))
    if len(found) >= 2:
        return found
    inside = area.exterior.intersection(LineString([middle - half_m * ahead, middle + half_m * ahead]))
    along_m = (shapely.get_coordinates(inside) - middle) @ ahead
    return [np.array([middle + along_m.min() * ahead, middle + along_m.max() * ahead])]


def with_turnaround(transects: list[Floats], turnaround_m: float) -> list[Floats]:
    """Transects flown on by so much at both ends before the turn."""
    longer = []
    for line in transects:
        ahead = (line[1] - line[0]) / np.hypot(*(line[1] - line[0]))
        longer.append(np.array([line[0] - turnaround_m * ahead, line[1] + turnaround_m * ahead]))
    return longer


def qgc_item_m(transects: list[Floats], radius_m: float) -> tuple[float, float]:
    """Metres on transects and in turns: lane after lane, or every other one, from either side, the better."""
    ways = [
        flown_m(to_and_fro(lines, order), radius_m)
        for lines in (transects, transects[::-1])
        for order in (list(range(len(lines))), snake(len(lines)))
    ]
    return min(ways, key=math.fsum)


def _axes(angle_rad: float) -> tuple[Floats, Floats]:
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    return ahead, np.array([-ahead[1], ahead[0]])
