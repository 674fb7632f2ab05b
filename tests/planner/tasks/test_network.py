"""The segments round the targets of a plan: what each says is so, by shapely, the judge, and other plans."""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point

from planner.airspace.threats import curve_risk
from planner.check.footprints import sar_footprint
from planner.geojson import read_scenario
from planner.geojson.network_writer import write_network
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.network.network import network_of
from planner.tasks.network.segments import Network, RecognitionSegment
from tests.planner.scenarios import feature, of_two, small

RADAR = {
    "type": "sar",
    "incidence_deg": 45,
    "elevation_beamwidth_deg": 30,
    "azimuth_beamwidth_deg": 10,
    "look": "both",
}


def document() -> dict[str, Any]:
    """Two targets, a zone south of the one, a missile east of the other, a radar too coarse and a camera."""
    made = small(
        feature("wall", "no_fly", "Point", [0.0015, -0.004], radius_m=150.0),
        feature("sam", "threat", "Point", [0.04, 0.0115], model="missile", radius_m=900.0),
    )
    made["features"][0]["properties"]["min_resolution_m"] = 1.0
    made["sensors"] = [
        RADAR | {"name": "fine", "resolution_m": 0.5},
        RADAR | {"name": "coarse", "resolution_m": 3.0},
    ]
    return made


@functools.cache
def made() -> tuple[Scenario, Plan, Network]:
    """The scenario, its plan, its network."""
    scenario = read_scenario(document())
    plan = make_plan(scenario)
    return scenario, plan, network_of(scenario, plan)


def of(target: str, state: str) -> list[RecognitionSegment]:
    """Segments of one target in one state."""
    return [each for each in made()[2].segments if (each.target, each.state) == (target, state)]


def straight(segment: RecognitionSegment) -> LineString:
    """The first pass with what is flown straight before it."""
    return LineString([segment.ingress.position, segment.lines[0][1]])


@pytest.mark.parametrize("target", ["A", "B"])
def test_a_target_has_segments_from_all_sides(target: str) -> None:
    """Several headings and their opposites, both sides to look to, several stand-offs for a heading."""
    alternatives = of(target, "open") + of(target, "ruled_out")
    headings = {round(math.degrees(each.angle_rad)) % 360 for each in alternatives if each.sensor == "fine"}
    assert len(headings) >= 4
    assert all((heading + 180) % 360 in headings for heading in headings)
    assert {each.look for each in alternatives} == {"left", "right"}
    assert max(each.stand_off_m for each in alternatives) > 1.2 * min(
        each.stand_off_m for each in alternatives
    )


def test_open_segments_see_all_of_their_target_and_keep_clear() -> None:
    """By the judge's footprint of their lines, and by shapely of zone and area."""
    scenario, _, _ = made()
    (zone,) = scenario.no_fly
    assert zone.centre is not None
    assert zone.radius_m is not None
    assert scenario.area is not None
    for target in ("A", "B"):
        (region,) = [each for each in scenario.regions if each.name == target]
        assert of(target, "open")
        for segment in of(target, "open"):
            sensor = scenario.suite.named(segment.sensor)
            prints = [
                sar_footprint(
                    sensor, line, segment.look, scenario.altitude_m, 20.0, scenario.airspace, scenario.level
                )
                for line in segment.lines
            ]
            assert shapely.union_all(prints).intersection(region.area).area > 0.999 * region.area.area
            for line in segment.lines:
                assert LineString(line).distance(Point(zone.centre)) > zone.radius_m
                assert scenario.area.covers(LineString(line))


def test_segments_that_are_ruled_out_say_what_they_enter() -> None:
    """Each that is ruled out by the zone alone enters what is kept from it; some do."""
    scenario, _, _ = made()
    (zone,) = scenario.no_fly
    assert zone.centre is not None
    assert zone.radius_m is not None
    by_zone = [each for each in of("A", "ruled_out") if [f.rule for f in each.ruled_out] == ["zone"]]
    assert by_zone
    for segment in by_zone:
        assert segment.ruled_out[0].feature == "wall"
        least_m = min(
            straight(segment).distance(Point(zone.centre)),
            *(LineString(line).distance(Point(zone.centre)) for line in segment.lines),
        )
        assert least_m < zone.radius_m + scenario.clearance_m + 10.0


