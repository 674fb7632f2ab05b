"""Mission files judged like plans: fence, zones, area, ground and turns, by geometry of the test's own."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.routers.bodies import EXAMPLE
from app.services.documents import write_json
from app.services.errors import ConflictError, RefusedError
from app.services.flights.seen import Sortie, coverage_of, refly_of
from app.services.plans.filed_mission import filed_mission
from app.services.plans.mission_files import FiledPlan, filed
from app.services.plans.mission_scene import FileChoice
from app.services.plans.missions import MissionChoice, exported, mission_findings, mission_of
from app.services.vehicles.brief import brief_of
from mavlink.formats import read_mission
from mavlink.wire.items import MissionType
from planner.airspace.terrain import Terrain
from planner.geojson import read_plan
from tests.mavlink.formats.test_mutations import plan, spoiled_json, spoiled_text

FAULTS = Path(__file__).parents[3] / "faults"
LAT, LON = 47.1, 8.2
#: Degrees of a hundred metres there, roughly.
NORTH, EAST = 100.0 / 111_180.0, 100.0 / 75_900.0


def rows(*places: tuple[float, float], command: int = 16, z: float = 60.0) -> list[str]:
    """Waypoints so many hundred metres east and north of home."""
    return [
        f"9\t0\t3\t{command}\t0\t0\t0\t0\t{LAT + north * NORTH:.7f}\t{LON + east * EAST:.7f}\t{z}\t1"
        for east, north in places
    ]


def fence_rows(command: int, *places: tuple[float, float]) -> list[str]:
    lines = rows(*places, command=command, z=0.0)
    return [line.replace(f"\t{command}\t0\t", f"\t{command}\t{len(places)}\t") for line in lines]


def file(*lines: str) -> bytes:
    home = f"0\t1\t0\t16\t0\t0\t0\t0\t{LAT}\t{LON}\t450\t1"
    return "\n".join(["QGC WPL 110", home, *lines]).encode()


def broken(plan: FiledPlan) -> dict[str, dict[str, Any]]:
    return {violation["constraint"]: violation for violation in plan.summary["violations"]}


SQUARE = ((-10.0, -10.0), (10.0, -10.0), (10.0, 10.0), (-10.0, 10.0))
ROUTE = rows((0.0, 5.0), (8.0, 5.0))
COPTER = FileChoice("flight", vehicle_type="multirotor")


def test_a_mission_inside_its_fence_breaks_nothing() -> None:
    """Nothing is told of a mission that stays in its inclusion and out of its exclusion."""
    away = ((2.0, -8.0), (6.0, -8.0), (6.0, -4.0))
    plan = filed(file(*ROUTE, *fence_rows(5001, *SQUARE), *fence_rows(5002, *away)), COPTER)
    assert broken(plan) == {}
    read = read_plan(json.loads(plan.plan))
    assert (len(read.fence.inclusion), len(read.fence.exclusion)) == (1, 1)
    length_m = read.paths[0].length_m
    assert length_m == pytest.approx(504.0 + 800.0, rel=0.01)


def test_legs_out_of_the_fence_are_found_by_their_length() -> None:
    """A leg that leaves by 300 m, though neither of its ends lies in the exclusion it crosses."""
    wall = fence_rows(5002, (3.0, 0.0), (5.0, 0.0), (5.0, 10.0), (3.0, 10.0))
    crossed = broken(filed(file(*ROUTE, *wall), COPTER))
    assert crossed["hard-zone"]["amount"] == pytest.approx(200.0, rel=0.02)
    small = fence_rows(5001, (-10.0, -10.0), (5.0, -10.0), (5.0, 10.0), (-10.0, 10.0))
    left = broken(filed(file(*ROUTE, *small), COPTER))
    assert left["area"]["amount"] == pytest.approx(300.0, rel=0.02)


def test_two_inclusions_are_what_the_autopilot_makes_of_them() -> None:
    """ArduPilot keeps inside both, PX4 inside either: a mission in one of two is out for the first."""
    west = fence_rows(5001, (-10.0, -10.0), (9.0, -10.0), (9.0, 10.0), (-10.0, 10.0))
    east = fence_rows(5001, (5.0, -10.0), (20.0, -10.0), (20.0, 10.0), (5.0, 10.0))
    content = file(*ROUTE, *west, *east)
    assert "area" in broken(filed(content, FileChoice("f", "ardupilot", "multirotor")))
    assert broken(filed(content, FileChoice("f", "px4", "multirotor"))) == {}


def test_circles_of_both_kinds_are_fences() -> None:
    """A circle round the way forbids it, one round all of it holds it."""
    ring = "9\t0\t3\t{}\t{}\t0\t0\t0\t{}\t{}\t0\t1"
    at_leg = ring.format(5004, 150, LAT + 5.0 * NORTH, LON + 4.0 * EAST)
    assert broken(filed(file(*ROUTE, at_leg), COPTER))["hard-zone"]["amount"] == pytest.approx(
        300.0, rel=0.02
    )
    assert broken(filed(file(*ROUTE, ring.format(5003, 2000, LAT, LON)), COPTER)) == {}
    assert "area" in broken(filed(file(*ROUTE, ring.format(5003, 600, LAT, LON)), COPTER))


def test_turns_too_tight_for_wings_are_told() -> None:
    """Legs of 60 m at right angles leave 30 m: too little at 20 m/s banked by 45°, enough at 10 m/s."""
    zigzag = file(*rows((0.0, 5.0), (0.6, 5.0), (0.6, 5.6), (8.0, 5.6)))
    tight = broken(filed(zigzag, FileChoice("f", vehicle_type="fixed_wing", airspeed_m_s=20.0)))
    assert tight["turn-radius"]["amount"] == pytest.approx(20.0**2 / 9.80665 - 30.0, rel=0.02)
    assert broken(filed(zigzag, FileChoice("f", vehicle_type="fixed_wing", airspeed_m_s=10.0))) == {}
    assert broken(filed(zigzag, COPTER)) == {}
    unsaid = broken(filed(zigzag, FileChoice("f", airspeed_m_s=20.0)))
    assert unsaid["turn-radius"]["hard"] is False


def scenario(*features: dict[str, Any]) -> str:
    def feature(role: str, kind: str, coordinates: Any, **properties: Any) -> dict[str, Any]:
        geometry = {"type": kind, "coordinates": coordinates}
        return {
            "type": "Feature",
            "id": role,
            "geometry": geometry,
            "properties": {"role": role, **properties},
        }

    ring = [(9.0, 0.0), (9.5, 0.0), (9.5, 0.5), (9.0, 0.5), (9.0, 0.0)]
    region = [[LON + east * EAST, LAT + north * NORTH] for east, north in ring]
    vehicle = {"name": "quad", "type": "multirotor", "autopilot": "ardupilot", "airspeed_m_s": 8}
    return write_json(
        {
            "type": "FeatureCollection",
            "altitude_m": 60,
            "altitude_reference": "home",
            "features": [
                feature("start", "Point", [LON, LAT, 450]),
                feature("roi", "Polygon", [region]),
                *features,
            ],
            "vehicles": [vehicle | {"min_turn_radius_m": 5}],
            "sensors": EXAMPLE["sensors"],
        }
    )


def test_a_scenario_lends_its_zones_and_its_aircraft() -> None:
    """A no-fly zone of the scenario forbids as it does a plan; floor and ceiling count."""
    centre = [LON + 4.0 * EAST, LAT + 5.0 * NORTH]
    zone = {
        "type": "Feature",
        "id": "mast",
        "geometry": {"type": "Point", "coordinates": centre},
        "properties": {"role": "no_fly", "radius_m": 100},
    }
    plan = filed(file(*ROUTE), COPTER, scenario(zone))
    assert broken(plan)["hard-zone"]["feature"] == "mast"
    assert broken(plan)["hard-zone"]["amount"] == pytest.approx(200.0, rel=0.02)
    assert plan.scenario == scenario(zone)
    assert read_plan(json.loads(plan.plan)).vehicles[0].name == "quad"
    above = {**zone, "properties": {**zone["properties"], "floor_m": 520}}
    assert broken(filed(file(*ROUTE), COPTER, scenario(above))) == {}
    with pytest.raises(RefusedError, match="has no vehicle plane"):
        filed(file(*ROUTE), FileChoice("f", vehicle="plane"), scenario())
    elsewhere = file(*ROUTE).replace(b"\t47.1", b"\t44.1")
    with pytest.raises(RefusedError, match="km from the start of the scenario"):
        filed(elsewhere, COPTER, scenario())


def ridge(height_m: float) -> Terrain:
    """Flat ground at 450 m with a ridge across the way, 400 m east."""
    step, count = 0.0005, 120
    heights = np.full((count, count), 450.0)
    west, south = LON - 0.02, LAT - 0.02
    column = round((LON + 4.0 * EAST - west) / step)
    heights[:, column - 1 : column + 2] = height_m
    return Terrain("ridge", heights.astype(np.float32), (step, 0.0, west, 0.0, step, south))


def test_the_ground_is_kept_clear_of() -> None:
    """Over a ridge of 40 m the way at 60 m is 20 m clear; into one of 80 m it is 20 m deep."""
    choice = FileChoice("f", vehicle_type="multirotor", terrain="ridge")
    assert broken(filed(file(*ROUTE), choice, None, lambda name: ridge(490.0))) == {}
    low = broken(filed(file(*ROUTE), choice, None, lambda name: ridge(530.0)))
    assert low["terrain-clearance"]["amount"] == pytest.approx(20.0, abs=1.0)
    with pytest.raises(RefusedError, match="there is no raster ridge"):
        filed(file(*ROUTE), choice)


def test_the_scenarios_limits_and_threats_count() -> None:
    """A flight longer than its vehicle's range is told; a threat on the way is a risk and told softly."""
    document = json.loads(scenario())
    document["vehicles"][0]["max_range_m"] = 1000
    threat = {
        "type": "Feature",
        "id": "sam",
        "geometry": {"type": "Point", "coordinates": [LON + 4.0 * EAST, LAT + 5.0 * NORTH]},
        "properties": {"role": "threat", "model": "missile", "radius_m": 150},
    }
    document["features"].append(threat)
    plan = filed(file(*ROUTE), COPTER, json.dumps(document))
    found = broken(plan)
    assert found["range"]["amount"] == pytest.approx(304.0, rel=0.02)
    assert (found["soft-threat"]["hard"], found["soft-threat"]["feature"]) == (False, "sam")
    assert plan.summary["metrics"]["risk_missile"] > 0.5
    assert filed(file(*ROUTE), COPTER).summary["metrics"]["risk_missile"] == 0.0


