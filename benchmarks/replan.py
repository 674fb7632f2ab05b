"""How soon a flight has a new plan: from the call to the plan, judged.

Regions are dealt round an airfield; at a third of the plan's time one is gone and another comes in. Run as
``swathplan bench replan``; prints JSON lines.
"""

from __future__ import annotations

import math
import random
import time
from collections.abc import Iterator
from typing import Any

from app.services.plans.replanned import Changes
from app.services.plans.replanning import Asked, left_of
from planner.geojson import read_scenario
from planner.pipeline import make_plan

LON_DEG, LAT_DEG = 10.0, 50.0
WIDE_DEG, REACH_DEG = 0.004, 0.08
PART = 1.0 / 3.0


def run(regions: int = 20, repeats: int = 5, seed: int = 0) -> Iterator[dict[str, Any]]:
    """One row for each draw of regions."""
    for draw in range(repeats):
        document = scenario(regions, seed + draw)
        asked = read_scenario(document)
        plan = make_plan(asked)
        at_s = PART * plan.paths[0].duration_s
        last = plan.collects[-1].regions[0]
        came_in = region(random.Random(-1 - draw), "new")
        changes = Changes(features=[came_in], removed=[last])
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        left = left_of(document, asked, plan, Asked(at_s, {}, None, changes))
        again = make_plan(read_scenario(left))
        yield {
            "regions": regions,
            "left": len({name for collect in again.collects for name in collect.regions}),
            "seconds": round(time.perf_counter() - began_s, 3),
            "cpu_s": round(time.process_time() - began_cpu_s, 3),
            "hard_violations": len(again.hard_violations),
            "least_coverage": round(min(again.metrics.coverage.values()), 6),
        }


def scenario(regions: int, seed: int) -> dict[str, Any]:
    """Regions at random under a radar's aircraft."""
    rng = random.Random(seed)
    start = {
        "type": "Feature",
        "id": "start",
        "properties": {"role": "start"},
        "geometry": {"type": "Point", "coordinates": [LON_DEG, LAT_DEG]},
    }
    return {
        "type": "FeatureCollection",
        "features": [start, *(region(rng, f"r{k}") for k in range(regions))],
        "vehicles": [{"name": "uav", "airspeed_m_s": 25.0, "min_turn_radius_m": 120.0}],
        "sensors": [
            {
                "name": "sar",
                "type": "sar",
                "incidence_deg": 45.0,
                "elevation_beamwidth_deg": 20.0,
                "azimuth_beamwidth_deg": 8.0,
                "look": "right",
            }
        ],
        "altitude_m": 800.0,
        "altitude_reference": "terrain",
    }


def region(rng: random.Random, name: str) -> dict[str, Any]:
    """A square of some hundred metres, somewhere round the airfield."""
    east = LON_DEG + rng.uniform(-1.0, 1.0) * REACH_DEG / math.cos(math.radians(LAT_DEG))
    north = LAT_DEG + rng.uniform(-1.0, 1.0) * REACH_DEG
    half = WIDE_DEG / 2.0
    corners = [(-half, -half), (half, -half), (half, half), (-half, half), (-half, -half)]
    return {
        "type": "Feature",
        "id": name,
        "properties": {"role": "roi"},
        "geometry": {"type": "Polygon", "coordinates": [[[east + x, north + y] for x, y in corners]]},
    }
