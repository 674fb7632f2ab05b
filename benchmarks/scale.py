"""Many regions among many threats, and wide ones of many strips: seconds, memory, length, bound and gap.

Each size is planned in a process of its own, so that the peak of memory is that of the one plan (kernels and
libraries included). Scenarios are random and the same for the same seed: convex regions 250–900 m across, one
to ten square kilometres, as in the paper's cases; threats and hard zones between them. Ten wide ones without
threats are 1,000 km² in all and take 200 strips of a swath.
"""

from __future__ import annotations

import json
import math
import multiprocessing
import resource
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
from shapely.affinity import rotate, translate
from shapely.geometry import MultiPoint, Point, box, mapping

from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.warm import warm_up

#: Regions and threats.
SIZES = ((12, 12), (20, 30), (50, 60), (100, 100))
KM2_PER_REGION = 10.0
#: Wide regions: how many, and how long and wide each is; from how high they are seen.
WIDE, WIDE_SIDE_M, WIDE_HEIGHT_M = 10, 10_030.0, 450.0
#: Every so many threats one is a hard zone.
HARD_EVERY = 5
LATITUDE_DEG, LONGITUDE_DEG = 33.5, -117.7
METRES_PER_DEG = 111_320.0


def scenario_document(regions: int, threats: int, seed: int) -> dict[str, Any]:
    """A random scenario as GeoJSON."""
    rng = np.random.default_rng(seed)
    side_m = math.sqrt(KM2_PER_REGION * regions) * 1000.0
    areas = _regions(rng, regions, side_m)
    discs = _discs(rng, threats, side_m, areas)
    features = [
        _feature(f"R{k + 1}", _degrees(mapping(area)["coordinates"]), "Polygon", role="roi")
        for k, area in enumerate(areas)
    ]
    for k, (east_m, north_m, radius_m) in enumerate(discs):
        model = "radar" if k % 2 else "missile"
        properties = {"role": "threat", "model": model, "radius_m": radius_m, "hard": k % HARD_EVERY == 0}
        if model == "radar":
            properties["intensity_m"] = radius_m
        features.append(_feature(f"T{k + 1}", _degrees([east_m, north_m]), "Point", **properties))
    low, high = -3000.0, side_m + 3000.0
    ring = [[low, low], [high, low], [high, high], [low, high], [low, low]]
    features.append(_feature("area", _degrees([ring]), "Polygon", role="area"))
    features.append(_feature("start", _degrees([-1500.0, -1500.0]), "Point", role="start"))
    return _document(f"scale-{regions}-{threats}-{seed}", features, seed)


