"""Squint, spotlight and ScanSAR: formulas against geometry, readers, plans judged whole."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.check import footprint
from planner.errors import InfeasibleError, ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.sensors import sar_modes
from tests.planner.scenarios import feature, small
from tests.planner.terrains import raster

BASE = small()["sensors"][0]
SPOT = BASE | {"mode": "spotlight", "resolution_m": 0.1, "wavelength_m": 0.031}
MIDDLE = LocalFrame(0.01, 0.01)


def with_sensor(sensor: dict[str, Any], *, target_m: float | None = None, **members: Any) -> dict[str, Any]:
    """The small scenario with one sensor, on a target instead of its regions where a radius is given."""
    document = small(sensors=[sensor], **members)
    if target_m is not None:
        document["features"] = [f for f in document["features"] if f["properties"]["role"] != "roi"]
        document["features"].append(feature("P", "roi", "Point", [0.02, 0.02], radius_m=target_m))
    return document


@given(st.floats(0.01, 0.3), st.floats(0.01, 0.8))
def test_resolution_and_turn_are_inverse(wavelength_m: float, turned: float) -> None:
    """The turn asked for a resolution gives that resolution."""
    resolution_m = sar_modes.azimuth_resolution_m(wavelength_m, turned)
    assert sar_modes.turned_for_rad(wavelength_m, resolution_m) == pytest.approx(turned)


def test_stripmap_resolves_half_its_antenna() -> None:
    """An antenna of D metres has the beam λ/D and resolves D/2."""
    assert sar_modes.azimuth_resolution_m(0.03, 0.03 / 2.0) == pytest.approx(1.0, rel=1e-4)


@given(st.floats(200.0, 5000.0), st.floats(0.02, 0.8))
def test_the_spotlight_line_turns_as_asked(range_m: float, turned: float) -> None:
    """From the place, the ends of the line are the asked angle apart."""
    length_m = sar_modes.spotlight_aperture_m(range_m, turned)
    ends = np.array([[length_m / 2.0, range_m], [-length_m / 2.0, range_m]])
    apart = math.acos(float(ends[0] @ ends[1]) / float(np.hypot(*ends.T).prod()))
    assert apart == pytest.approx(turned)


@given(st.floats(200.0, 5000.0), st.floats(-0.8, 0.8))
def test_short_lines_are_alike_in_both_modes(range_m: float, squint: float) -> None:
    """A line that turns by no more than the beam is the line along which the beam holds the place."""
    spotlight_m = sar_modes.spotlight_aperture_m(range_m, 0.01, squint)
    assert spotlight_m == pytest.approx(sar_modes.stripmap_aperture_m(range_m, 0.01, squint), rel=1e-4)


def test_scansar_pays_for_width_with_resolution() -> None:
    """Three sub-swaths see three beams' width at four times the resolution cell."""
    sensor = BASE | {"elevation_beamwidth_deg": 10.0, "mode": "scansar", "sub_swaths": 3, "resolution_m": 1.0}
    (wide,) = read_scenario(with_sensor(sensor)).sensors
    (plain,) = read_scenario(with_sensor(BASE)).sensors
    assert wide.swath_m(500.0) == pytest.approx(plain.swath_m(500.0))
    assert wide.resolution_m == 4.0
    assert wide.aperture_m(500.0) == pytest.approx(plain.aperture_m(500.0))


@pytest.mark.parametrize(
    ("sensor", "rule"),
    [
        (BASE | {"squint_deg": 75.0}, "out-of-range"),
        (BASE | {"mode": "inverse"}, "unknown-value"),
        (BASE | {"mode": "spotlight"}, "missing-property"),
        (BASE | {"mode": "spotlight", "resolution_m": 1.0}, "missing-property"),
        (SPOT | {"resolution_m": 0.01}, "out-of-range"),
        (BASE | {"sub_swaths": 3}, "bad-value"),
        (BASE | {"mode": "scansar", "sub_swaths": 4}, "swath-not-positive"),
    ],
)
def test_refusals(sensor: dict[str, Any], rule: str) -> None:
    """Modes that cannot be are refused by name."""
    with pytest.raises(ScenarioError) as caught:
        read_scenario(with_sensor(sensor))
    assert [finding.rule for finding in caught.value.findings] == [rule]


