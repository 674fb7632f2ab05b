"""Random buildings close together over a region that a multirotor's camera sees, by seed."""

from __future__ import annotations

from typing import Any

import numpy as np
from shapely.geometry import Polygon
from shapely.geometry import box as rectangle

from tests.planner.moved import box, put_at
from tests.planner.scenarios import feature, small

#: Side of the region, metres.
SIDE_M = 160.0


def buildings(seed: int) -> list[tuple[Polygon, float]]:
    """Outlines in metres, and heights."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(int(rng.integers(6, 12))):
        wide, deep = rng.uniform(15.0, 50.0, 2)
        west, south = rng.uniform(0.0, SIDE_M - wide), rng.uniform(0.0, SIDE_M - deep)
        height_m = round(float(rng.uniform(30.0, 150.0)), 1)
        found.append((rectangle(west, south, west + wide, south + deep), height_m))
    return found


def among_blocks(seed: int, min_interval_s: float, airspeed_m_s: float = 8.0, **roi: Any) -> dict[str, Any]:
    """A scenario among them, at 47.4° N."""
    put = put_at((8.55, 47.4))
    document = small()
    document["features"] = [
        feature("R", "roi", "Polygon", box(put, 0, 0, SIDE_M, SIDE_M), **roi),
        feature("start", "start", "Point", put(-60, -60)),
        *(
            feature(f"B{k}", "obstacle", "Polygon", box(put, *outline.bounds), height_m=height_m)
            for k, (outline, height_m) in enumerate(buildings(seed))
        ),
    ]
    camera = {"name": "eye", "type": "camera", "model": "Sony a6000 20 mm", "forward_overlap": 0.6}
    vehicle = {"name": "uav", "type": "multirotor", "airspeed_m_s": airspeed_m_s}
    return document | {
        "altitude_m": 40.0, "altitude_reference": "home", "clearance_m": 3.0, "vehicles": [vehicle],
        "sensors": [camera | {"side_overlap": 0.6, "min_interval_s": min_interval_s}],
    }  # fmt: skip
