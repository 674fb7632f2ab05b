"""Squint, spotlight and ScanSAR: formulas against geometry, readers, plans judged whole."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from app.services.terrain.rasters import read_raster
from planner.check import footprint
from planner.errors import InfeasibleError, ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Collect, Plan, Ring
from planner.sensors import sar_modes
from planner.sensors.sar import SarSensor
from tests.planner.scenarios import feature, small
from tests.planner.terrains import raster

FAULTS = Path(__file__).parents[2] / "faults"
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


def test_scansar_pays_for_width_with_resolution() -> None:
    """Three sub-swaths see three beams' width at four times the resolution cell."""
    sensor = BASE | {"elevation_beamwidth_deg": 10.0, "mode": "scansar", "sub_swaths": 3, "resolution_m": 1.0}
    (wide,) = read_scenario(with_sensor(sensor)).sensors
    (plain,) = read_scenario(with_sensor(BASE)).sensors
    assert isinstance(wide, SarSensor)
    assert isinstance(plain, SarSensor)
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
    assert isinstance(one, SarSensor)
    assert isinstance(other, SarSensor)
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
    (sensor,) = scenario.sensors
    assert isinstance(sensor, SarSensor)
    wider_m = sensor.aperture_m(500.0) / 2.0
    assert reach(ahead)[0] == pytest.approx(nearest_m + wider_m, abs=1e-6)
    assert reach(ahead)[0] > reach(abeam)[0]
    assert reach(ahead)[1] > reach(abeam)[1]


def test_spotlight_flies_a_line_as_long_as_its_resolution_asks() -> None:
    """A target is seen from a straight line long enough for all of the spot, and not much longer."""
    plan = planned(with_sensor(SPOT, target_m=1.0), on_terrain=False)
    assert plan.violations == ()
    (collect,) = plan.collects
    worst = worst_m(collect, plan.footprints[0].ring, plan.home, 0.031)
    assert 0.1 * 0.97 <= worst <= 0.1 * (1.0 + 1e-6)
    assert plan.footprints[0].resolution_m == 0.1


def worst_m(collect: Collect, ring: Ring, origin: tuple[float, float], wavelength_m: float) -> float:
    """The worst resolution along the track over a footprint, by the phases of echoes along the flown line.

    A place moved along the track by δ turns the two-way phase 4π/λ · r by a whole turn more, from one end of
    the aperture to the other, than the place itself: r is measured in three dimensions, over flat ground.
    """
    frame = LocalFrame(*origin)
    first, last = (np.array([*frame.to_local(place[:2]), place[2]]) for place in collect.line)
    along = (last - first) / np.linalg.norm(last - first)
    shape = shapely.Polygon(frame.to_local(ring))
    edge = shape.exterior.segmentize(shape.length / 200.0)
    worst = 0.0
    for east_m, north_m in edge.coords:
        place = np.array([east_m, north_m, 0.0])
        step_m = 1e-3
        turns = [
            2.0 / wavelength_m * (np.linalg.norm(end - place - step_m * along) - np.linalg.norm(end - place))
            for end in (first, last)
        ]
        worst = max(worst, step_m / abs(turns[0] - turns[1]))
    return worst


@settings(max_examples=25, deadline=None)
@given(
    incidence_deg=st.floats(30.0, 60.0),
    beam_deg=st.floats(4.0, 38.0),
    azimuth_deg=st.floats(2.0, 12.0),
    squint_deg=st.floats(-45.0, 45.0),
    turned=st.floats(0.03, 0.8),
    look=st.sampled_from(["left", "right"]),
)
def test_all_of_a_spot_is_as_fine_as_promised(
    incidence_deg: float, beam_deg: float, azimuth_deg: float, squint_deg: float, turned: float, look: str
) -> None:
    """Wherever the footprint of a spotlight pass is, its resolution is that of the sensor or finer."""
    squint_rad = math.radians(squint_deg)
    resolution_m = sar_modes.azimuth_resolution_m(0.03, turned, squint_rad)
    sensor = BASE | {
        "mode": "spotlight", "wavelength_m": 0.03, "resolution_m": resolution_m,
        "incidence_deg": incidence_deg,
        "elevation_beamwidth_deg": beam_deg, "azimuth_beamwidth_deg": azimuth_deg, "squint_deg": squint_deg,
        "look": look,
    }  # fmt: skip
    document = with_sensor(sensor, target_m=1.0, altitude_m=2000.0)
    document["features"] = [f for f in document["features"] if f["properties"]["role"] != "area"]
    plan = make_plan(read_scenario(document))
    assert plan.violations == ()
    (collect,), (footprint_,) = plan.collects, plan.footprints
    worst = worst_m(collect, footprint_.ring, plan.home, 0.03)
    assert worst <= resolution_m * (1.0 + 1e-5)
    assert footprint_.resolution_m == pytest.approx(resolution_m)


@pytest.mark.parametrize("on_terrain", [False, True])
@pytest.mark.parametrize("squint_deg", [-40.0, -15.0, 28.0, 45.0])
def test_a_squinted_spot_lies_on_its_target(squint_deg: float, on_terrain: bool) -> None:
    """Forward, backward, on flat ground or hills, the spot holds the target, and flown exactly sees it."""
    document = with_sensor(SPOT | {"squint_deg": squint_deg, "azimuth_beamwidth_deg": 12.0}, target_m=20.0)
    plan = planned(document, on_terrain)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}


def test_a_raster_of_one_height_changes_nothing() -> None:
    """Squinted spots on a flat raster are seen as over flat ground, on lines of the same length."""
    document = json.loads((FAULTS / "spotlight_squint_terrain.geojson").read_text())
    flat = read_raster((FAULTS / "flat300.tif").read_bytes(), "flat300.tif", "t")
    plain = make_plan(read_scenario(document))
    on_raster = make_plan(read_scenario(document | {"terrain": "t"}, {"t": flat}))
    assert on_raster.violations == plain.violations == ()
    assert on_raster.metrics.length_m == pytest.approx(plain.metrics.length_m, rel=5e-3)


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
