"""Arcs as turns round their centres: where, how large, and left where the arc ends."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.compare import differences
from mavlink.dialects.mission import Mission
from mavlink.encoding.arcs import widened
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.encoding.options import Arcs
from mavlink.wire.items import Command, MissionItem
from tests.mavlink.encoding.missions import KINDS, W, commands, local
from tests.mavlink.plans import LEGS, START, Leg, flown, make_plan

T = Command.NAV_LOITER_TURNS
STRAIGHT = Leg(length_m=800.0)

wide_arcs = st.builds(
    Leg,
    turn_deg=st.floats(61.0, 350.0).flatmap(lambda a: st.sampled_from([a, -a])),
    radius_m=st.floats(60.0, 250.0),
)


def turn_of(mission: Mission) -> tuple[MissionItem, MissionItem, MissionItem]:
    """The only turn, with the items before and behind it."""
    (at,) = [index for index, command in enumerate(commands(mission)) if command == T]
    before, turn, behind = mission.mission[at - 1 : at + 2]
    return before, turn, behind


@given(wide_arcs)
@settings(max_examples=40, deadline=None)
def test_a_turn_stands_between_the_ends_of_its_arc(leg: Leg) -> None:
    """Waypoints at both ends, the exact centre, the side, the radius, read back as sent."""
    mission = encode(make_plan((STRAIGHT, leg, STRAIGHT)))
    before, turn, behind = turn_of(mission)
    _, arc, _ = flown((STRAIGHT, leg, STRAIGHT), START).segments
    assert arc.centre is not None
    assert (before.command, behind.command) == (W, W)
    for item, place in ((before, arc.start.position), (turn, arc.centre), (behind, arc.end.position)):
        assert math.dist(local(item), place) < 0.05
    assert math.copysign(1.0, turn.param3) == (-1.0 if leg.turn_deg > 0.0 else 1.0)
    # Wider than the arc, whose end is left for later so, by one to two metres of the item.
    assert 1.0 <= abs(turn.param3) * widened(300.0) - leg.radius_m <= 2.1
    assert turn.param4 == 1.0
    held = mission.dialect.expected_readback(mission.mission)
    assert differences(mission.mission, held, mission.dialect) == ()
    assert next(item for item in held if item.command == T) == turn


@given(wide_arcs, st.floats(-45.0, 40.0), st.floats(0.9, 1.2))
@settings(max_examples=100, deadline=None)
def test_a_turn_is_left_where_its_arc_ends(leg: Leg, met_deg: float, size: float) -> None:
    """By ArduPlane's rule, the circle met early or late, flown too wide or narrow: no turn more or less."""
    mission = encode(make_plan((STRAIGHT, leg, STRAIGHT)))
    _, turn, behind = turn_of(mission)
    side = -1.0 if turn.param3 > 0.0 else 1.0
    radius_m = size * leg.radius_m
    centre, target = local(turn), local(behind)
    start = math.atan2(target[1] - centre[1], target[0] - centre[0]) - math.radians(leg.turn_deg)
    flown_deg = met_deg
    while not (
        flown_deg - met_deg > 360.0 * turn.param1
        and _lined_up(centre, target, start, flown_deg, side, radius_m)
    ):
        flown_deg += 0.5
        assert flown_deg < abs(leg.turn_deg) + 5.0, "another whole circle"
    # Flown too narrow, the chord to the arc's end is seen under a larger angle.
    assert flown_deg > abs(leg.turn_deg) - 45.0


def _lined_up(
    centre: tuple[float, float],
    target: tuple[float, float],
    start: float,
    flown_deg: float,
    side: float,
    radius_m: float,
) -> bool:
    """Whether the circle's tangent points within 10° of the place (``ModeLoiter::isHeadingLinedUp``)."""
    out = start + side * math.radians(flown_deg)
    here = (centre[0] + radius_m * math.cos(out), centre[1] + radius_m * math.sin(out))
    away = math.dist(centre, target)
    if away >= radius_m:
        wanted = math.atan2(target[1] - here[1], target[0] - here[0])
    else:
        chord = 2.0 * math.asin((radius_m - away) / (2.0 * radius_m))
        wanted = math.atan2(target[1] - centre[1], target[0] - centre[0]) + side * (math.pi / 2.0 - chord)
    error = wanted - (out + side * math.pi / 2.0)
    return abs(math.remainder(error, math.tau)) <= math.radians(10.0)


