"""Areas with obstacles for tests, and a raster that knows nothing of sweeps but where they are."""

from __future__ import annotations

import numpy as np
import shapely
import shapely.affinity
from shapely.geometry import Polygon, box

from planner.coverage.urban.area import Building, UrbanArea
from planner.coverage.urban.measures import Sweep

SHAPES = {
    "square": box(0, 0, 300, 300),
    "rectangle": box(0, 0, 420, 200),
    "convex": Polygon([(60, 0), (300, 30), (380, 180), (240, 320), (40, 240), (0, 90)]),
    "non-convex": Polygon(
        [(0, 0), (400, 0), (400, 350), (280, 350), (280, 150), (130, 150), (130, 350), (0, 350)]
    ),
    "irregular": Polygon(
        [(0, 40), (120, 0), (200, 90), (330, 20), (400, 200), (270, 330), (190, 250), (60, 320), (20, 180)]
    ),
}


def random_area(shape: str, seed: int, **changes: float) -> UrbanArea:
    """An area of a shape with seven buildings at random, some turned, some low."""
    rng = np.random.default_rng(seed)
    area = SHAPES[shape]
    west, south, east, north = area.bounds
    buildings = []
    for k in range(7):
        x, y = rng.uniform((west, south), (east, north))
        w, h = rng.uniform(15, 60, 2)
        outline = box(x, y, x + w, y + h)
        if k % 2:
            outline = shapely.affinity.rotate(outline, float(rng.uniform(0, 90)))
        buildings.append(Building(outline, float(rng.choice([8.0, 40.0, 90.0, 250.0]))))
    blocked = shapely.union_all([b.outline.convex_hull.buffer(25.0) for b in buildings])
    room = max(shapely.get_parts(area.buffer(-3.0).difference(blocked)), key=lambda part: part.area)
    start = room.point_on_surface()
    values = {"width_m": 20.0, "length_m": 30.0, "height_m": 25.0, "max_height_m": 150.0, "clearance_m": 10.0}
    place = (start.x, start.y)
    return UrbanArea(area, tuple(buildings), **(values | changes), start=place, end=place)


def unseen(sweeps: tuple[Sweep, ...], ground: object, width_m: float, ahead_m: float, step_m: float) -> int:
    """Places of a grid on the ground, no nearer its edge than a millimetre, that no sweep passes over."""
    inner = ground.buffer(-1e-3)  # type: ignore[attr-defined]
    west, south, east, north = inner.bounds
    x, y = (a.ravel() for a in np.meshgrid(np.arange(west, east, step_m), np.arange(south, north, step_m)))
    inside = shapely.contains_xy(inner, x, y)
    x, y = x[inside], y[inside]
    seen = np.zeros(len(x), dtype=bool)
    for sweep in sweeps:
        along = np.subtract(sweep.end, sweep.start) / sweep.length_m
        e, n = x - sweep.start[0], y - sweep.start[1]
        ahead, aside = e * along[0] + n * along[1], n * along[0] - e * along[1]
        close = (ahead >= -ahead_m) & (ahead <= sweep.length_m + ahead_m)
        seen |= close & (np.abs(aside) <= width_m / 2.0 + 1e-6)
    return int((~seen).sum())