def test_what_goes_up_are_the_files_own_items() -> None:
    """Nothing is encoded anew: items and fence are those of the file, for whichever autopilot is there."""
    content = (FAULTS / "landing-speed.plan").read_bytes()
    plan = filed(content, FileChoice("f"))
    own = read_mission(content)
    assert mission_of(plan.plan, MissionChoice()).mission == own.mission
    brief = brief_of(plan.plan, plan.scenario, MissionChoice(autopilot="ardupilot"))
    assert [item.command for item in brief.mission.mission[1:]] == [item.command for item in own.mission]
    assert brief.needs.airspeed_m_s == 15.0
    assert read_mission(exported(plan.plan, MissionChoice(), "plan")).mission == own.mission
    assert b"kml" in exported(plan.plan, MissionChoice(), "kml")
    assert filed_mission({}, None, None) is None


def test_a_file_without_a_type_is_for_the_vehicle_that_is_there() -> None:
    """A .waypoints file says no type: it is encoded for what answers, and a .plan's own word stays."""
    bare = json.loads(filed(file(*ROUTE), FileChoice("f")).plan)
    mission = filed_mission(bare, None, "multirotor")
    assert mission is not None
    assert mission.vehicle_type == "multirotor"
    told = json.loads(filed((FAULTS / "landing-speed.plan").read_bytes(), FileChoice("f")).plan)
    mission = filed_mission(told, None, "multirotor")
    assert mission is not None
    assert mission.vehicle_type == "fixed_wing"