def wide_document() -> dict[str, Any]:
    """Ten squares of 100 km² as GeoJSON, each turned a little more than the one before."""
    apart_m = 1.5 * WIDE_SIDE_M
    features = [_feature("start", _degrees([-apart_m, -apart_m]), "Point", role="start")]
    for k in range(WIDE):
        square = box(0.0, 0.0, WIDE_SIDE_M, WIDE_SIDE_M)
        placed = translate(rotate(square, 7.0 * k), apart_m * (k % 4), apart_m * (k // 4))
        ring = _degrees(mapping(placed)["coordinates"])
        features.append(_feature(f"W{k + 1}", ring, "Polygon", role="roi"))
    return _document("scale-wide", features, 0) | {"altitude_m": WIDE_HEIGHT_M}


def _document(name: str, features: list[dict[str, Any]], seed: int) -> dict[str, Any]:
    return {
        "type": "FeatureCollection",
        "name": name,
        "features": features,
        "vehicles": [{"name": "uav", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0}],
        "sensors": [
            {
                "name": "sar",
                "type": "sar",
                "incidence_deg": 45.0,
                "elevation_beamwidth_deg": 30.0,
                "azimuth_beamwidth_deg": 10.0,
                "look": "right",
            }
        ],
        "altitude_m": 500.0,
        "clearance_m": 0.0,
        "seed": seed,
    }


def run(
    sizes: Any = SIZES, seeds: Any = (0,), repeats: int = 1, wide: bool = True
) -> Iterator[dict[str, Any]]:
    """One row a scenario, wide regions the last; times are the best of ``repeats`` warm plans.

    ``processor_s`` is what planning takes of one core, which a busy machine hardly changes.
    """
    warm_up()
    context = multiprocessing.get_context("spawn")
    for regions, threats in sizes:
        for seed in seeds if isinstance(seeds, (list, tuple)) else (seeds,):
            with context.Pool(1) as pool:
                yield pool.apply(_row, (regions, threats, seed, repeats))
    if wide:
        with context.Pool(1) as pool:
            yield pool.apply(_row_of, (wide_document(), 0, repeats))


def _row(regions: int, threats: int, seed: int, repeats: int) -> dict[str, Any]:
    return _row_of(scenario_document(regions, threats, seed), threats, repeats)


def _row_of(document: dict[str, Any], threats: int, repeats: int) -> dict[str, Any]:
    warm_up()
    scenario = read_scenario(document)
    seconds, processor = [], []
    for _ in range(repeats):
        began, worked = time.perf_counter(), time.process_time()
        plan = make_plan(scenario, clock=time.perf_counter)
        seconds.append(time.perf_counter() - began)
        processor.append(time.process_time() - worked)
    plan = with_bound(scenario, plan, clock=time.perf_counter)
    return {
        "bench": "scale",
        "regions": len(scenario.regions),
        "threats": threats,
        "seed": scenario.seed,
        "km2": math.fsum(region.area.area for region in scenario.regions) / 1e6,
        "passes": len(plan.collects),
        "seconds": min(seconds),
        "processor_s": min(processor),
        "peak_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "length_m": plan.metrics.route_length_m,
        "lower_bound_m": plan.metrics.lower_bound_m,
        "gap": plan.metrics.gap,
        "least_coverage": min(plan.metrics.coverage.values()),
        "violations": len(plan.violations),
        "hard_violations": len(plan.hard_violations),
        "stages_s": plan.metrics.planning_time_s,
    }


def _regions(rng: np.random.Generator, count: int, side_m: float) -> list[Any]:
    centres: list[tuple[float, float]] = []
    while len(centres) < count:
        place = (float(rng.uniform(0.0, side_m)), float(rng.uniform(0.0, side_m)))
        if all(math.dist(place, other) >= 1500.0 for other in centres):
            centres.append(place)
    areas = []
    for east_m, north_m in centres:
        angles = rng.uniform(0.0, 2.0 * math.pi, 10)
        long_m, short_m, lean = (
            rng.uniform(250.0, 450.0),
            rng.uniform(125.0, 300.0),
            rng.uniform(0.0, math.pi),
        )
        along, across = long_m * np.cos(angles), short_m * np.sin(angles)
        east = east_m + along * math.cos(lean) - across * math.sin(lean)
        north = north_m + along * math.sin(lean) + across * math.cos(lean)
        areas.append(MultiPoint(list(zip(east.tolist(), north.tolist(), strict=True))).convex_hull)
    return areas


def _discs(
    rng: np.random.Generator, count: int, side_m: float, areas: list[Any]
) -> list[tuple[float, float, float]]:
    discs: list[tuple[float, float, float]] = []
    while len(discs) < count:
        east_m, north_m = (float(value) for value in rng.uniform(0.0, side_m, 2))
        radius_m = float(rng.uniform(300.0, 800.0))
        if any(math.dist((east_m, north_m), d[:2]) < radius_m + d[2] + 250.0 for d in discs):
            continue
        if any(area.distance(Point(east_m, north_m)) < radius_m + 200.0 for area in areas):
            continue
        discs.append((east_m, north_m, radius_m))
    return discs


def _degrees(coordinates: Any) -> Any:
    if isinstance(coordinates[0], (int, float)):
        east_m, north_m = coordinates
        per_deg = METRES_PER_DEG * math.cos(math.radians(LATITUDE_DEG))
        return [LONGITUDE_DEG + east_m / per_deg, LATITUDE_DEG + north_m / METRES_PER_DEG]
    return [_degrees(part) for part in coordinates]


def _feature(name: str, coordinates: Any, kind: str, **properties: Any) -> dict[str, Any]:
    return {
        "type": "Feature",
        "id": name,
        "properties": properties,
        "geometry": {"type": kind, "coordinates": coordinates},
    }


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
