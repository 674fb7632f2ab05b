"""A survey of 40 km² with some 20,000 photos through the whole planner: time, memory, photos."""

from __future__ import annotations

import math
import resource
import time
from collections.abc import Iterator
from typing import Any

from planner.geojson import read_scenario
from planner.pipeline import make_plan

Row = dict[str, Any]


def scale() -> Iterator[Row]:
    """One row, its kernels compiled and loaded before the clock runs."""
    make_plan(read_scenario(_square_km(0.4, 0.3)))
    began = time.perf_counter()
    plan = make_plan(read_scenario(_square_km(8.0, 5.0)), clock=time.perf_counter)
    took_s = time.perf_counter() - began
    yield {
        "bench": "survey-scale",
        "area_km2": 40.0,
        "lanes": len(plan.collects),
        "photos": sum(len(each.places) for each in plan.photos),
        "coverage": min(plan.metrics.coverage.values()),
        "violations": len(plan.violations),
        "planning_s": round(took_s, 2),
        "peak_mb": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0),
    }


def _square_km(wide_km: float, high_km: float) -> Row:
    degree_km = 111.32
    cos, sin = math.cos(math.radians(20.0)), math.sin(math.radians(20.0))
    corners = [(0.0, 0.0), (wide_km, 0.0), (wide_km, high_km), (0.0, high_km), (0.0, 0.0)]
    turned = [(cos * x - sin * y, sin * x + cos * y) for x, y in corners]
    wide_km_deg = degree_km * math.cos(math.radians(48.0))
    ring = [[11.0 + x / wide_km_deg, 48.0 + y / degree_km] for x, y in turned]
    field = {"type": "Polygon", "coordinates": [ring]}
    start = {"type": "Point", "coordinates": [10.99, 47.99]}
    return {
        "type": "FeatureCollection",
        "name": "survey",
        "features": [
            {"type": "Feature", "id": "field", "properties": {"role": "roi"}, "geometry": field},
            {"type": "Feature", "id": "start", "properties": {"role": "start"}, "geometry": start},
        ],
        "vehicles": [{"name": "wing", "airspeed_m_s": 20.0, "min_turn_radius_m": 60.0}],
        "sensors": [
            {
                "name": "eye",
                "type": "camera",
                "focal_length_m": 0.024,
                "pixel_pitch_m": 4e-6,
                "image_px": [6000, 4000],
            }
        ],
        "altitude_m": 180.0,
    }
