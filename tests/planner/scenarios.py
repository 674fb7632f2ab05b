"""Scenario documents for tests: the shared cases, and a small one to bend."""

from __future__ import annotations

import copy
import functools
import json
from pathlib import Path
from typing import Any

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario

EXAMPLES = Path(__file__).parents[2] / "examples"


def case(number: int) -> dict[str, Any]:
    """One of the paper's four cases."""
    document: dict[str, Any] = json.loads((EXAMPLES / f"sar-case-{number}.geojson").read_text())
    return document


@functools.cache
def planned_case(number: int) -> tuple[Scenario, Plan]:
    """One of the four as read and planned by ``auto``, once for all tests of a process."""
    scenario = read_scenario(case(number))
    return scenario, make_plan(scenario)


def square(lon: float, lat: float, size_deg: float) -> list[list[list[float]]]:
    """Coordinates of a square polygon with its south-west corner at a place."""
    e, n = lon + size_deg, lat + size_deg
    return [[[lon, lat], [e, lat], [e, n], [lon, n], [lon, lat]]]


def feature(name: str, role: str, kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
    """One GeoJSON feature."""
    return {
        "type": "Feature",
        "id": name,
        "properties": {"role": role, **properties},
        "geometry": {"type": kind, "coordinates": coordinates},
    }


def small(*more: dict[str, Any], **members: Any) -> dict[str, Any]:
    """Two small regions in a 13 km square, and whatever is added or overridden."""
    document = {
        "type": "FeatureCollection",
        "name": "small",
        "features": [
            feature("A", "roi", "Polygon", square(0.0, 0.0, 0.003)),
            feature("B", "roi", "Polygon", square(0.03, 0.01, 0.003)),
            feature("area", "area", "Polygon", square(-0.05, -0.05, 0.12)),
            feature("start", "start", "Point", [-0.02, -0.02]),
            *more,
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
    return copy.deepcopy(document | members)


def of_two(**members: Any) -> dict[str, Any]:
    """Two aircraft at one start, and a region on either side of it."""
    document = small(**members)
    document["features"][0]["geometry"]["coordinates"] = square(0.02, 0.01, 0.003)
    document["features"][1]["geometry"]["coordinates"] = square(-0.045, 0.01, 0.003)
    document["features"][3]["geometry"]["coordinates"] = [-0.012, -0.02]
    (one,) = document["vehicles"]
    return document | {"vehicles": [one, one | {"name": "second"}]}
