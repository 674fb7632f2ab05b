"""Crab as squint: the strip of a fixed antenna in the wind, against rays solved one by one, and plans."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from shapely.geometry import Polygon

from planner.airspace.values import Wind
from planner.check import footprint, judge
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.plan import Plan
from planner.route import Look
from planner.scenario import Scenario
from planner.sensors import view_kernels
from planner.sensors.sar import SarSensor
from planner.sensors.strip import aperture_m, lead_m, strip_on
from planner.sensors.view import seen_on_flat, seen_on_terrain
from planner.tasks.setting import Setting
from planner.vehicle.wind import crab_rad
from tests.planner.scenarios import case, feature, small, square
from tests.planner.terrains import grid, raster

HEIGHT_M = 500.0
PLAIN = SarSensor("s", math.radians(45.0), math.radians(30.0), math.radians(10.0))
looks = st.sampled_from(["left", "right"])
courses = st.floats(-math.pi, math.pi)
drifts = st.floats(0.01, 0.6)
squints = st.floats(-0.35, 0.35)


def ray(sensor: SarSensor, look: Look, course: float, look_rad: float, drop_m: float) -> Any:
    """Where a ray of the antenna on the crabbing aircraft meets the ground: ahead and to the look side.

    Vectors, not formulas: the nose from the wind triangle, the ray by rotating the boresight.
    """
    toward = sensor.toward_rad
    # Ground velocity along the course; less the wind it has the airspeed, here 1.
    wind = sensor.drift * np.array([math.cos(toward), math.sin(toward)])
    ahead = np.array([math.cos(course), math.sin(course)])
    speed = brentq(lambda v: np.hypot(*(v * ahead - wind)) - 1.0, 1e-6, 3.0)
    nose2 = speed * ahead - wind
    nose = np.array([*nose2, 0.0])
    right = np.array([nose2[1], -nose2[0], 0.0]) * (1.0 if look == "right" else -1.0)
    down = np.array([0.0, 0.0, -1.0])
    abeam = math.sin(look_rad) * right + math.cos(look_rad) * down
    beam = math.cos(sensor.squint_rad) * abeam + math.sin(sensor.squint_rad) * nose
    hit = beam * (drop_m / -beam[2])
    side = np.array([ahead[1], -ahead[0]]) * (1.0 if look == "right" else -1.0)
    return float(hit[:2] @ ahead), float(hit[:2] @ side)


@given(courses, drifts, courses, looks, squints, st.floats(0.0, 1.0))
def test_rays_meet_the_ground_where_leads_say(
    course: float, drift: float, toward: float, look: Look, squint: float, share: float
) -> None:
    """Ground beside the track is seen as far ahead as a ray of vectors has it; the kernel agrees."""
    sensor = replace(PLAIN, squint_rad=squint).in_wind(drift, toward)
    look_rad = sensor.steepest_rad + share * sensor.elevation_beamwidth_rad
    ahead_m, out_m = ray(sensor, look, course, look_rad, HEIGHT_M)
    yaw = float(sensor.yaw_rad(course, look))
    if out_m < 1.0 or abs(yaw) + abs(squint) > 1.0:
        return
    assert float(lead_m(squint, yaw, out_m, HEIGHT_M)) == pytest.approx(ahead_m, abs=1e-6)
    assert view_kernels.lead_m(out_m, HEIGHT_M, math.tan(squint), yaw) == pytest.approx(ahead_m, abs=1e-6)


@given(courses, drifts, courses, looks, squints)
def test_the_aperture_is_that_of_the_beam_s_angles(
    course: float, drift: float, toward: float, look: Look, squint: float
) -> None:
    """Flown past a place in mid-beam, the angle to the antenna's axis changes by θ_A over one aperture."""
    sensor = replace(PLAIN, squint_rad=squint, azimuth_beamwidth_rad=1e-4).in_wind(drift, toward)
    yaw = float(sensor.yaw_rad(course, look))
    ahead_m, out_m = ray(sensor, look, course, sensor.incidence_rad, HEIGHT_M)
    nose = np.array([math.cos(yaw), math.sin(yaw), 0.0])

    def off_axis(flown_m: float) -> float:
        way = np.array([ahead_m - flown_m, -out_m, -HEIGHT_M])
        return math.asin(float(nose @ way) / float(np.linalg.norm(way)))

    half_m = float(aperture_m(sensor, HEIGHT_M, yaw)) / 2.0
    # In these axes the look side is at −out; a beam turned forward has the nose turned away from it.
    assert off_axis(0.0) == pytest.approx(squint, abs=1e-9)
    assert off_axis(-half_m) - off_axis(half_m) == pytest.approx(1e-4, rel=1e-5)


