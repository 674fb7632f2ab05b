"""Waypoints along the exact line: chord errors, arcs, altitudes, and what the wire leaves of them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as wire
from shapely.geometry import LineString, MultiPoint, Point

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from planner.plan import AltitudeReference
from tests.mavlink.encoding.missions import (
    KINDS,
    W,
    arcs,
    flight,
    leg_lists,
    local,
    path_line,
)
from tests.mavlink.plans import START, Leg, make_plan


@given(leg_lists, st.floats(0.3, 30.0))
@settings(max_examples=40, deadline=None)
def test_waypoints_keep_the_chord_error(legs: tuple[Leg, ...], chord_error_m: float) -> None:
    """The exact line is nowhere farther from the line between waypoints than stated, nor the other way."""
    options = EncodeOptions(chord_error_m=chord_error_m)
    mission = encode(make_plan(legs, vehicle_type="multirotor"), options=options)
    # The take-off ends over the start, where no waypoint need be.
    waypoints = LineString([START.position, *(local(item) for item in flight(mission))])
    exact = path_line(legs)
    # Hausdorff over vertices, both ways; waypoints are rounded to 1e-7 degrees, about a centimetre.
    away_m = max(waypoints.distance(Point(p)) for p in exact.coords)
    assert away_m <= chord_error_m + 0.02
    back_m = max(exact.distance(Point(p)) for p in waypoints.coords)
    assert back_m <= 0.03


@given(arcs)
@settings(max_examples=25, deadline=None)
def test_arcs_have_a_waypoint_every_45_degrees(leg: Leg) -> None:
    """However large the chord error, the waypoints of an arc are at most 45° apart."""
    options = EncodeOptions(chord_error_m=10_000.0)
    mission = encode(make_plan((Leg(length_m=500.0), leg), vehicle_type="multirotor"), options=options)
    points = MultiPoint([local(item) for item in flight(mission)])
    assert len(points.geoms) == 1 + math.ceil(abs(leg.turn_deg) / 45.0 - 1e-9)


def test_a_larger_chord_error_needs_fewer_waypoints() -> None:
    """Half a metre takes more items than five metres."""
    fine = encode(make_plan(), options=EncodeOptions(chord_error_m=0.5, arcs="points"))
    coarse = encode(make_plan(), options=EncodeOptions(chord_error_m=5.0, arcs="points"))
    assert len(fine.mission) > len(coarse.mission)


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_items_survive_the_wire(autopilot: Autopilot, kind: VehicleType) -> None:
    """Packed and parsed by pymavlink, every field is what it was, in 32 bits."""
    link = wire.MAVLink(None, srcSystem=255, srcComponent=190)
    mission = encode(
        make_plan(autopilot=autopilot, vehicle_type=kind), options=EncodeOptions(rally_at_home=True)
    )
    for item in (*mission.mission, *mission.fence, *mission.rally):
        message = wire.MAVLink_mission_item_int_message(
            1,
            1,
            item.seq,
            item.frame,
            item.command,
            int(item.current),
            int(item.autocontinue),
            item.param1,
            item.param2,
            item.param3,
            item.param4,
            item.x,
            item.y,
            item.z,
            item.mission_type,
        )
        (parsed,) = wire.MAVLink(None).parse_buffer(message.pack(link))
        assert (parsed.seq, parsed.frame, parsed.command) == (item.seq, item.frame, item.command)
        assert (parsed.x, parsed.y, parsed.mission_type) == (item.x, item.y, item.mission_type)
        for name in ("param1", "param2", "param3", "param4", "z"):
            np.testing.assert_equal(getattr(parsed, name), float(np.float32(getattr(item, name))))


@pytest.mark.parametrize(("reference", "frame"), [("home", 3), ("terrain", 3), ("amsl", 0)])
def test_altitudes_count_from_what_the_plan_says(reference: AltitudeReference, frame: int) -> None:
    """Heights over home and over flat ground are relative to home, heights over the sea are global."""
    ground_m = 120.0 if reference == "amsl" else 0.0
    plan = make_plan(altitude_reference=reference, ground_m=ground_m)
    mission = encode(plan, options=EncodeOptions(home_altitude_m=120.0))
    assert {item.frame for item in flight(mission) if item.command == W} == {frame}
    assert {item.z for item in flight(mission) if item.command == W} == {300.0 + ground_m}
    takeoff, land = mission.mission[1], mission.mission[-1]
    assert (takeoff.frame, takeoff.z) == (3, 50.0), "the take-off climbs over home"
    assert (land.frame, land.z) == (frame, ground_m), "and the landing is as high as home"
    assert mission.mission[0].z == 120.0


def test_altitudes_may_change_along_the_path() -> None:
    """Waypoints take the altitude of the slope where they stand, inside a segment too."""
    plan = make_plan((Leg(length_m=1000.0, collect_m=(400.0, 500.0)), Leg(length_m=1000.0)))
    (path,) = plan.paths
    first, second = (s for s in path.segments if s.kind == "straight" and abs(s.length_m - 1000.0) < 1.0)
    slopes = {first: (300.0, 350.0), second: (350.0, 300.0)}
    segments = tuple(
        replace(s, start_altitude_m=slopes[s][0], end_altitude_m=slopes[s][1]) if s in slopes else s
        for s in path.segments
    )
    sloping = replace(plan, paths=(replace(path, segments=segments),))
    waypoints = [item for item in flight(encode(sloping)) if item.command == W]
    assert [item.z for item in waypoints] == pytest.approx([320.0, 325.0, 350.0, 300.0], abs=0.02)


def test_a_plan_below_home_is_refused() -> None:
    """An altitude over the sea that lies under home cannot be flown."""
    plan = replace(make_plan(altitude_reference="amsl", ground_m=120.0), altitude_m=100.0)
    with pytest.raises(EncodeError, match="over home"):
        encode(plan)
