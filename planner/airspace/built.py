"""Ground that buildings stand on: nobody flies over it low enough to see it, and none is there to be seen."""

from __future__ import annotations

import shapely
from shapely.geometry import MultiPolygon, Polygon

from planner.airspace.airspace import Airspace, Level
from planner.airspace.shapes import banded_shapes

#: Overlays are done on a grid.
GRID_M = 1e-6


def bare_ground(area: Polygon | MultiPolygon, airspace: Airspace, level: Level) -> Polygon | MultiPolygon:
    """What of an area no obstacle stands on that reaches the flight; all of it where nothing else is left.

    What is flown over is seen on its roof, and what begins above the ground (``base_m``) leaves ground below.
    """
    standing = tuple(obstacle for obstacle in airspace.obstacles if obstacle.base_m <= 0.0)
    alone = Airspace(obstacles=standing, clearance_m=airspace.clearance_m)
    outlines = [
        banded.shape.polygon()
        for banded in banded_shapes(alone, level.amsl_m - level.height_m)
        if banded.counts(*level.counted_m) and banded.shape.polygon().intersects(area)
    ]
    if not outlines:
        return area
    rest = shapely.difference(area, shapely.union_all(outlines, grid_size=GRID_M), grid_size=GRID_M)
    parts = [
        part for part in shapely.get_parts(rest).tolist() if isinstance(part, Polygon) and part.area > 0.0
    ]
    if not parts:
        return area
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)