@given(
    courses, drifts, courses, looks, squints, st.floats(0.0, 80.0), st.floats(0.0, 0.03), st.floats(0.0, 10.0)
)
@settings(max_examples=60)
def test_ground_in_the_strip_is_seen_whatever_its_height(
    course: float, drift: float, toward: float, look: Look, squint: float,
    relief_m: float, pointing: float, position_m: float,
) -> None:  # fmt: skip
    """Of a line laid by the strip, ground across it at any height of the relief is seen, margins or not."""
    sensor = replace(
        PLAIN,
        squint_rad=squint,
        relief_m=relief_m,
        pointing_margin_rad=pointing,
        position_margin_m=position_m,
    ).in_wind(drift, toward)
    strip = strip_on(sensor, HEIGHT_M, course, look)
    if strip.swath_m[0] < 1.0 or abs(float(sensor.yaw_rad(course, look))) + abs(squint) > 0.9:
        return
    span_m = 100.0
    length_m = float(strip.run_in_m[0] + span_m + strip.run_out_m[0])
    ahead = np.array([math.cos(course), math.sin(course)])
    side = np.array([ahead[1], -ahead[0]]) * (1.0 if look == "right" else -1.0)
    for drop_m in (HEIGHT_M - relief_m, HEIGHT_M, HEIGHT_M + relief_m):
        seen = seen_on_flat(replace(sensor, relief_m=0.0), (0.0 * ahead, length_m * ahead), look, drop_m)
        corners = [
            (float(strip.run_in_m[0]) + x) * ahead
            + (float(strip.near_m[0]) + share * float(strip.swath_m[0])) * side
            for x in (0.0, span_m)
            for share in (0.0, 0.25, 0.5, 0.75, 1.0)
        ]
        assert all(
            seen.buffer(0.05).covers(Polygon(np.array([c, c + 0.01, c + np.array([0.01, 0.0])])))
            for c in corners
        )


@settings(deadline=None, max_examples=25)
@given(courses, drifts, courses, looks, squints)
def test_flat_terrain_sees_what_flat_ground_does(
    course: float, drift: float, toward: float, look: Look, squint: float
) -> None:
    """Cell by cell on a level raster, a crabbing antenna sees what it sees on flat ground in closed form."""
    sensor = replace(PLAIN, squint_rad=squint).in_wind(drift, toward)
    ahead = np.array([math.cos(course), math.sin(course)])
    line = (-700.0 * ahead, 700.0 * ahead)
    flat = seen_on_flat(sensor, line, look, HEIGHT_M)
    seen = seen_on_terrain(
        sensor, line, look, HEIGHT_M + 40.0, grid(lambda e, n: 40.0 + 0.0 * e, step_m=20.0)
    ).area
    assert seen.symmetric_difference(flat).area < 0.02 * flat.area + 3000.0


def in_crosswind(from_deg: float, speed_m_s: float = 8.0, **sensor: Any) -> Scenario:
    """Two small regions and one of several swaths, in a wind."""
    document = small(
        feature("X", "roi", "Polygon", square(-0.03, 0.02, 0.014)),
        wind={"speed_m_s": speed_m_s, "from_deg": from_deg},
    )
    document["sensors"][0].update(sensor)
    return read_scenario(document)


@pytest.mark.parametrize("look", ["right", "both"])
@pytest.mark.parametrize("squint_deg", [0.0, 12.0])
@pytest.mark.parametrize("from_deg", [20.0, 110.0, 270.0])
def test_plans_with_a_fixed_antenna_see_their_regions(from_deg: float, squint_deg: float, look: str) -> None:
    """The judge, who turns the antenna by the wind triangle, finds every region whole."""
    scenario = in_crosswind(from_deg, look=look, squint_deg=squint_deg)
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert set(judge(scenario, plan).coverage.values()) == {1.0}


