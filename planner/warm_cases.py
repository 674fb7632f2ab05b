"""What is planned so that every kernel is compiled once: small scenarios, by each method."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Final

import numpy as np
from shapely import box

from planner.airspace.kernels import length_in_discs
from planner.airspace.terrain import Ground, Terrain
from planner.airspace.zone_kernels import distances_from
from planner.as_flown.photo import Shots
from planner.as_flown.photo_ground import PhotoGrid
from planner.coverage.lanes_kernels import turns_between
from planner.coverage.reorder_kernels import reordered
from planner.coverage.turns_kernels import END
from planner.coverage.urban.methods import SEQUENCES
from planner.fleet.prizes.choice import Choices, best_choice
from planner.fleet.prizes.exact import exact_route
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.plan import PlanCamera

#: Small, and enough to run each stage by each of its methods.
SCENARIO: dict[str, Any] = {
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


def usual() -> None:
    """Regions for a radar among zones and threats, in one flight: what every other plan builds on."""
    make_plan(read_scenario(SCENARIO))


def bounds() -> None:
    """How much better a plan could be."""
    scenario = read_scenario(SCENARIO)
    with_bound(scenario, make_plan(scenario), share=True)


def methods() -> None:
    """The published methods."""
    for smoothing in ("fillet", "shortcut"):
        method = {"routing": "li2018", "transit": "ssas", "smoothing": smoothing}
        scenario = read_scenario(SCENARIO | {"method": method})
        with_bound(scenario, make_plan(scenario), share=True)


def many() -> None:
    """Beyond nine passes the order is searched and bounded otherwise."""
    scenario = read_scenario(_many())
    with_bound(scenario, make_plan(scenario), share=True)


def fleets() -> None:
    """Of several aircraft few regions are shared out by proof, more by search."""
    one = SCENARIO["vehicles"][0]
    several = {"vehicles": [one, {**one, "name": "other"}]}
    for members in (SCENARIO, _many()):
        make_plan(read_scenario(members | several))


def cameras() -> None:
    """Photos of a block, among buildings and without them; more lanes than every order is tried of."""
    make_plan(read_scenario(_city("auto", building=False)))
    turns_m = turns_between(np.zeros((12, END)), np.ones(12), 2, 5.0, np.empty((0, 9)))
    reordered(np.arange(0, 12, 2), turns_m, np.ones(12), 1)
    for coverage in SEQUENCES:
        make_plan(read_scenario(_city(coverage)))


def searches() -> None:
    """As much as the energy allows; walks over importance, looks that miss, and what drifts."""
    make_plan(read_scenario(_city("auto", building=False) | {"task": "search", "method": {}}))
    still, drift = {"detection": 0.5}, {"detection": 0.5, "drift": {"speed_m_s": 0.2, "toward_deg": 90.0}}
    for member in (still, drift):
        make_plan(read_scenario(_valued() | {"search": member}))
    valued = _valued()
    two = [{**valued["vehicles"][0], "name": name} for name in ("one", "other")]
    make_plan(read_scenario(valued | {"vehicles": two}))


def left_out() -> None:
    """What is left out where a limit is exceeded."""
    few = Choices(np.ones((4, 4, 2, 2)), np.array([0.0, 1.0, 1.0, 0.0]), 2.5)
    exact_route(few)
    best_choice(few, 0)


def ways_out() -> None:
    """Ways out of threats, and by which of them lines pass: the cases above need none."""
    discs = np.array([[500.0, 0.0, 100.0]])
    length_in_discs(np.zeros((3, 3))[:, :2], discs)
    distances_from(np.zeros((1, 8)), discs)


def terrain() -> None:
    """Over a raster: passes that are level, and lanes that follow the ground."""
    # The scenario lies at 0° N 0° E.
    plain = Terrain("plain", np.zeros((21, 21), dtype=np.float32), (0.1, 0.0, -1.0, 0.0, -0.1, 1.0))
    make_plan(read_scenario(SCENARIO | {"terrain": "plain"}, {"plain": plain}))
    city = _city("auto", building=False) | {"terrain": "plain", "terrain_following": True}
    make_plan(read_scenario(city, {"plain": plain}))


def photos() -> None:
    """What photos of a flight have seen, over level ground and over a raster."""
    camera = PlanCamera("eye", 0.02, 4e-6, 6000, 4000, 0.8, 0.7)
    one, across, upward = (
        np.array([[0.0, 0.0, 50.0]]),
        np.array([[1.0, 0.0, 0.0]]),
        np.array([[0.0, 1.0, 0.0]]),
    )
    shots = Shots(one, np.array([[0.0, 0.0, -1.0]]), across, upward)
    raster = Ground("level", "ellipsoid", np.zeros((9, 9)), -40.0, -40.0, 10.0)
    for ground in (None, raster):
        PhotoGrid.over(box(-9.0, -9.0, 9.0, 9.0), 30.0).lay(shots, camera, ground, 0.0)


#: What is compiled side by side, once the kernels of a usual plan are there; the longest first.
CASES: Final[tuple[Callable[[], None], ...]] = (
    methods, cameras, many, fleets, searches, left_out, terrain, photos, bounds, ways_out,
)  # fmt: skip


def _city(method: str, *, building: bool = True) -> dict[str, Any]:
    """A camera over a block, with a building in it or without."""
    rings = {"roi": (0.0, 0.0015), "obstacle": (0.0005, 0.0003), "area": (-0.01, 0.03)}
    features = [feature for feature in SCENARIO["features"] if feature["properties"]["role"] == "start"]
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
    return SCENARIO | {
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
    kept = [f for f in SCENARIO["features"] if f["properties"]["role"] in ("area", "start")]
    for k in range(10):
        west, south = 0.012 * (k % 4), 0.012 * (k // 4) - 0.012
        ring = [[west, south], [west + 0.003, south], [west + 0.003, south + 0.002], [west, south]]
        geometry = {"type": "Polygon", "coordinates": [ring]}
        kept.append({"type": "Feature", "id": f"M{k}", "properties": {"role": "roi"}, "geometry": geometry})
    return SCENARIO | {"features": kept}
