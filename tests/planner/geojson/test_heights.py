"""Heights from the quality asked for: the greatest that gives it, within the bounds; else what would work."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from planner.check import judge
from planner.errors import Finding, ScenarioError
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.scenario import Scenario
from tests.planner.scenarios import small
from tests.planner.terrains import raster

Document = dict[str, Any]

#: 1 cm for each 50 m of height.
EYE = {
    "name": "eye", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 4e-6, "image_px": [6000, 4000],
    "rer": 0.92, "snr": 50.0,
}  # fmt: skip
#: NIIRS of equation 1 for a ground sampled distance of a metre.
AT_A_METRE = 10.25 - 3.32 * math.log10(1.0 / 0.0254) + 1.559 * math.log10(0.92) - 0.344 / 50.0


def document(wishes: Document, eye: Document | None = None, **members: Any) -> Document:
    """The small scenario seen by a camera, with wishes of region A."""
    scenario = small(sensors=[EYE | (eye or {})], **members)
    scenario["features"][0]["properties"] |= wishes
    if members.get("altitude_m", 0.0) is None:
        del scenario["altitude_m"]
    return scenario


def heights_m(scenario: Scenario) -> dict[str, float]:
    """Over ground, of each region."""
    return {region.name: scenario.level.of(region).height_m for region in scenario.regions}


def refused(given: Document, terrains: Any = None) -> list[Finding]:
    """The errors."""
    with pytest.raises(ScenarioError) as error:
        read_scenario(given, terrains)
    return [finding for finding in error.value.findings if finding.severity == "error"]


@pytest.mark.parametrize(
    ("wishes", "height_m"),
    [
        ({"gsd_m": 0.03}, 150.0),
        ({"min_resolution_m": 0.02}, 100.0),
        ({"min_niirs": AT_A_METRE - 3.32 * math.log10(0.08)}, 400.0),
        ({"gsd_m": 0.03, "min_resolution_m": 0.02, "min_niirs": 4.0}, 100.0),
        ({"gsd_m": 0.5}, 500.0),
        ({"gsd_m": 0.5, "altitude_m": 220.0}, 220.0),
    ],
)
def test_the_height_is_the_greatest_that_gives_all_that_is_asked(wishes: Document, height_m: float) -> None:
    """Worked by hand; never above the collection's altitude, and a region's own altitude is kept."""
    found = heights_m(read_scenario(document(wishes)))
    assert found == {"A": pytest.approx(height_m, abs=0.0101), "B": 500.0}
    assert found["A"] <= height_m + 1e-9


def test_bounds_hold_what_is_chosen() -> None:
    """Above altitude_m with max_height_m; without altitude_m the highest allowed, and flown between them."""
    higher = read_scenario(document({"gsd_m": 0.5}, max_height_m=800.0))
    assert heights_m(higher) == {"A": 800.0, "B": 500.0}
    free = read_scenario(document({"gsd_m": 0.03}, altitude_m=None, max_height_m=400.0))
    assert heights_m(free) == {"A": 150.0, "B": 400.0}
    assert free.altitude_m == 400.0
    over_sea = document({"gsd_m": 0.03}, altitude_reference="amsl")
    over_sea["features"][3]["geometry"]["coordinates"].append(300.0)
    assert heights_m(read_scenario(over_sea)) == {"A": pytest.approx(150.0), "B": pytest.approx(200.0)}


def test_all_of_one_quality_are_flown_at_one_height_and_judged() -> None:
    """The plan's level is the chosen one, and its footprints keep what is asked."""
    given = document({"gsd_m": 0.02})
    given["features"][1]["properties"]["gsd_m"] = 0.02
    plan = make_plan(read_scenario(given))
    assert {collect.line[0][2] for collect in plan.collects} == {100.0}
    assert max(footprint.gsd_m or 1.0 for footprint in plan.footprints) == pytest.approx(0.02, abs=1e-9)
    assert plan.violations == ()