@pytest.mark.parametrize("method", [{"coverage": "li2018"}, {"routing": "li2018-threat-aware"}])
def test_the_paper_s_methods_mind_the_crab_too(method: dict[str, str]) -> None:
    """By name the paper's coverage and routing see the first shared case whole in a crosswind."""
    plan = make_plan(
        read_scenario(case(1) | {"wind": {"speed_m_s": 8.0, "from_deg": 300.0}, "method": method})
    )
    assert not [v for v in plan.violations if v.constraint == "coverage"]


def test_a_plan_blind_to_the_crab_loses_ground() -> None:
    """Planned as if the antenna were steered, the regions are not seen by one that is fixed."""
    scenario = in_crosswind(20.0)
    steered = replace(scenario, sensors=tuple(replace(s, stabilised=True) for s in scenario.sensors))
    plan = make_plan(steered)
    assert plan.violations == ()
    assert min(judge(scenario, plan).coverage.values()) < 0.99
    assert min(judge(steered, make_plan(scenario)).coverage.values()) < 1.0


@pytest.mark.parametrize("squint_deg", [0.0, -15.0])
def test_published_footprints_are_the_judge_s(squint_deg: float) -> None:
    """What is published as seen is what the judge draws by rays."""
    scenario = in_crosswind(200.0, squint_deg=squint_deg)
    plan = make_plan(scenario)
    for collect, published in zip(plan.collects, plan.footprints, strict=True):
        judged = footprint(scenario, collect)
        ring = Polygon(scenario.frame.to_local(published.ring))
        assert ring.symmetric_difference(judged).area < 1e-3 * judged.area


def test_terrain_and_wind_together() -> None:
    """On hills in a crosswind a fixed antenna sees all, as the judge has it."""
    hills = raster(
        lambda e, n: 30.0 * np.sin(e / 300.0) * np.cos(n / 260.0), LocalFrame(0.01, 0.01), posts=801
    )
    document = small(wind={"speed_m_s": 9.0, "from_deg": 40.0}, terrain="t", clearance_m=10.0)
    scenario = read_scenario(document, {"t": hills})
    plan = make_plan(scenario)
    assert judge(scenario, plan).coverage == {"A": 1.0, "B": 1.0}
    assert plan.violations == ()


def test_stabilised_and_spotlight_antennas_do_not_crab() -> None:
    """They are steered: in the wind the strip is that of still air; plans have a bound either way."""
    for still in (replace(PLAIN, stabilised=True), replace(PLAIN, mode="spotlight", turned_rad=0.2)):
        sensor = still.in_wind(0.5, 1.0)
        assert not sensor.crabs
        assert float(strip_on(sensor, HEIGHT_M, 0.3, "right").near_m[0]) == still.near_m(HEIGHT_M)
    scenarios = [in_crosswind(20.0, stabilised=steered) for steered in (True, False)]
    plans: list[Plan] = [with_bound(each, make_plan(each), share=True) for each in scenarios]
    assert all(plan.metrics.gap is not None for plan in plans)
    assert plans[0].metrics.duration_s < plans[1].metrics.duration_s


def test_sensors_take_on_the_wind() -> None:
    """The beam of a fixed antenna turns by the crab: forward on one side, backward on the other."""
    scenario = in_crosswind(20.0)
    assert scenario.wind != Wind()
    (sensor,) = Setting.of(scenario).suite.sensors
    assert isinstance(sensor, SarSensor)
    course = np.linspace(-3.0, 3.0, 7)
    crab = crab_rad(course, scenario.aircraft[0].airspeed_m_s, scenario.wind)
    assert sensor.yaw_rad(course, "right") == pytest.approx(crab)
    assert sensor.yaw_rad(course, "left") == pytest.approx(-crab)


@pytest.mark.parametrize("drift", [0.0, 0.3])
def test_no_course_has_no_strip(drift: float) -> None:
    """Of no courses there are no strips, in wind and in still air."""
    sensor = read_scenario(small()).sensors[0].in_wind(drift, 0.4)
    assert len(strip_on(sensor, HEIGHT_M, np.empty(0), "right").swath_m) == 0
