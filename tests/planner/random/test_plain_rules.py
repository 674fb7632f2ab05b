"""No plain rule beats the answer: some polygons in each run.

``SWATHPLAN_RANDOM`` set to ``all`` tries every polygon.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.moved import put_at
from tests.planner.scenarios import feature

CHOSEN = os.environ.get("SWATHPLAN_RANDOM", "0")
POLYGONS = range(200 if CHOSEN == "all" else 4)
#: Headings of the plain rule; of them those with the shortest lanes, so far apart, are planned.
STEP_DEG, APART_DEG, PLANNED = 1.0, 4.0, 4
#: How much longer the answer may be.
SAME = 0.005

Places = list[tuple[float, float]]
Put = Callable[[float, float], list[float]]


def polygon(number: int) -> Places:
    """A random polygon of some swaths' width, in metres."""
    rng = np.random.default_rng([8, number])
    count = int(rng.integers(3, 9))
    radii_m = rng.uniform(0.4, 1.0, count) * rng.uniform(300.0, 700.0)
    angles_rad = np.linspace(0.0, math.tau, count, endpoint=False) + rng.uniform(0.0, 0.5, count)
    return [
        (float(r * math.cos(a)), float(r * math.sin(a))) for r, a in zip(radii_m, angles_rad, strict=True)
    ]


def asked(
    regions: list[Places], put: Put, factor: float = 1.0, looks: str = "both", **known: Any
) -> dict[str, Any]:
    """Regions to be seen by a small aircraft from beside them."""
    return {
        "type": "FeatureCollection",
        "features": [
            *(
                feature(f"R{k}", "roi", "Polygon", [[put(*place) for place in [*ring, ring[0]]]], **known)
                for k, ring in enumerate(regions)
            ),
            feature("start", "start", "Point", put(-2500.0 * factor, -1500.0 * factor)),
        ],
        "vehicles": [{"name": "uav", "airspeed_m_s": 15, "min_turn_radius_m": 30.0 * factor}],
        "sensors": [
            {
                "name": "sar", "type": "sar", "incidence_deg": 45, "elevation_beamwidth_deg": 30.0,
                "azimuth_beamwidth_deg": 1.0, "look": looks,
            }
        ],
        "altitude_m": 100.0 * factor,
    }  # fmt: skip


def length_m(document: dict[str, Any]) -> float:
    plan = make_plan(read_scenario(document))
    assert plan.metrics.route_length_m is not None
    assert set(plan.metrics.coverage.values()) == {1.0}
    return plan.metrics.route_length_m


def promising_deg(ring: Places) -> list[float]:
    """Of headings all round and those of edges the ones with the shortest lanes and turns."""
    corners = np.array(ring)
    east, north = (np.roll(corners, -1, axis=0) - corners).T
    headings_deg = np.concatenate(
        [np.arange(0.0, 180.0, STEP_DEG), np.degrees(np.arctan2(east, north)) % 180.0]
    )
    near, far = math.tan(math.radians(30.0)), math.tan(math.radians(60.0))
    swath_m = 100.0 * (far - near)
    costs_m = []
    for heading_rad in np.radians(headings_deg):
        ahead = np.array([math.sin(heading_rad), math.cos(heading_rad)])
        along_m, across_m = corners @ ahead, corners @ np.array([ahead[1], -ahead[0]])
        lanes = math.ceil(np.ptp(across_m) / swath_m)
        costs_m.append(lanes * (0.7 * np.ptp(along_m) + 100.0))
    chosen: list[float] = []
    for heading_deg in headings_deg[np.argsort(costs_m, kind="stable")].tolist():
        if all(abs(math.remainder(heading_deg - other, 180.0)) >= APART_DEG for other in chosen):
            chosen.append(heading_deg)
    return chosen[:PLANNED]


@pytest.mark.parametrize("number", POLYGONS)
def test_no_single_heading_is_shorter(number: int) -> None:
    """What is planned freely is no longer than with a heading given, be it an edge's or one of a sweep."""
    ring, put = polygon(number), put_at((8.55, 47.4))
    free_m = length_m(asked([ring], put))
    given_m = [
        length_m(asked([ring], put, approach_deg=[heading, (heading + 180.0) % 360.0]))
        for heading in promising_deg(ring)
    ]
    assert free_m <= (1.0 + SAME) * min(given_m)