@pytest.mark.parametrize(
    ("wishes", "members", "rule", "said"),
    [
        ({"gsd_m": 0.001}, {}, "quality-out-of-reach", "gsd_m"),
        ({"gsd_m": 0.01}, {"min_height_m": 80.0}, "quality-out-of-reach", "gsd_m"),
        ({"min_niirs": 8.9}, {"min_height_m": 400.0}, "quality-out-of-reach", "min_niirs"),
        ({"min_niirs": 12.0}, {}, "out-of-range", "min_niirs"),
        ({"gsd_m": 0.0}, {}, "out-of-range", "gsd_m"),
        ({"gsd_m": 0.02, "altitude_m": 220.0}, {}, "quality-out-of-reach", "altitude_m"),
        ({"gsd_m": 0.02}, {"min_height_m": 90.0, "max_height_m": 80.0}, "out-of-range", "min_height_m"),
        ({"gsd_m": 0.02}, {"min_height_m": 600.0}, "quality-out-of-reach", "gsd_m"),
        ({"gsd_m": 0.5}, {"min_height_m": 600.0}, "heights-too-close", "max_height_m"),
    ],
)
def test_what_no_height_gives_is_refused_by_name(
    wishes: Document, members: Document, rule: str, said: str
) -> None:
    """Feature, rule and property."""
    (found,) = refused(document(wishes, **members))
    assert (found.rule, found.feature in ("A", "scenario")) == (rule, True)
    assert said in found.message + found.fix


@settings(max_examples=40)
@given(
    st.sampled_from(["gsd_m", "min_niirs", "min_resolution_m"]), st.floats(12.0, 400.0), st.floats(0.01, 0.9)
)
def test_the_value_that_a_refusal_names_works(wish: str, least_m: float, part: float) -> None:
    """Whatever is asked for out of reach: what the fix says is accepted, and flown at the least height."""
    gsd_m = least_m * part / 5000.0
    asked = AT_A_METRE - 3.32 * math.log10(gsd_m) if wish == "min_niirs" else gsd_m
    assume(asked <= 9.0)
    (found,) = refused(document({wish: asked}, min_height_m=least_m))
    assert found.rule == "quality-out-of-reach"
    value = float(re.findall(rf"{wish} ([\d.e-]+)", found.fix)[0])
    scenario = read_scenario(document({wish: value}, min_height_m=least_m))
    assert heights_m(scenario)["A"] == pytest.approx(least_m, rel=0.01)
    worse = value * (0.99 if wish != "min_niirs" else 1.0) + (0.01 if wish == "min_niirs" else 0.0)
    assert refused(document({wish: worse}, min_height_m=least_m))


def test_niirs_of_a_camera_that_does_not_tell_its_edge_response_is_refused() -> None:
    """With what to add."""
    eye = {k: v for k, v in EYE.items() if k not in ("rer", "snr")}
    given = document({"min_niirs": 5.0})
    given["sensors"] = [eye]
    (found,) = refused(given)
    assert (found.feature, found.rule) == ("A", "quality-unknown")
    assert "rer" in found.fix


def test_a_radars_niirs_decides_its_height_and_its_resolution_is_a_gsd() -> None:
    """Equation 9 at the worse edge of the beam; and gsd_m finer than its resolution is not seen."""
    given = small()
    given["features"][0]["properties"]["min_niirs"] = 5.4
    scenario = read_scenario(given)
    height_m = heights_m(scenario)["A"]
    assert heights_m(scenario)["B"] == 500.0
    for down in (math.radians(30.0), math.radians(60.0)):
        slant_km = height_m / math.sin(down) / 1000.0
        assert 5.606 - 0.763 * slant_km + 3.657 * down - 3.422 * down**2 >= 5.4 - 1e-6
    beyond = small()
    beyond["features"][0]["properties"]["min_niirs"] = 8.0
    (found,) = refused(beyond)
    assert (found.rule, "no height" in found.message) == ("quality-out-of-reach", True)
    fine = small()
    fine["features"][0]["properties"]["gsd_m"] = 0.5
    fine["sensors"][0]["resolution_m"] = 1.0
    assert read_scenario(fine).regions[0].min_resolution_m == 0.5


