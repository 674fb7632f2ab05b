"""Passes and landings found in missions as they are encoded."""

from __future__ import annotations

import pytest

from mavlink.dialects.base import Autopilot, VehicleType
from mavlink.encoding.encode import encode
from mavlink.encoding.options import DEFAULT_PAYLOAD, EncodeOptions
from mavlink.encoding.payload import parse_payload
from mavlink.state.passes import landing_of, lead_in, passes_of
from mavlink.wire.items import Command, Frame, MissionItem
from tests.mavlink.plans import make_plan

CRAFT: list[tuple[Autopilot, VehicleType]] = [
    ("ardupilot", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("px4", "fixed_wing"),
    ("px4", "multirotor"),
]


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
@pytest.mark.parametrize(
    "payload", ["relay:1", "actuator:2:1:-0.5", "camera:distance=20", "image:interval=2"]
)
def test_every_pass_lies_between_its_orders(autopilot: Autopilot, kind: VehicleType, payload: str) -> None:
    """As many as collects, each with a place to fly to inside; elsewhere it is ordered off at most."""
    if autopilot == "ardupilot" and payload.startswith("actuator"):
        payload = "servo:9:1900:1100"
    plan = make_plan(autopilot=autopilot, vehicle_type=kind)
    switch = parse_payload(payload)
    mission = encode(plan, options=EncodeOptions(payload=switch))
    passes = passes_of(mission.mission, switch, autopilot)
    assert len(passes) == len(plan.collects)
    orders = {mission.mission[each[0]].command for each in passes}
    orders |= {mission.mission[each[-1]].command for each in passes}
    for each in passes:
        inside = [mission.mission[seq] for seq in each[1:-1]]
        assert [item.command for item in inside if item.command == Command.NAV_WAYPOINT]
        assert not orders & {item.command for item in inside}
    apart = set(range(len(mission.mission))).difference(*passes)
    begun = [mission.mission[each[0]] for each in passes]
    for seq in apart:
        item = mission.mission[seq]
        assert all(
            (item.command, item.param1, item.param2) != (on.command, on.param1, on.param2) for on in begun
        )


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
def test_a_pass_is_led_into_from_behind_the_one_before(autopilot: Autopilot, kind: VehicleType) -> None:
    """From a waypoint before its own first place; a wing's lies farther before it, where there is room."""
    items = encode(make_plan(autopilot=autopilot, vehicle_type=kind)).mission
    passes = passes_of(items, DEFAULT_PAYLOAD, autopilot)
    ended = 0
    for run in passes:
        wing, hovers = (lead_in(items, run, passes, hovers=each) for each in (False, True))
        assert hovers.whole or run is passes[0]
        winged, hovering = wing.seq, hovers.seq
        assert ended <= winged <= hovering < run.start
        assert {items[seq].command for seq in (winged, hovering)} == {Command.NAV_WAYPOINT}
        ended = run.stop


@pytest.mark.parametrize(("autopilot", "kind"), CRAFT)
def test_the_landing_begins_behind_the_last_pass(autopilot: Autopilot, kind: VehicleType) -> None:
    """From the circle down, or the place before the touch-down, on, everything leads to the ground."""
    plan = make_plan(autopilot=autopilot, vehicle_type=kind)
    items = encode(plan).mission
    first = landing_of(items)
    assert first is not None
    landing = items[first:]
    assert landing[-1].command == Command.NAV_LAND
    assert first > passes_of(items, DEFAULT_PAYLOAD, autopilot)[-1][-1]
    if kind == "fixed_wing":
        assert landing[0].command == Command.NAV_LOITER_TO_ALT
        assert max(item.z for item in landing if item.x) < plan.altitude_m
    assert landing_of(items[:-1]) is None


def test_a_sensor_never_ordered_off_is_on_to_the_end() -> None:
    """A foreign mission that forgets it: the pass has no other end than the mission's."""
    relay = MissionItem(1, Frame.MISSION, Command.DO_SET_RELAY, param1=0.0, param2=1.0)
    places = [MissionItem(seq, Frame.GLOBAL, Command.NAV_WAYPOINT, x=1, y=1) for seq in (0, 2, 3)]
    items = sorted([relay, *places], key=lambda item: item.seq)
    assert passes_of(items, parse_payload("relay:0"), "ardupilot") == (range(1, 4),)
    assert passes_of(items, parse_payload("relay:1"), "ardupilot") == ()
