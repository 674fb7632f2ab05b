"""What judging a scenario takes: processor time and memory, of many regions and of outlines that are combs.

Each is judged by a process of its own, as the service judges what it is sent, once its kernels are there.
Run as ``swathplan bench validate``; prints JSON lines.
"""

from __future__ import annotations

import json
import math
import resource
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import Any

from planner.validate import findings

#: Regions lie so far apart, and are so wide, in degrees.
APART_DEG, WIDE_DEG = 0.02, 0.004
TEETH = 1200
#: From one end of a comb to the other: teeth 0.6 m apart and 2.5 m apart.
COMBS_DEG = (0.01, 0.04)
LON_DEG, LAT_DEG = 8.0, 47.0


def run(regions: int = 1000, teeth: int = TEETH) -> Iterator[dict[str, Any]]:
    """One row for each scenario."""
    for name, document in scenarios(regions, teeth):
        with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
            pool.submit(_judged, many(4)).result()
            cpu_s, megabytes, found = pool.submit(_judged, document).result()
        yield {
            "scenario": name,
            "features": len(document["features"]),
            "kB": round(len(json.dumps(document)) / 1000.0),
            "cpu_s": round(cpu_s, 3),
            "peak_MB": round(megabytes),
            "findings": found,
        }


def scenarios(regions: int, teeth: int) -> Iterator[tuple[str, dict[str, Any]]]:
    """What is judged: many regions, combs to be seen, to be kept out of and to be stayed in."""
    yield f"{regions} regions", many(regions)
    for east_deg in COMBS_DEG:
        yield (
            f"region, {teeth} teeth over {east_deg} deg",
            _scenario([_feature("roi", comb(teeth, east_deg))]),
        )
    east_deg = COMBS_DEG[0]
    ring = [[x + 0.1, y] for x, y in comb(teeth, east_deg)]
    yield f"no_fly, {teeth} teeth", _scenario([_feature("roi", _box(0.2, 0.0)), _feature("no_fly", ring)])
    sides = [[LON_DEG + 0.5, LAT_DEG - 0.5], [LON_DEG + 0.5, LAT_DEG]]
    ring = [[LON_DEG - 0.1, LAT_DEG - 0.5], *sides, *comb(teeth, east_deg)[2:-2]]
    ring += [[LON_DEG - 0.1, LAT_DEG], [LON_DEG - 0.1, LAT_DEG - 0.5]]
    yield f"area, {teeth} teeth", _scenario([_feature("roi", _box(0.2, -0.3)), _feature("area", ring)])


def many(regions: int) -> dict[str, Any]:
    """Regions in rows."""
    side = math.ceil(math.sqrt(regions))
    boxes = [_box(k % side * APART_DEG, k // side * APART_DEG) for k in range(regions)]
    return _scenario([_feature("roi", box, f"r{k}") for k, box in enumerate(boxes)])


def comb(teeth: int, east_deg: float) -> list[list[float]]:
    """A bar with teeth to the north, two corners a tooth."""
    pitch_deg, east = east_deg / teeth, LON_DEG + east_deg
    tips = [
        [[east - k * pitch_deg, LAT_DEG + 0.02], [east - (k + 0.5) * pitch_deg, LAT_DEG + 0.004]]
        for k in range(teeth)
    ]
    ring = [[LON_DEG, LAT_DEG], [east, LAT_DEG], *(corner for pair in tips for corner in pair)]
    return [*ring, [LON_DEG, LAT_DEG + 0.02], [LON_DEG, LAT_DEG]]


def _box(east_deg: float, north_deg: float) -> list[list[float]]:
    lon, lat = LON_DEG + east_deg, LAT_DEG + north_deg
    far, up = lon + WIDE_DEG, lat + WIDE_DEG
    return [[lon, lat], [far, lat], [far, up], [lon, up], [lon, lat]]


def _feature(role: str, ring: list[list[float]], name: str | None = None) -> dict[str, Any]:
    geometry = {"type": "Polygon", "coordinates": [ring]}
    return {"type": "Feature", "id": name or role, "properties": {"role": role}, "geometry": geometry}


def _scenario(features: list[dict[str, Any]]) -> dict[str, Any]:
    place = {"type": "Point", "coordinates": [LON_DEG + 0.19, LAT_DEG - 0.29]}
    return {
        "type": "FeatureCollection",
        "name": "validate",
        "features": [
            *features,
            {"type": "Feature", "id": "start", "properties": {"role": "start"}, "geometry": place},
        ],
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
    }


def _judged(document: dict[str, Any]) -> tuple[float, float, list[str]]:
    """Seconds of processor time, the most memory so far in MB, and the rules found."""
    begun_s = time.process_time()
    rules = sorted({finding.rule for finding in findings(document)})
    taken_s = time.process_time() - begun_s
    unit = 1e6 if sys.platform == "darwin" else 1e3
    return taken_s, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit, rules


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
