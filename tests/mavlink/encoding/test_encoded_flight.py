"""Encoded missions flown by the simulated aircraft, which knows the items alone."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from shapely.geometry import LineString, Point, Polygon

from mavlink.dialects import Autopilot
from mavlink.dialects.compare import differences
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.payload import CommandPayload, Payload
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.dynamics import AircraftState
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command, MissionType
from planner.plan import Collect, Plan
from planner.route import Pose
from tests.mavlink.plans import FRAME, Leg, make_plan
from tests.mavlink.sim.helpers import Station

LEGS = (
    Leg(length_m=1500.0, collect_m=(700.0, 1200.0)),
    Leg(turn_deg=-30.0, radius_m=150.0),
    Leg(length_m=1200.0, collect_m=(200.0, 1200.0)),
    Leg(turn_deg=90.0, radius_m=120.0),
    Leg(length_m=700.0),
)
USER_COMMAND = CommandPayload(31010, (1, 0, 0, 0, 0, 0, 0), 31010, (0, 0, 0, 0, 0, 0, 0))
#: The sensor's state is looked at this often; at 20 m/s that is a metre.
STEP_S = 0.05


def local(state: AircraftState) -> tuple[float, float]:
    east_m, north_m = FRAME.to_local((state.place.lon_deg, state.place.lat_deg))
    return float(east_m), float(north_m)


def fly(
    plan: Plan, autopilot: Autopilot, payload: Payload | None = None
) -> tuple[list[tuple[float, float]], ...]:
    """The whole track, then a track for each time the sensor was on."""
    # The simulated fixed wing flies up to its waypoints, so the sensor needs no delay.
    kind = plan.vehicles[0].type
    options = EncodeOptions(off_delay_m=None if kind == "multirotor" else 0.0)
    if payload is not None:
        options = replace(options, payload=payload)
    mission = encode(plan, autopilot=autopilot, options=options)
    home = Place(plan.home[1], plan.home[0], 488.0)
    settings = SimSettings(home=home, autopilot=Flavour(autopilot), vehicle_type=kind)
    station = Station(SimulatedAircraft(settings))
    for kind in (MissionType.MISSION, MissionType.FENCE):
        assert station.upload(mission.items_of(kind), kind) == 0
        held = tuple(station.download(kind))
        assert differences(mission.items_of(kind), held, mission.dialect) == ()
    station.start()
    track: list[tuple[float, float]] = []
    seen: list[list[tuple[float, float]]] = []
    was_on = False
    while station.aircraft.armed:
        assert station.now_s < 1500.0, "still flying"
        station.wait(STEP_S)
        track.append(local(station.aircraft.state))
        is_on = station.aircraft.payload.sensor_on
        if is_on and not was_on:
            seen.append([])
        if is_on:
            seen[-1].append(track[-1])
        was_on = is_on
    return (track, *seen)


def ends(collect: Collect) -> tuple[tuple[float, float], tuple[float, float]]:
    start, end = (tuple(FRAME.to_local(place[:2])) for place in collect.line)
    return (float(start[0]), float(start[1])), (float(end[0]), float(end[1]))


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
@pytest.mark.parametrize("start", [Pose(0.0, 0.0, 0.4), Pose(1000.0, -2000.0, 2.0)])
@pytest.mark.parametrize("payload", [None, USER_COMMAND])
def test_a_mission_is_flown_as_planned(autopilot: Autopilot, start: Pose, payload: Payload | None) -> None:
    """Held as meant, flown inside the area, the sensor on over the collects alone, landed at the end."""
    plan = make_plan(LEGS, start=start)
    track, *seen = fly(plan, autopilot, payload)
    area = Polygon(FRAME.to_local(plan.fence.inclusion[0].ring))
    assert area.contains(LineString(track))
    assert len(seen) == len(plan.collects)
    for collect, line in zip(plan.collects, seen, strict=True):
        begin, end = ends(collect)
        # One step of the simulation, and the metre at which a waypoint counts as reached.
        assert math.dist(line[0], begin) <= 3.0
        assert math.dist(line[-1], end) <= 3.0
        planned = LineString([begin, end])
        assert max(planned.distance(Point(point)) for point in line) <= 3.0
    assert math.dist(track[-1], FRAME.to_local(plan.end)) <= 150.0


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_a_multirotors_mission_is_flown_as_planned(autopilot: Autopilot) -> None:
    """The same for ArduCopter and PX4's multirotors: on the lines within a metre, down at the plan's end."""
    plan = make_plan(LEGS, autopilot=autopilot, vehicle_type="multirotor", min_turn_radius_m=60.0)
    track, *seen = fly(plan, autopilot)
    assert len(seen) == len(plan.collects)
    for collect, line in zip(plan.collects, seen, strict=True):
        begin, end = ends(collect)
        assert math.dist(line[0], begin) <= 3.0
        # Nothing of the collect is left unseen, whatever way the autopilot takes its waypoints.
        assert -1.1 <= math.dist(line[-1], begin) - math.dist(begin, end) <= 3.0
        whole = LineString([begin, end])
        inner = [point for point in line if 3.0 < whole.project(Point(point)) < whole.length - 3.0]
        assert max(whole.distance(Point(point)) for point in inner) <= 1.0
    planned = LineString(FRAME.to_local([point[:2] for point in plan.paths[0].line]))
    assert max(planned.distance(Point(point)) for point in track) <= 6.0
    assert math.dist(track[-1], FRAME.to_local(plan.end)) <= 1.0


def test_the_turns_are_flown_near_their_arcs() -> None:
    """From the first collect to the landing the track keeps within 10 m of the line, in circles too."""
    plan = make_plan(LEGS)
    track, *seen = fly(plan, "ardupilot")
    planned = LineString(FRAME.to_local([point[:2] for point in plan.paths[0].line]))
    first = track.index(seen[0][0])
    end = FRAME.to_local(plan.end)
    last = next(i for i in range(first, len(track)) if math.dist(track[i], end) < 5.0)
    flown = LineString(track[first:last])
    assert flown.length > 0.7 * (plan.paths[0].length_m - plan.collects[0].start_m)
    assert max(planned.distance(Point(point)) for point in flown.coords) <= 10.0


def test_turns_round_their_centres_are_flown_once() -> None:
    """Three wide arcs as LOITER_TURNS: each left where it ends, on to the next pass, with no circle more."""
    turns = (200.0, -330.0, 90.0)
    legs = [Leg(length_m=1200.0, collect_m=(700.0, 1100.0))]
    for turn_deg in turns:
        legs += [Leg(turn_deg=turn_deg, radius_m=120.0), Leg(length_m=900.0, collect_m=(200.0, 800.0))]
    plan = make_plan(tuple(legs))
    commands = [item.command for item in encode(plan, autopilot="ardupilot").mission]
    assert commands.count(Command.NAV_LOITER_TURNS) == len(turns)
    track, *seen = fly(plan, "ardupilot")
    assert len(seen) == len(plan.collects)
    first, last = track.index(seen[0][0]), track.index(seen[-1][-1])
    planned = LineString(FRAME.to_local([point[:2] for point in plan.paths[0].line]))
    flown = LineString(track[first : last + 1])
    assert max(planned.distance(Point(point)) for point in flown.coords) <= 10.0
    planned_m = plan.collects[-1].end_m - plan.collects[0].start_m
    assert flown.length == pytest.approx(planned_m, rel=0.02)