def test_files_that_cannot_be_read_are_refused_with_their_place() -> None:
    """Line and fix; a mission that spans half a continent is a wrong home."""
    with pytest.raises(RefusedError, match="line 2") as caught:
        filed(b"QGC WPL 110\n0 1 2\n", FileChoice("f"))
    assert caught.value.findings[0].rule == "mission-format"
    with pytest.raises(RefusedError, match="km from the mission's start"):
        filed(file(*rows((0.0, 1.0), (0.0, 30000.0))), COPTER)
    far_home = read_plan(json.loads(filed(file(*rows((0.0, 30000.0), (0.0, 30010.0))), COPTER).plan))
    assert far_home.paths[0].length_m == pytest.approx(1000.0 + 60.0, rel=0.02)


def test_a_place_where_the_frame_has_none_stops_the_upload() -> None:
    """A take-off in frame 2 would go up at whole degrees and is refused; PX4's DO_LAND_START has none."""
    place = f"{LAT + 0.001}\t{LON}\t30\t1"
    content = file(f"1\t0\t2\t22\t0\t0\t0\t0\t{place}", f"2\t0\t2\t189\t0\t0\t0\t0\t{place}", *ROUTE)
    severities = {}
    for autopilot in ("ardupilot", "px4"):
        plan = filed(content, FileChoice("f", autopilot, "fixed_wing"))
        found = mission_findings(mission_of(plan.plan, MissionChoice()), [MissionType.MISSION])
        severities[autopilot] = {f.feature: f.severity for f in found if f.rule == "place-lost"}
    assert severities == {
        "ardupilot": {"mission item 1": "error", "mission item 2": "error"},
        "px4": {"mission item 0": "error", "mission item 1": "warning"},
    }