def test_frequency_gives_the_wavelength() -> None:
    """A spotlight sensor given by frequency plans as one given by wavelength."""
    by_frequency = {k: v for k, v in SPOT.items() if k != "wavelength_m"} | {
        "frequency_hz": 299_792_458.0 / 0.031
    }
    one = read_scenario(with_sensor(SPOT)).sensors[0]
    other = read_scenario(with_sensor(by_frequency)).sensors[0]
    assert one.turned_rad == pytest.approx(other.turned_rad)


@pytest.mark.parametrize("on_terrain", [False, True])
@pytest.mark.parametrize("squint_deg", [-30.0, 12.0])
def test_squinted_plans_cover_their_regions(squint_deg: float, on_terrain: bool) -> None:
    """Squinted passes see every region, as the judge measures it."""
    plan = planned(with_sensor(BASE | {"squint_deg": squint_deg}), on_terrain)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}


def test_squinted_ground_lies_ahead_of_the_line() -> None:
    """With a forward squint the ground seen begins and ends ahead of what the same line sees abeam."""
    document = with_sensor(BASE | {"squint_deg": 20.0})
    scenario = read_scenario(document)
    collect = make_plan(scenario).collects[0]
    abeam = footprint(read_scenario(with_sensor(BASE)), collect)
    ahead = footprint(scenario, collect)
    first, last = scenario.frame.to_local([p[:2] for p in collect.line])
    along = (last - first) / np.hypot(*(last - first))

    def reach(shape: Any) -> tuple[float, float]:
        places = (np.asarray(shape.exterior.coords) - first) @ along
        return float(places.min()), float(places.max())

    nearest_m = 500.0 / math.cos(math.radians(30.0)) * math.tan(math.radians(20.0))
    wider_m = scenario.sensors[0].aperture_m(500.0) / 2.0
    assert reach(ahead)[0] == pytest.approx(nearest_m + wider_m, abs=1e-6)
    assert reach(ahead)[0] > reach(abeam)[0]
    assert reach(ahead)[1] > reach(abeam)[1]


@pytest.mark.parametrize("on_terrain", [False, True])
def test_spotlight_flies_a_line_as_long_as_its_resolution_asks(on_terrain: bool) -> None:
    """A target is seen from a straight line that turns round it by the angle for the resolution."""
    plan = planned(with_sensor(SPOT, target_m=10.0), on_terrain)
    assert plan.violations == ()
    (collect,) = plan.collects
    height_m = 500.0
    shortest_m = sar_modes.spotlight_aperture_m(
        height_m / math.cos(math.radians(45.0)), sar_modes.turned_for_rad(0.031, 0.1)
    )
    assert shortest_m <= collect.end_m - collect.start_m <= shortest_m + 40.0
    assert plan.footprints[0].resolution_m == 0.1


def test_a_region_larger_than_the_spot_is_refused() -> None:
    """Spotlight holds a small spot: larger regions are infeasible, by name."""
    with pytest.raises(InfeasibleError) as caught:
        make_plan(read_scenario(with_sensor(SPOT, target_m=150.0)))
    assert caught.value.constraint == "spotlight"


def planned(document: dict[str, Any], on_terrain: bool) -> Plan:
    """The plan, on flat ground or among gentle hills."""
    if not on_terrain:
        return make_plan(read_scenario(document))
    hills = raster(lambda e, n: 100.0 + 40.0 * np.sin(e / 700.0) * np.cos(n / 900.0), MIDDLE)
    return make_plan(read_scenario(document | {"terrain": "t"}, {"t": hills}))
