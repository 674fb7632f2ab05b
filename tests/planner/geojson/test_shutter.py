"""Photos no faster than the camera takes them: slower flights, or refusals with what would work."""

from __future__ import annotations

import re
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.errors import Finding, ScenarioError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.scenarios import small

Document = dict[str, Any]


def document(interval_s: float, vehicle: Document | None = None, **members: Any) -> Document:
    """From 100 m, one photo every 19.58 m: at 20 m/s one every 0.979 s."""
    eye = {"name": "eye", "type": "camera", "model": "Sony a6000 20 mm", "min_interval_s": interval_s}
    made = small(sensors=[eye], altitude_m=100.0, **members)
    made["vehicles"][0] |= vehicle or {}
    return made


def refused(made: Document) -> list[Finding]:
    with pytest.raises(ScenarioError) as error:
        read_scenario(made)
    return [finding for finding in error.value.findings if finding.severity == "error"]


def test_what_the_camera_keeps_is_flown_as_asked() -> None:
    """At 0.97 s nothing changes; at 0.98 s wings of one speed are refused."""
    assert read_scenario(document(0.97)).aircraft[0].airspeed_m_s == 20.0
    found = refused(document(0.99))
    assert {(f.feature, f.rule) for f in found} == {("A", "interval-too-short"), ("B", "interval-too-short")}


@pytest.mark.parametrize("vehicle", [{"type": "multirotor"}, {"min_airspeed_m_s": 5.0}])
def test_what_can_flies_slower_and_says_so(vehicle: Document) -> None:
    """At 2 s: 9.79 m/s over the ground, by hand; wings at 100 m are 0.48 % faster than their airspeed."""
    scenario = read_scenario(document(2.0, vehicle))
    airspeed_m_s = scenario.aircraft[0].airspeed_m_s * (1.0 if "type" in vehicle else 1.0048)
    assert airspeed_m_s == pytest.approx(19.5833 / 2.0, abs=0.011)
    assert "speed-lowered" in {w.rule for w in scenario.warnings}
    plan = make_plan(scenario)
    assert "photo-interval" not in {v.constraint for v in plan.violations}
    assert "overlap" not in {v.constraint for v in plan.violations}
    assert plan.vehicles[0].airspeed_m_s == scenario.aircraft[0].airspeed_m_s


def test_a_video_needs_no_time() -> None:
    """Nor does a camera whose shortest interval is not known."""
    video = document(5.0)
    video["sensors"][0]["trigger"] = "video"
    assert read_scenario(video).aircraft[0].airspeed_m_s == 20.0
    assert read_scenario(document(0.0)).aircraft[0].airspeed_m_s == 20.0


def test_across_a_wind_there_is_time_where_along_it_there_is_none() -> None:
    """20 m/s in 12 m/s: 16 m/s across, 32 m/s with it. Lanes that may only lie along it are refused."""
    windy = document(1.0, wind={"speed_m_s": 12.0, "from_deg": 270.0})
    windy["sensors"][0]["forward_overlap"] = 0.65
    windy["features"] = [each for each in windy["features"] if each["id"] != "B"]
    plan = make_plan(read_scenario(windy))
    assert "photo-interval" not in {v.constraint for v in plan.violations}
    windy["features"][0]["properties"]["approach_deg"] = [90.0, 270.0]
    assert {f.rule for f in refused(windy)} == {"interval-too-short"}


@pytest.mark.parametrize(
    ("interval_s", "wind_m_s", "overlap"), [(1.05, 0.0, 0.75), (6.0, 0.0, 0.3), (2.5, 9.0, 0.6)]
)
def test_each_value_that_a_refusal_names_works(interval_s: float, wind_m_s: float, overlap: float) -> None:
    """A lower overlap, a greater height, a lower speed: each by itself."""
    made = document(interval_s, wind={"speed_m_s": wind_m_s, "from_deg": 40.0})
    made["sensors"][0]["forward_overlap"] = overlap
    fix = next(finding.fix for finding in refused(made))
    lower = re.findall(r"forward_overlap to ([\d.]+)", fix)
    higher = re.findall(r"from ([\d.]+) m", fix)
    slower = re.findall(r"at ([\d.]+) m/s", fix)
    assert higher
    assert slower
    for values, change in (
        (lower, lambda d, v: d["sensors"][0].update(forward_overlap=v)),
        (higher, lambda d, v: d.update(altitude_m=v)),
        (slower, lambda d, v: d["vehicles"][0].update(min_airspeed_m_s=v)),
    ):
        for value in values:
            helped = document(interval_s, wind={"speed_m_s": wind_m_s, "from_deg": 40.0})
            helped["sensors"][0]["forward_overlap"] = overlap
            change(helped, float(value))
            read_scenario(helped)


@settings(deadline=None, max_examples=40)
@given(
    st.floats(-3.0, 9.5), st.floats(0.0, 0.9999), st.floats(3.0, 60.0), st.floats(0.0, 0.95),
    st.sampled_from(["fixed_wing", "multirotor"]), st.sampled_from([None, 120.0, 400.0]),
)  # fmt: skip
def test_no_figure_of_a_refusal_leaves_what_can_be(
    magnitude: float, share: float, airspeed_m_s: float, overlap: float, kind: str, highest_m: float | None
) -> None:
    """Whatever interval, wind and airspeed: figures are positive, and what is named may be asked for."""
    members: Document = {"wind": {"speed_m_s": share * airspeed_m_s, "from_deg": 40.0}}
    if highest_m is not None:
        members["max_height_m"] = highest_m
    vehicle = {"type": kind, "airspeed_m_s": airspeed_m_s}

    def again() -> Document:
        made = document(10.0**magnitude, vehicle, **members)
        made["sensors"][0] |= {"forward_overlap": overlap, "stabilised": True}
        return made

    try:
        scenario = read_scenario(again())
    except ScenarioError as error:
        findings = error.findings
    else:
        findings = scenario.warnings
        assert 0.0 < scenario.aircraft[0].airspeed_m_s <= airspeed_m_s
    for finding in findings:
        figures = [float(each) for each in re.findall(r"(?<![\w.])-?[\d.]*\d(?:e[+-]\d+)?(?= )", finding.fix)]
        assert all(figure > 0.0 for figure in figures if "overlap" not in finding.fix), finding
        said = re.findall(r"(?:takes|lies|every|at) (-?[\d.]*\d(?:e[+-]\d+)?|nan|inf)", finding.message)
        assert all(float(each) >= 0.0 for each in said), finding
        for value in re.findall(r"from ([\d.e+]+) m over its ground", finding.fix):
            assert float(value) <= min(highest_m or 30_000.0, 30_000.0)
        for value in re.findall(r"min_interval_s ([\d.e+-]+) or less", finding.fix):
            helped = again()
            helped["sensors"][0]["min_interval_s"] = float(value)
            try:
                told = read_scenario(helped).warnings
            except ScenarioError as error:
                told = error.findings
            assert (finding.feature, finding.rule) not in {(each.feature, each.rule) for each in told}