def test_nowhere_is_where_the_vehicle_is_for_ardupilot_alone() -> None:
    """A landing at 0, 0 lands where ArduPilot's aircraft is; PX4's would fly to the Gulf of Guinea."""
    content = file(*ROUTE, "9\t0\t3\t21\t0\t0\t0\t0\t0\t0\t0\t1")
    found = {}
    for autopilot in ("ardupilot", "px4"):
        mission = mission_of(filed(content, FileChoice("f", autopilot, "multirotor")).plan, MissionChoice())
        findings = mission_findings(mission, [MissionType.MISSION])
        found[autopilot] = [f.severity for f in findings if f.rule == "place-zero"]
    assert found == {"ardupilot": ["warning"], "px4": ["error"]}


def test_flights_of_a_file_are_judged_for_nothing_seen() -> None:
    """Nobody planned passes: coverage tells of no region, and a plan of the gaps is refused in words."""
    plan = filed(file(*ROUTE), COPTER)
    sortie = Sortie("plan", plan.plan, plan.scenario, (), None)
    assert coverage_of(sortie)["coverage"] == {}
    with pytest.raises(ConflictError, match="followed a mission file"):
        refly_of(sortie, None, None)


def test_fence_and_rally_points_are_features_of_the_plan() -> None:
    """The map finds them by their roles, with the mission's line."""
    rally = f"9\t0\t3\t5100\t0\t0\t0\t0\t{LAT}\t{LON}\t30\t1"
    plan = json.loads(filed(file(*ROUTE, *fence_rows(5001, *SQUARE), rally), COPTER).plan)
    roles = [feature["properties"]["role"] for feature in plan["features"]]
    assert roles == ["path", "fence", "rally"]
    assert plan["features"][2]["geometry"]["coordinates"] == [LON, LAT, 30.0]


def test_spoiled_files_are_judged_or_refused() -> None:
    """Whatever is lost, doubled or rubbish in a file: a verdict or a refusal; what is judged can go up."""
    chance = random.Random(17)
    route = file(*ROUTE, *fence_rows(5001, *SQUARE)).decode()
    judged = 0
    for run in range(60):
        text = spoiled_json(plan(), chance) if run % 2 else spoiled_text(route, chance)
        try:
            made = filed(text.encode(), FileChoice("f", chance.choice([None, "px4"])))
        except RefusedError:
            continue
        judged += 1
        brief = brief_of(made.plan, made.scenario, MissionChoice(autopilot="ardupilot", vehicle_type="vtol"))
        mission_findings(brief.mission, list(MissionType))
    assert 0 < judged < 60


@pytest.mark.parametrize("command", [5003, 5004])
@pytest.mark.parametrize("radius", ["3e38", "2e7", "1e7"])
def test_circles_round_the_earth_are_judged(command: int, radius: str) -> None:
    """An inclusion that holds the whole Earth keeps nothing out; an exclusion that does forbids all."""
    (circle,) = rows((4.0, 5.0), command=command)
    circle = circle.replace(f"\t{command}\t0\t", f"\t{command}\t{radius}\t")
    found = broken(filed(file(*ROUTE, circle), COPTER))
    assert ("hard-zone" in found, "area" in found) == (command == 5004, False)
