"""Sensor on and off round each collect, and the waypoints that bracket it."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.payload import (
    CameraPayload,
)
from mavlink.wire.items import Command, degrees_e7
from planner.plan import ZoneCircle
from tests.mavlink.encoding.missions import (
    KINDS,
    A,
    R,
    W,
    flight,
    local,
)
from tests.mavlink.plans import FRAME, START, Leg, flown, lonlat, make_plan, square_fence


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_triggers_bracket_each_collect(autopilot: Autopilot, kind: VehicleType) -> None:
    """On stands right behind the waypoint at the start of a collect, off right behind that at its end."""
    plan = make_plan(autopilot=autopilot, vehicle_type=kind)
    items = list(encode(plan, options=EncodeOptions(off_delay_m=0.0)).mission)
    switch = Command.DO_SET_RELAY if autopilot == "ardupilot" else Command.DO_SET_ACTUATOR
    switches = [index for index, item in enumerate(items) if item.command == switch]
    ends = [place for collect in plan.collects_of("uav-1") for place in collect.line]
    assert len(switches) == len(ends) + 1 == 5
    last = switches.pop()
    assert last > switches[-1] + 1, "off once more, behind the mission's last waypoint"
    off = 0.0 if autopilot == "ardupilot" else -1.0
    assert (items[last].param2 if switch == Command.DO_SET_RELAY else items[last].param1) == off
    states = []
    for index, (lon_deg, lat_deg, altitude_m) in zip(switches, ends, strict=True):
        before = items[index - 1]
        assert before.command == W
        assert (before.x, before.y, before.z) == (degrees_e7(lat_deg), degrees_e7(lon_deg), altitude_m)
        states.append(items[index].param2 if switch == Command.DO_SET_RELAY else items[index].param1)
    assert states == ([1.0, 0.0, 1.0, 0.0] if autopilot == "ardupilot" else [1.0, -1.0, 1.0, -1.0])


def test_plane_flies_up_to_the_end_of_a_collect() -> None:
    """Waypoints where the sensor goes off count as reached at a metre, others where the vehicle says."""
    ends = [
        items[index - 1]
        for items in [flight(encode(make_plan()))]
        for index, item in enumerate(items)
        if item.command == R and item.param2 == 0.0
    ]
    assert [end.param2 for end in ends] == [1.0, 1.0]
    waypoints = [item for item in flight(encode(make_plan())) if item.command == W]
    assert sum(item.param2 for item in waypoints) == 2.0
    told = encode(make_plan(), options=EncodeOptions(acceptance_radius_m=30.0))
    assert {item.param2 for item in flight(told) if item.command == W} == {30.0}


def test_px4_passing_by_early_is_said() -> None:
    """PX4 ignores a waypoint's own radius: a note says what is lost, unless the sensor goes off late."""
    early = encode(make_plan(), autopilot="px4", options=EncodeOptions(off_delay_m=0.0))
    assert any("45 m early" in note for note in early.notes)
    for options in (EncodeOptions(), EncodeOptions(off_delay_m=60.0)):
        late = encode(make_plan(), autopilot="px4", options=options)
        assert not any("m early" in note for note in late.notes)


def test_on_px4_the_last_waypoint_of_a_collect_lies_where_the_turn_begins_early() -> None:
    """By default it lies as far past the collect's end as PX4 turns early, on the line."""
    early_m = 0.32 * 10.0 * 0.7 * 20.0
    legs = (
        Leg(length_m=1000.0, collect_m=(400.0, 1000.0)),
        Leg(turn_deg=90.0, radius_m=120.0),
        Leg(length_m=900.0, collect_m=(300.0, 600.0)),
    )
    plan = make_plan(legs)
    items = flight(encode(plan, autopilot="px4"))
    offs = [index for index, item in enumerate(items) if item.command == A and item.param1 == -1.0]
    assert len(offs) == 2
    for index, collect in zip(offs, plan.collects, strict=True):
        begin, end = (FRAME.to_local(place[:2]) for place in collect.line)
        last = local(items[index - 1])
        assert math.dist(last, end) == pytest.approx(early_m, abs=0.05)
        assert math.dist(last, begin) == pytest.approx(math.dist(end, begin) + early_m, abs=0.05)
        # Nothing that leads back stands behind it.
        assert math.dist(local(items[index + 1]), begin) > math.dist(last, begin)
    assert math.dist(local(items[offs[0] - 3]), FRAME.to_local(plan.collects[0].line[0][:2])) < 0.05


def test_no_waypoint_is_put_past_the_fence() -> None:
    """Where the overshoot would leave the area, the sensor goes off at the exact end."""
    legs = (
        Leg(length_m=1000.0, collect_m=(400.0, 1000.0)),
        Leg(turn_deg=90.0, radius_m=120.0),
        Leg(length_m=900.0),
    )
    plan = make_plan(legs)
    end = FRAME.to_local(plan.collects[0].line[1][:2])
    begin = FRAME.to_local(plan.collects[0].line[0][:2])
    angle_rad = math.atan2(end[1] - begin[1], end[0] - begin[0])
    tower = ZoneCircle(
        "tower", lonlat((end[0] + 60.0 * math.cos(angle_rad), end[1] + 60.0 * math.sin(angle_rad))), 30.0
    )
    fenced = replace(plan, fence=replace(square_fence(6000.0), exclusion_circles=(tower,)))
    items = flight(encode(fenced, autopilot="px4"))
    off = next(index for index, item in enumerate(items) if item.command == A and item.param1 == -1.0)
    assert math.dist(local(items[off - 1]), end) < 0.05


def test_collects_that_meet_share_a_waypoint() -> None:
    """Where one collect ends as the next begins, off stands before on."""
    legs = (Leg(length_m=1000.0, collect_m=(400.0, 1000.0)), Leg(length_m=1000.0, collect_m=(0.0, 500.0)))
    items = flight(encode(make_plan(legs)))
    assert [int(item.command) for item in items] == [W, R, W, R, R, W, R, W]
    assert [item.param2 for item in items if item.command == R] == [1.0, 0.0, 1.0, 0.0]


def test_overlapping_collects_keep_the_sensor_on() -> None:
    """The sensor goes off once, where the last of two overlapping collects ends."""
    plan = make_plan((Leg(length_m=1000.0, collect_m=(400.0, 800.0)),))
    first = plan.collects[0]
    middle = tuple((a + b) / 2.0 for a, b in zip(*first.line, strict=True))
    last = (*lonlat(flown((Leg(length_m=900.0),), START).end.position), 300.0)
    begun_m = first.start_m - 400.0
    second = replace(
        first,
        seq=1,
        line=((middle[0], middle[1], 300.0), last),
        start_m=begun_m + 600.0,
        end_m=begun_m + 900.0,
    )
    items = flight(encode(replace(plan, collects=(first, second))))
    assert [int(item.command) for item in items] == [W, R, W, W, W, R, W]


def test_the_sensor_may_go_off_late() -> None:
    """With a delay it stays on past the exact end, as far as the straight goes on."""
    late = encode(make_plan(), options=EncodeOptions(off_delay_m=80.0, payload=CameraPayload(25.0)))
    plan = make_plan()
    items = flight(late)
    off = [index for index, item in enumerate(items) if item.command == 206 and item.param1 == 0.0]
    end = local(items[off[0] - 1])
    exact = items[off[0] - 2]
    assert (exact.x, exact.y) == (
        degrees_e7(plan.collects[0].line[1][1]),
        degrees_e7(plan.collects[0].line[1][0]),
    )
    assert math.dist(end, local(exact)) == pytest.approx(80.0, abs=0.05)
