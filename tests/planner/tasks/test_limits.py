"""Optional regions are left out for range, time and energy, by priority; the rest is flown and said."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from planner.errors import InfeasibleError
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from tests.planner.scenarios import feature, small, square

#: Degrees of latitude to a kilometre.
KM_DEG = 1.0 / 110.6
POWER_W = 180.0


def roi(name: str, east_km: float, north_km: float, **properties: object) -> dict[str, Any]:
    """A square region of 250 m at a place near the equator."""
    return feature(
        name, "roi", "Polygon", square(east_km * KM_DEG, north_km * KM_DEG, 0.25 * KM_DEG), **properties
    )


def document(*regions: dict[str, Any], **vehicle: float) -> dict[str, Any]:
    """Regions, start and end in the west and the east, an aircraft with limits."""
    asked = small()
    asked["features"] = [
        *regions,
        feature("start", "start", "Point", [-2.5 * KM_DEG, 0.0]),
        feature("end", "end", "Point", [2.5 * KM_DEG, 0.0]),
    ]
    asked["vehicles"] = [{**asked["vehicles"][0], **vehicle}]
    return asked


def plan(asked: dict[str, Any]) -> Plan:
    """The plan, as it comes back from GeoJSON."""
    return read_plan(write_plan(make_plan(read_scenario(asked))))


def left_out(found: Plan) -> set[str]:
    """Names of what is left out; what is flown is seen whole, the rest not, and both are said."""
    names = {each.roi for each in found.metrics.left_out}
    for name, share in found.metrics.coverage.items():
        assert (share == 1.0) == (name not in names)
    assert {each.roi for each in found.uncovered} == names
    assert {name for collect in found.collects for name in collect.regions}.isdisjoint(names)
    return names


@pytest.mark.parametrize(
    ("name", "vehicle"),
    [
        ("max_range_m", {"max_range_m": 4_000.0}),
        ("max_flight_time_s", {"max_flight_time_s": 120.0}),
    ],
)
def test_what_a_violated_limit_is_said_to_need_does(name: str, vehicle: dict[str, float]) -> None:
    """With the value that the violation names the same regions are planned without it."""
    asked = document(roi("A", 0.0, 1.0), **vehicle)
    (said,) = plan(asked).hard_violations
    found = re.search(rf"Set {name} to ([\d.]+) or more", said.message)
    assert found is not None
    asked["vehicles"][0][name] = float(found[1])
    assert plan(asked).hard_violations == ()


LIMITS = {
    "range": {"max_range_m": 12_000.0},
    "flight-time": {"max_flight_time_s": 600.0},
    "energy": {"energy_wh": 40.0, "reserve": 0.25, "cruise_power_w": POWER_W},
}


@pytest.mark.parametrize("reason", LIMITS)
@pytest.mark.parametrize("routing", ["joint", "li2018"])
def test_what_is_too_far_is_left_out_and_said(reason: str, routing: str) -> None:
    """Twenty kilometres against a limit of twelve, of which the required part takes five."""
    far = roi("FAR", 0.0, 8.8, required=False, priority=0.1)
    asked = document(roi("R", 0.0, 0.0), far, **LIMITS[reason])
    found = plan(asked | {"method": {"routing": routing}})
    assert found.hard_violations == ()
    assert left_out(found) == {"FAR"}
    (said,) = found.metrics.left_out
    assert said.reason == reason
    whole = plan(document(roi("R", 0.0, 0.0), far, cruise_power_w=POWER_W) | {"method": {"routing": routing}})
    with_it = {
        "range": whole.paths[0].length_m - 12_000.0,
        "flight-time": whole.paths[0].duration_s - 600.0,
        "energy": (whole.paths[0].energy_wh or 0.0) - 30.0,
    }
    assert said.margin == pytest.approx(with_it[reason], rel=1e-6, abs=2e-3)
    assert any("FAR" in warning for warning in found.warnings)


def test_the_reserve_is_kept() -> None:
    """Without a word a fifth of the energy is; the judge counts as the planner does."""
    region = roi("R", 0.0, 0.0)
    free = plan(document(region, cruise_power_w=POWER_W))
    needed_wh = free.paths[0].energy_wh
    assert needed_wh is not None
    enough, short = needed_wh / 0.8 * 1.001, needed_wh / 0.8 * 0.999
    assert plan(document(region, cruise_power_w=POWER_W, energy_wh=enough)).violations == ()
    with pytest.raises(InfeasibleError, match="to see R and come home") as refused:
        plan(document(region, cruise_power_w=POWER_W, energy_wh=short))
    assert refused.value.constraint == "energy"
    kept = document(region, cruise_power_w=POWER_W, energy_wh=short, reserve=0.1)
    assert plan(kept).violations == ()


@pytest.mark.parametrize("dear", ["N", "S"])
def test_of_two_as_far_the_one_of_higher_priority_is_flown(dear: str) -> None:
    """Regions mirrored in the line from start to end: priority alone decides."""
    regions = [
        roi(name, 0.0, north_km, required=False, priority=2.0 if name == dear else 1.0)
        for name, north_km in (("N", 3.0), ("S", -3.25))
    ]
    both_m = plan(document(roi("R", 0.0, 0.0), *regions)).paths[0].length_m
    found = plan(document(roi("R", 0.0, 0.0), *regions, max_range_m=0.9 * both_m))
    assert found.hard_violations == ()
    assert left_out(found) == {"N", "S"} - {dear}


def test_what_is_required_is_flown_beyond_the_limit_and_that_is_a_violation() -> None:
    """All that is optional goes, and the judge says what the rest is over by."""
    asked = document(roi("R", 0.0, 6.0), roi("O", 0.5, 6.0, required=False), max_range_m=9_000.0)
    found = plan(asked)
    assert left_out(found) == {"O"}
    assert [v.constraint for v in found.hard_violations] == ["range"]


def test_what_the_battery_does_not_bring_home_is_refused_with_what_would_help() -> None:
    """By how much it is too little, and what is nearest: so much more energy, or the one region left out."""
    regions = [roi("R", 0.0, 0.0), roi("FAR", 0.0, 9.0)]
    whole = plan(document(*regions, cruise_power_w=POWER_W))
    needed_wh = whole.paths[0].energy_wh
    assert needed_wh is not None
    asked = document(*regions, cruise_power_w=POWER_W, energy_wh=round(needed_wh, 1))
    with pytest.raises(InfeasibleError) as refused:
        plan(asked)
    found = refused.value
    assert (found.constraint, found.feature) == ("energy", asked["vehicles"][0]["name"])
    told = re.fullmatch(
        r"Give it ([0-9.]+) Wh more energy_wh, or batteries to change, or leave out FAR \(required false\)\.",
        found.relaxation,
    )
    assert told is not None
    more_wh = float(told[1])
    assert more_wh == pytest.approx(needed_wh / 0.8 - needed_wh, abs=0.2)
    asked["vehicles"][0]["energy_wh"] += more_wh
    assert plan(asked).violations == ()
    asked["vehicles"][0]["energy_wh"] -= more_wh
    next(f for f in asked["features"] if f["id"] == "FAR")["properties"]["required"] = False
    assert left_out(plan(asked)) == {"FAR"}


def test_nothing_to_fly_is_refused_by_the_limit() -> None:
    """Where no region is required and none fits there is no plan."""
    with pytest.raises(InfeasibleError) as refused:
        plan(document(roi("O", 0.0, 9.0, required=False), max_range_m=9_000.0))
    assert refused.value.constraint == "range"


@pytest.mark.parametrize("seed", range(3))
def test_the_rest_fits_and_no_more_does(seed: int) -> None:
    """Random regions and limits: required ones are flown, the flight fits, nothing left out does besides."""
    rng = np.random.default_rng(seed)
    regions = [roi("R", 0.0, 0.0)]
    for index in range(4):
        angle, far_km = rng.uniform(0.0, math.tau), rng.uniform(1.0, 6.0)
        place = (far_km * math.cos(angle), far_km * math.sin(angle))
        priority = round(float(rng.uniform(0.1, 5.0)), 2)
        regions.append(roi(f"O{index}", *place, required=False, priority=priority))
    all_m = plan(document(*regions)).paths[0].length_m
    limit_m = float(rng.uniform(0.5, 0.95)) * all_m
    found = plan(document(*regions, max_range_m=limit_m))
    names = left_out(found)
    assert names
    assert "R" not in names
    assert found.hard_violations == ()
    assert found.paths[0].length_m <= limit_m
    for name in names:
        besides = [each for each in regions if each["id"] not in names - {name}]
        assert plan(document(*besides)).paths[0].length_m > limit_m
