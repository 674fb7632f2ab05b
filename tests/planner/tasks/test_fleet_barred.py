"""Several aircraft where one region is walled off, or others are in a flight's way."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import pytest

from planner.geojson import read_scenario
from planner.pipeline import make_plan

Feature = dict[str, Any]


def place(east_m: float, north_m: float, name: str, role: str, **wishes: Any) -> Feature:
    lonlat = [11.0 + east_m / 77_325.0, 46.0 + north_m / 111_146.0]
    return {
        "type": "Feature",
        "id": name,
        "geometry": {"type": "Point", "coordinates": lonlat},
        "properties": {"role": role, **wishes},
    }


def scenario(features: list[Feature], **members: Any) -> dict[str, Any]:
    """A wing and a multirotor at one start, with a camera each."""
    wing = {"name": "wing", "type": "fixed_wing", "airspeed_m_s": 18, "min_turn_radius_m": 60}
    copter = {"name": "copter", "type": "multirotor", "airspeed_m_s": 10}
    return {
        "type": "FeatureCollection",
        "features": [place(0, 0, "start", "start"), *features],
        "vehicles": [wing | {"autopilot": "ardupilot"}, copter | {"autopilot": "px4"}],
        "sensors": [{"name": "eye", "type": "camera", "model": "Sony a6000 20 mm"}],
        "altitude_m": 120,
        **members,
    }


def walled() -> dict[str, Any]:
    """One region in the open, one with zones all round it."""
    ring = [
        place(-900 + 250 * math.cos(a), 250 * math.sin(a), f"wall {k}", "no_fly", radius_m=110)
        for k, a in enumerate(k * math.pi / 4 for k in range(8))
    ]
    inside = place(-900, 0, "inside", "roi", radius_m=10, required=False)
    return scenario([place(500, -300, "open", "roi", radius_m=10), inside, *ring])


def test_what_no_aircraft_can_fly_to_is_left_out() -> None:
    """A walled region that need not be seen does not cost the others their plan."""
    plan = make_plan(read_scenario(walled()))
    (left,) = plan.metrics.left_out
    assert (left.roi, left.reason) == ("inside", "hard-zone")
    assert any(warning.startswith("inside:") for warning in plan.warnings)
    assert plan.metrics.coverage["open"] == 1.0
    assert plan.hard_violations == ()


@pytest.mark.parametrize("required", [True, False])
def test_a_flight_that_others_would_make_late_goes_first(required: bool) -> None:
    """One flies at a time: what has a window is not kept from it by what could be seen later."""
    closes_s = 300 if required else 130
    features = [
        place(900, 300, "x", "roi", radius_m=20, time_window_s=[60, 300]),
        place(-900, 300, "y", "roi", radius_m=20, time_window_s=[60, closes_s], required=required),
        place(-900, -900, "z", "roi", radius_m=20),
    ]
    document = scenario(features, separation={"horizontal_m": 20000, "vertical_m": 5000})
    document["vehicles"].insert(1, document["vehicles"][0] | {"name": "other"})
    plan = make_plan(read_scenario(document))
    assert plan.metrics.coverage["x"] == plan.metrics.coverage["z"] == 1.0
    assert [left.roi for left in plan.metrics.left_out] == ([] if required else ["y"])
    assert plan.hard_violations == ()
    spans = sorted((path.start_s, path.end_s) for path in plan.paths)
    assert all(a[1] <= b[0] for a, b in pairwise(spans))


def test_parts_of_a_region_are_seen_from_its_altitude() -> None:
    """A region shared out among aircraft that see others from elsewhere keeps its own altitude."""
    low = place(0, 900, "low", "roi", altitude_m=100)
    sides = [(-300, 700), (300, 700), (300, 1100), (-300, 1100), (-300, 700)]
    ring = [place(e, n, "", "")["geometry"]["coordinates"] for e, n in sides]
    low["geometry"] = {"type": "Polygon", "coordinates": [ring]}
    high = [place(e, 500, f"high {e}", "roi", radius_m=10) for e in (-800, 800)]
    plan = make_plan(read_scenario(scenario([low, *high])))
    assert len({collect.vehicle for collect in plan.collects if collect.roi == "low"}) == 2
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == pytest.approx(dict.fromkeys(plan.metrics.coverage, 1.0), abs=1e-6)