@pytest.mark.parametrize(
    ("height_m", "density"), [(0.0, 1.2250), (1000.0, 1.1117), (5000.0, 0.73643), (10_000.0, 0.41351)]
)
def test_circles_widen_as_the_air_thins(height_m: float, density: float) -> None:
    """By the densities of the U.S. Standard Atmosphere 1976."""
    assert widened(height_m) == pytest.approx(1.2250 / density, rel=2e-3)


def test_the_height_of_home_counts() -> None:
    """Over a home at 1500 m the item's radius is smaller: the air is thinner there."""
    low, high = (encode(make_plan(), options=EncodeOptions(home_altitude_m=h)) for h in (0.0, 1500.0))
    radii = [[abs(item.param3) for item in mission.mission if item.command == T] for mission in (low, high)]
    assert radii == [[118.0, 147.0], [102.0, 127.0]]


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_only_plane_flies_turns(autopilot: Autopilot, kind: VehicleType) -> None:
    """PX4 refuses the item and copters need none: points there, and an error where turns are asked for."""
    plan = make_plan(autopilot=autopilot, vehicle_type=kind)
    plane = autopilot == "ardupilot" and kind != "multirotor"
    assert commands(encode(plan)).count(T) == (2 if plane else 0)
    if not plane:
        with pytest.raises(EncodeError, match="ask for points"):
            encode(plan, options=EncodeOptions(arcs="loiter"))


@pytest.mark.parametrize(
    ("leg", "auto", "loiter"),
    [
        (Leg(turn_deg=61.0), 1, 1),
        (Leg(turn_deg=59.0), 0, 1),
        (Leg(turn_deg=-21.0), 0, 1),
        (Leg(turn_deg=-19.0), 0, 0),
        (Leg(turn_deg=90.0, radius_m=251.0), 0, 0),
    ],
)
def test_which_arcs_become_turns(leg: Leg, auto: int, loiter: int) -> None:
    """From 60° on where nothing is said, from 20° on where turns are asked for; never wider than 250 m."""
    plan = make_plan((STRAIGHT, leg, STRAIGHT))
    expected: dict[Arcs, int] = {"auto": auto, "loiter": loiter, "points": 0}
    for choice, turns in expected.items():
        mission = encode(plan, options=EncodeOptions(arcs=choice))
        assert commands(mission).count(T) == turns
        assert any("LOITER_TURNS" in note for note in mission.notes) == bool(turns)


def test_an_arc_that_climbs_stays_points() -> None:
    """An item has one height, so an arc over sloping ground is flown along its points."""
    plan = make_plan((STRAIGHT, Leg(turn_deg=180.0), STRAIGHT))
    (path,) = plan.paths
    climbing = tuple(
        replace(each, end_altitude_m=each.end_altitude_m + 5.0) if each.turn_deg == 180.0 else each
        for each in path.segments
    )
    assert commands(encode(plan)).count(T) == 1
    assert commands(encode(replace(plan, paths=(replace(path, segments=climbing),)))).count(T) == 0


def test_collects_are_switched_the_same() -> None:
    """Turns change nothing of what stands at the ends of collects."""
    points = encode(make_plan(LEGS), options=EncodeOptions(arcs="points"))
    turns = encode(make_plan(LEGS))
    switches = [
        [
            (mission.mission[item.seq - 1].x, mission.mission[item.seq - 1].y, item.param2)
            for item in mission.mission
            if item.command == Command.DO_SET_RELAY
        ]
        for mission in (points, turns)
    ]
    assert switches[0] == switches[1]
    assert len(switches[0]) == 5