def test_over_terrain_quality_is_that_on_the_lowest_ground_and_bounds_that_on_the_highest() -> None:
    """A slope of one in five across a region: the level lies under the wish over its foot."""
    frame = read_scenario(small()).frame
    slope = {"t": raster(lambda e, n: 0.2 * e, LocalFrame(frame.lon_deg, frame.lat_deg))}
    scenario = read_scenario(document({"gsd_m": 0.04}, terrain="t"), slope)
    (region, _) = scenario.regions
    assert scenario.terrain is not None
    assert region.altitude_m is not None
    low_m, top_m = scenario.terrain.range_over(region.area)
    assert region.altitude_m == pytest.approx(low_m + 200.0, abs=0.02)
    assert region.altitude_m - top_m > 30.0
    (found,) = refused(document({"gsd_m": 0.018}, terrain="t", min_height_m=60.0), slope)
    value = float(re.findall(r"gsd_m ([\d.e-]+)", found.fix)[0])
    assert value == pytest.approx((60.0 + top_m - low_m) / 5000.0, rel=0.01)
    given = document({"gsd_m": 0.5}, terrain="t", min_height_m=60.0, max_height_m=90.0)
    assert {f.feature: f.rule for f in refused(given, slope)} == {
        "A": "heights-too-close",
        "B": "above-ceiling",
    }


def test_no_pass_is_above_the_highest_beside_its_region_either() -> None:
    """Over a slope passes end above lower ground than their region's: allowed for, and the judge looks."""
    camera = EYE | {"forward_overlap": 0.3, "side_overlap": 0.3}
    asked = document({}, camera, altitude_m=None, max_height_m=260.0, terrain="t")
    del asked["features"][1]
    slope = {"t": raster(lambda e, n: 0.1 * (e + n), read_scenario(small()).frame)}
    plan = make_plan(read_scenario(asked, slope))
    assert plan.violations == ()
    scenario = read_scenario(asked, slope)
    assert scenario.terrain is not None
    line = np.array([place for collect in plan.collects for place in collect.line])
    over_m = line[:, 2] - scenario.terrain.at(scenario.frame.to_local(line[:, :2]))
    assert over_m.max() <= 260.0
    lower = replace(scenario, max_height_m=float(over_m.max()) - 5.0)
    (found,) = {(v.constraint, v.hard, round(v.amount)) for v in judge(lower, plan).violations}
    assert found == ("collect-height", True, 5)


def test_bounds_that_decide_nothing_are_told() -> None:
    """With an altitude for everything and no wish."""
    warnings = read_scenario(document({}, min_height_m=50.0, max_height_m=900.0)).warnings
    assert [w.rule for w in warnings] == ["not-used"]


@pytest.mark.parametrize("wishes", [{}, {"altitude_m": 220.0}, {"altitude_m": 220.0, "gsd_m": 0.5}])
def test_no_altitude_lies_above_the_highest(wishes: Document) -> None:
    """The collection's 500 m or a region's own: refused with the height that would do, taken with it."""
    given_m = wishes.get("altitude_m", 500.0)
    found = [f for f in refused(document(wishes, max_height_m=90.0)) if f.feature == "A"]
    assert [f.rule for f in found] == ["above-ceiling"]
    (least_m,) = (float(value) for value in re.findall(r"max_height_m (\d+) or more", found[0].fix))
    assert least_m == given_m
    document_then = document(wishes, max_height_m=max(least_m, 500.0))
    assert heights_m(read_scenario(document_then))["A"] == given_m


def test_without_any_height_altitude_is_missing() -> None:
    """Of the collection where nothing says; of the region where only others do."""
    (found,) = refused(document({}, altitude_m=None))
    assert (found.feature, found.rule) == ("scenario", "missing-property")
    (found,) = refused(document({"gsd_m": 0.03}, altitude_m=None))
    assert (found.feature, found.rule) == ("B", "missing-property")


def test_following_the_ground_quality_is_that_of_one_height_over_it() -> None:
    """On the slope the region is flown over as high everywhere; what lies lower beside it is allowed for."""
    frame = read_scenario(small()).frame
    slope = {"t": raster(lambda e, n: 0.1 * e, frame)}
    given = document({"gsd_m": 0.03}, {"min_interval_s": 0.0}, terrain="t", terrain_following=True)
    region = read_scenario(given, slope).regions[0]
    assert region.over_ground_m is not None
    # 150 m over the lowest ground seen: of the strip, 180 m wide from there, one half lies up to 9 m lower.
    assert 100.0 < region.over_ground_m <= 150.0 - 0.1 * 90.0 * region.over_ground_m / 150.0
