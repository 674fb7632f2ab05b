"""Compile every kernel once, so that the first plan is as fast as the second."""

from __future__ import annotations

import functools
import sys
from typing import Any

import numpy as np
from numba.core.dispatcher import Dispatcher

from planner.airspace.terrain import Terrain
from planner.compiling import Compiling
from planner.coverage.urban.methods import SEQUENCES
from planner.fleet.prizes.choice import Choices, best_choice
from planner.fleet.prizes.exact import exact_route
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound

#: Small, and enough to run each stage by each of its methods.
_SCENARIO: dict[str, Any] = {
    "type": "FeatureCollection",
    "name": "warm-up",
    "features": [
        {
            "type": "Feature",
            "id": f"R{k}",
            "properties": {"role": "roi"},
            "geometry": {
                "type": "Polygon",
                "coordinates": [
                    [[x, 0.0], [x + w, 0.0], [x + w, w], [x, w], [x, 0.0]]
                    for x, w in [(0.02 * k, (0.003, 0.007, 0.003)[k])]
                ][0:1],
            },
        }
        for k in range(3)
    ]
    + [
        {
            "type": "Feature",
            "id": name,
            "properties": {
                "role": "threat",
                "model": model,
                "radius_m": 300.0,
                "intensity_m": 300.0,
                "hard": hard,
            },
            "geometry": {"type": "Point", "coordinates": [lon, lat]},
        }
        for name, model, lon, lat, hard in (
            ("M", "missile", 0.012, 0.006, False),
            ("D", "radar", 0.012, -0.012, False),
            ("H", "missile", 0.03, 0.012, True),
        )
    ]
    + [
        {
            "type": "Feature",
            "id": "Z",
            "properties": {"role": "no_fly"},
            "geometry": {
                "type": "Polygon",
                "coordinates": [
                    [[0.05, 0.012], [0.053, 0.012], [0.053, 0.016], [0.05, 0.016], [0.05, 0.012]]
                ],
            },
        },
        {
            "type": "Feature",
            "id": "area",
            "properties": {"role": "area"},
            "geometry": {
                "type": "Polygon",
                "coordinates": [[[-0.03, -0.03], [0.08, -0.03], [0.08, 0.04], [-0.03, 0.04], [-0.03, -0.03]]],
            },
        },
        {
            "type": "Feature",
            "id": "start",
            "properties": {"role": "start"},
            "geometry": {"type": "Point", "coordinates": [-0.02, -0.02]},
        },
    ],
    "vehicles": [{"name": "v", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0}],
    "sensors": [
        {
            "name": "s",
            "type": "sar",
            "incidence_deg": 45.0,
            "elevation_beamwidth_deg": 30.0,
            "azimuth_beamwidth_deg": 10.0,
            "look": "both",
        }
    ],
    "altitude_m": 500.0,
}


def load() -> None:
    """Load the kernels of a usual plan; where they had to be compiled for that, compile the others too.

    A process that is to plan at once is ready sooner than by :func:`warm_up`. Of several that begin at
    once where nothing is kept, one compiles.
    """
    Compiling().once(_load)


def prepare() -> None:
    """End an installation: compile every kernel, so that processes that begin later wait for nobody."""
    Compiling().once(_all)


def _all() -> bool:
    warm_up()
    return compiled() > 0


def _load() -> bool:
    one = [feature for feature in _SCENARIO["features"] if feature["id"] not in ("R1", "R2")]
    scenario = read_scenario(_SCENARIO | {"features": one})
    with_bound(scenario, make_plan(scenario))
    if not compiled():
        return False
    warm_up()
    return True


def compiled() -> int:
    """How many kernels this process has compiled because none were kept from before."""
    kernels = {
        id(value): value
        for name, module in list(sys.modules.items())
        if name.startswith("planner.") and module is not None
        for value in vars(module).values()
        if isinstance(value, Dispatcher)
    }
    return sum(sum(kernel.stats.cache_misses.values()) for kernel in kernels.values())


