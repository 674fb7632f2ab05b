"""Parallel lanes over a region: where they lie at a heading, and where on them photos are taken.

In axes turned by the heading, a region spans so much across it; as few lanes as its spacing allows lie evenly
over that, half a spacing from its edges. Each runs as far as the region does within what the lane sees.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.affinity import rotate
from shapely.geometry import MultiPolygon, Polygon, box

from planner.errors import InfeasibleError
from planner.sensors.camera import CameraSensor

Floats = NDArray[np.float64]

#: Widths equal but for rounding take the same lanes.
ROUNDING_M: Final = 1e-6


def spacing_m(sensor: CameraSensor, height_m: float, angle_rad: float) -> float:
    """Between lanes at a heading; not positive where nothing can be kept."""
    if height_m <= sensor.relief_m or sensor.photo_spacing_m(height_m, angle_rad) <= 0.0:
        return 0.0
    return sensor.lane_spacing_m(height_m, angle_rad)


def lanes_at(area: Polygon | MultiPolygon, sensor: CameraSensor, height_m: float, angle_rad: float) -> Floats:
    """Lines flown at a heading, from right to left, (N, 2, 2), all that way; none without spacing."""
    apart_m = spacing_m(sensor, height_m, angle_rad)
    if apart_m <= 0.0:
        return np.empty((0, 2, 2))
    turned = rotate(area, -angle_rad, origin=(0.0, 0.0), use_radians=True)
    west_m, south_m, east_m, north_m = turned.bounds
    # The outer lanes see to the edges, whatever of their margins is used up.
    edge_m = min(apart_m / 2.0, sensor.half_width_m(height_m, angle_rad))
    inner_m = max(north_m - south_m - 2.0 * edge_m, 0.0)
    gaps = max(math.ceil((inner_m - ROUNDING_M) / apart_m), 0)
    middle_m = (south_m + north_m) / 2.0
    norths = middle_m + inner_m * (np.arange(gaps + 1) / gaps - 0.5 if gaps else np.zeros(1))
    half_m = max(inner_m / gaps / 2.0 if gaps else 0.0, edge_m)
    before_m = sensor.run_in_m(height_m, angle_rad)
    beyond_m = sensor.run_out_m(height_m, angle_rad)
    least_m = sensor.photo_spacing_m(height_m, angle_rad)
    lines = []
    for north in norths:
        seen = turned.intersection(box(west_m, north - half_m, east_m, north + half_m))
        if seen.is_empty:
            continue
        first_m, _, last_m, _ = seen.bounds
        begin_m, end_m = first_m - before_m, last_m + beyond_m
        if end_m - begin_m < least_m:
            middle = (begin_m + end_m) / 2.0
            begin_m, end_m = middle - least_m / 2.0, middle + least_m / 2.0
        lines.append([(begin_m, north), (end_m, north)])
    ahead = np.array(
        [[math.cos(angle_rad), math.sin(angle_rad)], [-math.sin(angle_rad), math.cos(angle_rad)]]
    )
    flown: Floats = np.asarray(lines, dtype=np.float64) @ ahead
    return flown


def fewest_lanes(
    area: Polygon | MultiPolygon, sensor: CameraSensor, height_m: float, angles_rad: Floats
) -> tuple[int, float]:
    """How many lanes a region takes at least, and the widest distance between lanes."""
    points = shapely.get_coordinates(area.convex_hull)
    fewest, widest_m = math.inf, 0.0
    for angle_rad in angles_rad.tolist():
        apart_m = spacing_m(sensor, height_m, angle_rad)
        if apart_m <= 0.0:
            continue
        across_m = float(np.ptp(points @ (-math.sin(angle_rad), math.cos(angle_rad))))
        fewest, widest_m = min(fewest, math.ceil(across_m / apart_m)), max(widest_m, apart_m)
    return (int(max(fewest, 1)), widest_m) if math.isfinite(fewest) else (1, 0.0)


def check_camera(name: str, sensor: CameraSensor, height_m: float) -> None:
    """Refuse a height from which overlaps cannot be kept.

    Raises
    ------
    InfeasibleError
        ``"height"`` not above the ground seen; ``"overlap"`` where the margins leave nothing.
    """
    if height_m <= sensor.relief_m:
        raise InfeasibleError(
            "height",
            name,
            f"{height_m:.0f} m over its mean ground is not above its highest, {sensor.relief_m:.0f} m up",
            "fly higher, or divide the region by height",
        )
    still = sensor.in_wind(0.0, 0.0)
    if spacing_m(still, height_m, 0.0) <= 0.0:
        raise InfeasibleError(
            "overlap",
            name,
            f"the margins of camera {sensor.name}, {sensor.margin_m(height_m):.1f} m to either side, leave "
            f"nothing of its overlaps from {height_m:.0f} m",
            "fly higher, or lower pointing_margin_deg, position_margin_m or the overlaps",
        )
