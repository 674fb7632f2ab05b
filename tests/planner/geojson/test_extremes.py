"""Numbers, counts and texts beyond anything that flies: each is a finding or fine, never an error of ours."""

from __future__ import annotations

import math
from typing import Any

import pytest

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.validate import findings
from tests.planner.scenarios import feature, small, square

EXTREMES = (
    1e308, -1e308, 1e-308, 1e13, 1e-13, 0, -0.0, 10**30, 10**400, math.nan, math.inf, True, "1",
)  # fmt: skip
POWER = {"energy_wh": 100.0, "power": {"model": "multirotor", "mass_kg": 2.0, "rotor_diameter_m": 0.3}}
NUMBERS: dict[str, tuple[str, ...]] = {
    "top": ("altitude_m", "min_height_m", "max_height_m", "clearance_m", "time_budget_s", "seed"),
    "vehicle": (
        "airspeed_m_s", "min_airspeed_m_s", "min_turn_radius_m", "max_bank_deg", "max_load_factor",
        "max_climb_deg", "energy_wh", "reserve", "max_range_m", "max_flight_time_s", "settle_m",
        "batteries", "turnaround_s", "charge_mah", "voltage_v",
    ),
    "power": (
        "mass_kg", "rotors", "rotor_diameter_m", "disc_area_m2", "figure_of_merit", "efficiency",
        "drag_area_m2", "avionics_w",
    ),
    "sensor": (
        "incidence_deg", "elevation_beamwidth_deg", "azimuth_beamwidth_deg", "aperture_length_m",
        "wavelength_m", "frequency_hz", "resolution_m", "squint_deg", "sub_swaths",
    ),
    "roi": ("priority", "min_resolution_m", "gsd_m", "min_niirs", "altitude_m", "revisits"),
    "corridor": ("width_m",),
    "threat": ("radius_m", "intensity_m", "height_m"),
    "no_fly": ("radius_m", "floor_m", "ceiling_m"),
    "obstacle": ("height_m", "base_m"),
}  # fmt: skip
PLACES = [(owner, name) for owner, names in NUMBERS.items() for name in names]


def with_value(owner: str, name: str, value: Any) -> dict[str, Any]:
    """The small scenario with one number of it replaced."""
    more = {
        "corridor": feature("X", "roi", "LineString", [[0.02, 0.02], [0.03, 0.02]], width_m=50.0),
        "threat": feature(
            "X", "threat", "Point", [0.02, 0.02], model="radar", radius_m=90.0, intensity_m=9.0
        ),
        "no_fly": feature("X", "no_fly", "Point", [0.02, 0.02], radius_m=90.0),
        "obstacle": feature("X", "obstacle", "Polygon", square(0.02, 0.02, 0.001), height_m=30.0),
    }
    document = small(*([more[owner]] if owner in more else []))
    if owner == "power":
        document["vehicles"][0] |= {**POWER, "power": dict(POWER["power"])}
    target = {
        "top": document,
        "vehicle": document["vehicles"][0],
        "power": document["vehicles"][0].get("power"),
        "sensor": document["sensors"][0],
        "roi": document["features"][0]["properties"],
    }.get(owner, document["features"][-1]["properties"])
    target[name] = value
    return document


@pytest.mark.parametrize(("owner", "name"), PLACES)
def test_extremes_are_findings_or_fine(owner: str, name: str) -> None:
    """No number in any place ends a judgement in an error; what no unit reaches is out of range by name."""
    for value in EXTREMES:
        found = findings(with_value(owner, name, value))
        assert all(each.message and each.fix for each in found)
        if not isinstance(value, str) and 1e12 < abs(value) < 1e300:
            assert any(name in each.message and each.severity == "error" for each in found), value


@pytest.mark.parametrize(
    ("document", "rule"),
    [
        (with_value("roi", "approach_deg", [k / 10.0 for k in range(3600)]), "too-many-headings"),
        (with_value("vehicle", "name", "x" * 100_000), "too-long"),
        (with_value("vehicle", "batteries", 10**6), "out-of-range"),
    ],
    ids=["headings", "name", "batteries"],
)
def test_long_lists_and_texts_are_refused(document: dict[str, Any], rule: str) -> None:
    """By name, before anything is planned with them."""
    assert rule in {finding.rule for finding in findings(document)}


@pytest.mark.parametrize("width_m", [0.001, 0.1])
def test_the_narrowest_corridor_is_planned(width_m: float) -> None:
    """What is let in is seen."""
    plan = make_plan(read_scenario(with_value("corridor", "width_m", width_m)))
    assert plan.violations == ()
    assert plan.metrics.coverage["X"] == 1.0
