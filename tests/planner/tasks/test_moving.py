"""Buildings so close that sweeps have no room for turns, or for two photos: they are flown all the same."""

from __future__ import annotations

import itertools
import math
from functools import cache

import pytest
import shapely
from shapely.geometry import LineString, box

from planner import pipeline
from planner.airspace.airspace import Airspace
from planner.coverage.urban.measures import Sweep
from planner.coverage.urban.moved import Moves
from planner.coverage.urban.regions import EDGE_M, pass_of
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.tasks import collect
from planner.tasks.setting import Setting, seeing
from tests.planner.tasks.blocks import among_blocks, buildings

INTERVAL_S = 1.4


@cache
def flown(seed: int) -> tuple[Scenario, Plan]:
    """The plan among some buildings: nothing hit, no photo sooner than the camera takes it."""
    scenario = read_scenario(among_blocks(seed, INTERVAL_S, required=False))
    plan = make_plan(scenario)
    assert plan.hard_violations == ()
    assert plan.metrics.coverage["R"] > 0.9
    frame = scenario.frame
    collects = {each.seq: each for each in plan.collects}
    for photos in plan.photos:
        # At equal distances, each at the speed of the pass as the plan has it.
        places = frame.to_local([place[:2] for place in photos.places])
        collect = collects[photos.seq]
        speed_m_s = math.dist(places[0], places[-1]) / (collect.end_s - collect.start_s)
        gaps_m = [math.dist(*pair) for pair in itertools.pairwise(places)]
        assert min(gaps_m) / speed_m_s > 0.99 * INTERVAL_S
    put = frame.north_up(frame.to_local([(8.55, 47.4)])[0])
    line = LineString(frame.to_local([place[:2] for place in plan.paths[0].line]))
    for outline, height_m in buildings(seed):
        if height_m > scenario.altitude_m:
            there = shapely.transform(outline, lambda places: frame.from_north_up(places + put))
            assert line.distance(there) > scenario.clearance_m - 0.1
    return scenario, plan


@pytest.mark.parametrize("seed", [0, 9, 18, 22])
def test_sweeps_without_room_for_a_turn_are_moved(seed: int) -> None:
    """Flown where they were refused, for want of a turn at their ends or of a way between them."""
    flown(seed)


def test_photos_come_no_sooner_than_the_camera_takes_them() -> None:
    """A sweep too short for two photos is moved to where it can be longer."""
    scenario, plan = flown(39)
    assert plan.vehicles[0].airspeed_m_s == scenario.aircraft[0].airspeed_m_s


def test_where_no_sweep_can_be_longer_it_is_flown_more_slowly(monkeypatch: pytest.MonkeyPatch) -> None:
    """It alone, and the plan says so, and why; all else as asked. Not where there is no time."""
    monkeypatch.setattr(collect, "in_time_for_photos", lambda *_: None)
    document = among_blocks(36, INTERVAL_S, required=False)
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    asked_m_s = scenario.aircraft[0].airspeed_m_s
    assert plan.vehicles[0].airspeed_m_s == asked_m_s
    slow = [each for each in plan.collects if each.speed_m_s is not None]
    assert 0 < len(slow) < len(plan.collects) / 2
    for one in slow:
        assert one.speed_m_s is not None
        length_m = one.end_m - one.start_m
        assert length_m / (one.end_s - one.start_s) <= one.speed_m_s + 1e-6 < asked_m_s
    (told,) = [each for each in plan.warnings if "speed-lowered" in each]
    assert f"{len(slow)} of {len(plan.collects)} passes, over R, at" in told
    assert f"not {asked_m_s:g}" in told
    with monkeypatch.context() as unpaced:
        unpaced.setattr(pipeline, "_paced", lambda scenario, answer, _: (scenario, answer))
        hasty_s = make_plan(scenario).paths[0].duration_s
    slowed_s = plan.paths[0].duration_s
    assert hasty_s < slowed_s
    document["vehicles"][0]["max_flight_time_s"] = (hasty_s + slowed_s) / 2.0
    plan = make_plan(read_scenario(document))
    assert all(each.speed_m_s is None for each in plan.collects)
    assert plan.paths[0].duration_s < slowed_s
    assert not {"flight-time"} & {each.constraint for each in plan.violations}


def test_a_region_that_the_flight_time_is_too_short_for_is_left_out() -> None:
    """Told as any other is, also where obstacles leave no lanes to choose among."""
    document = among_blocks(142, INTERVAL_S, required=False)
    document["vehicles"][0]["max_flight_time_s"] = 100.0
    with pytest.raises(InfeasibleError) as refused:
        make_plan(read_scenario(document))
    assert refused.value.constraint == "flight-time"


def test_ground_of_a_required_region_that_no_pass_sees_is_refused_by_its_share() -> None:
    """With the zones and what would work, not with the end of a transit."""
    with pytest.raises(InfeasibleError, match=r"% of it .* is seen by no pass") as refused:
        make_plan(read_scenario(among_blocks(2, INTERVAL_S)))
    assert refused.value.feature == "R"


@pytest.mark.parametrize("seed", range(3))
def test_a_moved_sweep_sees_what_the_other_alone_saw(seed: int) -> None:
    """From a line in the open with a full turn at both ends, as shapely has it, and time between photos."""
    scenario = read_scenario(among_blocks(seed, INTERVAL_S, required=False))
    setting = Setting.of(scenario)
    asked = seeing(scenario, setting)
    (region,) = asked.regions
    camera, height_m = asked.suite.over(region.sensor, region.area, asked.airspace, asked.level.of(region))
    assert isinstance(camera, CameraSensor)
    moves = Moves.over(region, camera, height_m, asked.airspace, asked.level, asked.model)
    ground = moves.room.buffer(EDGE_M)
    inner = shapely.intersection(moves.turns, region.area)
    place = max(shapely.get_parts(inner), key=lambda part: part.area).representative_point()
    sweep = Sweep((place.x - 2.0, place.y), (place.x + 2.0, place.y))
    short = pass_of(region, camera, height_m, sweep, box(place.x, place.y, place.x, place.y))
    found = moves.moved([short], 0)
    assert found is not None
    (laid,) = found
    alone = shapely.intersection(short.footprint, region.area)
    wanted = alone.difference(shapely.union_all(_blocked(asked.airspace)))
    assert wanted.difference(laid.footprint).area < 0.05
    assert laid.length_m >= camera.least_spacing_m(laid.angle_rad) - 1e-6
    assert ground.covers(LineString([laid.start, laid.end]))
    radius_m = asked.model.turn_radius_m
    for east, north in (laid.start, laid.end):
        beside = [
            shapely.Point(
                east - side * radius_m * math.sin(laid.angle_rad),
                north + side * radius_m * math.cos(laid.angle_rad),
            ).buffer(radius_m - 0.01)
            for side in (1.0, -1.0)
        ]
        assert any(ground.covers(circle) for circle in beside)


def _blocked(airspace: Airspace) -> list[shapely.Polygon]:
    """Outlines of all buildings, in the frame's metres."""
    return [shapely.Polygon(obstacle.area) for obstacle in airspace.obstacles]