@functools.cache
def warm_up() -> None:
    """Plan a small scenario by each method, once in a process."""
    for method in (
        {},
        {"routing": "li2018", "transit": "ssas", "smoothing": "fillet"},
        {"routing": "li2018", "transit": "ssas", "smoothing": "shortcut"},
    ):
        scenario = read_scenario(_SCENARIO | {"method": method})
        with_bound(scenario, make_plan(scenario), share=True)
    # Beyond nine passes the order is searched and bounded otherwise.
    many = read_scenario(_many())
    with_bound(many, make_plan(many), share=True)
    # Of several aircraft few regions are shared out by proof, more by search.
    one = _SCENARIO["vehicles"][0]
    several = {"vehicles": [one, {**one, "name": "other"}]}
    for members in (_SCENARIO, _many()):
        make_plan(read_scenario(members | several))
    make_plan(read_scenario(_city("auto", building=False)))
    make_plan(read_scenario(_city("auto", building=False) | {"task": "search", "method": {}}))
    # Walks over importance, looks that miss, and what drifts.
    still, drift = {"detection": 0.5}, {"detection": 0.5, "drift": {"speed_m_s": 0.2, "toward_deg": 90.0}}
    for member in (still, drift):
        make_plan(read_scenario(_valued() | {"search": member}))
    for coverage in SEQUENCES:
        make_plan(read_scenario(_city(coverage)))
    # What is left out where a limit is exceeded.
    few = Choices(np.ones((4, 4, 2, 2)), np.array([0.0, 1.0, 1.0, 0.0]), 2.5)
    exact_route(few)
    best_choice(few, 0)
    # The scenario lies at 0° N 0° E.
    plain = Terrain("plain", np.zeros((21, 21), dtype=np.float32), (0.1, 0.0, -1.0, 0.0, -0.1, 1.0))
    make_plan(read_scenario(_SCENARIO | {"terrain": "plain"}, {"plain": plain}))


def _city(method: str, *, building: bool = True) -> dict[str, Any]:
    """A camera over a block, with a building in it or without."""
    rings = {"roi": (0.0, 0.0015), "obstacle": (0.0005, 0.0003), "area": (-0.01, 0.03)}
    features = [feature for feature in _SCENARIO["features"] if feature["properties"]["role"] == "start"]
    for role, (low, size) in rings.items():
        if role == "obstacle" and not building:
            continue
        high = low + size
        ring = [[low, low], [high, low], [high, high], [low, high], [low, low]]
        features.append(
            {
                "type": "Feature",
                "id": f"city-{role}",
                "properties": {"role": role} | ({"height_m": 90.0} if role == "obstacle" else {}),
                "geometry": {"type": "Polygon", "coordinates": [ring]},
            }
        )
    start = {**features[0], "geometry": {"type": "Point", "coordinates": [-0.001, -0.001]}}
    return _SCENARIO | {
        "features": [start, *features[1:]],
        "vehicles": [{"name": "q", "type": "multirotor", "airspeed_m_s": 8.0, "min_turn_radius_m": 4.0}],
        "sensors": [{"name": "eye", "type": "camera", "model": "Sony a6000 20 mm"}],
        "altitude_m": 60.0,
        "method": {"coverage": method},
    }


def _valued() -> dict[str, Any]:
    """The same to be searched, with a place that is worth more."""
    city = _city("auto", building=False)
    geometry = {"type": "Point", "coordinates": [0.001, 0.0005]}
    worth = {"role": "importance", "score": 1.0, "spread_m": 20.0}
    point = {"type": "Feature", "id": "worth", "properties": worth, "geometry": geometry}
    limited = {**city["vehicles"][0], "max_flight_time_s": 400.0}
    return city | {
        "features": [*city["features"], point],
        "vehicles": [limited],
        "task": "search",
        "method": {},
    }


def _many() -> dict[str, Any]:
    """The same with ten regions side by side, and no zones."""
    kept = [f for f in _SCENARIO["features"] if f["properties"]["role"] in ("area", "start")]
    for k in range(10):
        west, south = 0.012 * (k % 4), 0.012 * (k // 4) - 0.012
        ring = [[west, south], [west + 0.003, south], [west + 0.003, south + 0.002], [west, south]]
        geometry = {"type": "Polygon", "coordinates": [ring]}
        kept.append({"type": "Feature", "id": f"M{k}", "properties": {"role": "roi"}, "geometry": geometry})
    return _SCENARIO | {"features": kept}