def test_sensors_are_looked_at_by_their_quality() -> None:
    """The coarse one is refused for A and its fix named; B asks for nothing, but for the first sensor."""
    looked = {(each.target, each.sensor): each for each in made()[2].looked}
    refused = looked["A", "coarse"].refused
    assert refused is not None
    assert refused.rule == "resolution"
    assert looked["A", "fine"].refused is None
    assert looked["A", "fine"].asked
    others = [each for each in of("B", "ruled_out") if each.sensor == "coarse"]
    assert others
    assert all(each.ruled_out[0].rule == "sensor" for each in others)
    assert not [each for each in made()[2].segments if (each.target, each.sensor) == ("A", "coarse")]


def test_exposure_is_that_of_the_line() -> None:
    """Equation 12 along what is flown straight; some segments lie in the missile's reach and some do not."""
    scenario, _, _ = made()
    found = [each for each in of("B", "open") + of("B", "chosen") if len(each.lines) == 1]
    for segment in found:
        points = shapely.get_coordinates(straight(segment).segmentize(5.0))
        missile, radar = curve_risk(points, scenario.threats)
        assert (segment.risk_missile, segment.risk_radar) == pytest.approx(
            (missile, radar), rel=0.02, abs=1e-9
        )
    assert {each.risk_missile > 0.0 for each in found} == {True, False}


def test_chosen_segments_are_the_plans_passes() -> None:
    """Their lines are those of its collects, in flight order."""
    scenario, plan, network = made()
    lines = [line for each in network.segments if each.state == "chosen" for line in each.lines]
    flown = [scenario.frame.to_local([place[:2] for place in each.line]).tolist() for each in plan.collects]
    assert np.array(lines) == pytest.approx(np.array(flown))


def test_longer_is_what_a_plan_bound_to_the_heading_is_longer_by() -> None:
    """Of one target, the cheapest segment of each heading against plans that allow that heading alone."""
    alone = document()
    del alone["features"][1]
    scenario = read_scenario(alone)
    plan = make_plan(scenario)
    told = write_network(scenario, network_of(scenario, plan))
    least: dict[float, float] = {}
    for own in (f["properties"] for f in told["features"] if f["properties"]["role"] == "segment"):
        if own["state"] == "open":
            least[own["heading_deg"]] = min(least.get(own["heading_deg"], math.inf), own["longer_m"])
    assert len(least) > 3
    for heading_deg in sorted(least)[:3]:
        alone["features"][0]["properties"]["approach_deg"] = [heading_deg]
        longer_m = make_plan(read_scenario(alone)).metrics.length_m - plan.metrics.length_m
        assert longer_m == pytest.approx(least[heading_deg], abs=150.0)


def test_what_is_written_is_geojson_by_role() -> None:
    """A segment has its two points; of two aircraft it says who can fly it, and who was chosen."""
    scenario = read_scenario(of_two())
    plan = make_plan(scenario)
    told = write_network(scenario, network_of(scenario, plan, ["A"]))
    names = [f["id"] for f in told["features"]]
    assert len(set(names)) == len(names)
    segments = [f for f in told["features"] if f["properties"]["role"] == "segment"]
    for each in segments:
        assert {f"{each['id']} ingress", f"{each['id']} egress"} < set(names)
        assert shapely.from_geojson(shapely.to_geojson(shapely.geometry.shape(each["geometry"]))).is_valid
    (chosen,) = [each["properties"] for each in segments if each["properties"]["chosen"]]
    assert chosen["vehicles"] == [c.vehicle for c in plan.collects if c.roi == "A"]
    assert {f["properties"]["target"] for f in told["features"]} == {"A"}
