"""Whole flights at random, decoded from their items: places, heights and order are the plan's."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point

from mavlink.dialects import Autopilot, VehicleType
from mavlink.dialects.compare import differences
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.wire.items import Command, Frame, MissionItem
from planner.geojson import read_plan, write_plan
from planner.plan import AltitudeReference, Finish, Plan
from planner.route import Pose
from tests.mavlink.encoding.missions import KINDS, LANDINGS, L, W, local
from tests.mavlink.plans import CIRCLE_M, FRAME, Leg, make_plan

CHORD_ERROR_M = 2.0
#: What the wire leaves of a place (1e-7°), and the judge's own steps.
ROUNDING_M = 0.3
TAKEOFFS = (Command.NAV_TAKEOFF, Command.NAV_VTOL_TAKEOFF)
SWITCHES = (Command.DO_SET_RELAY, Command.DO_SET_ACTUATOR)


@dataclass(frozen=True)
class Flown:
    plan: Plan = field(repr=False)
    autopilot: Autopilot
    kind: VehicleType


@st.composite
def legs(draw: st.DrawFn) -> tuple[Leg, ...]:
    """Straights, some with a collect that may take all of it, and arcs between."""
    found: list[Leg] = []
    for _ in range(draw(st.integers(1, 3))):
        length_m = draw(st.floats(200.0, 2000.0))
        whole = draw(st.booleans())
        collect_m = draw(
            st.sampled_from([None, (0.0, length_m) if whole else (0.2 * length_m, 0.7 * length_m)])
        )
        found.append(Leg(length_m=length_m, collect_m=collect_m))
        if draw(st.booleans()):
            turn_deg = draw(st.floats(5.0, 350.0)) * draw(st.sampled_from([-1.0, 1.0]))
            found.append(Leg(turn_deg=turn_deg, radius_m=draw(st.floats(60.0, 400.0))))
    return tuple(found)


@st.composite
def flights(draw: st.DrawFn, kinds: Sequence[tuple[Autopilot, VehicleType]] = KINDS) -> Flown:
    """A plan of any of these autopilots and aircraft, anywhere, with any end that it takes."""
    autopilot, kind = draw(st.sampled_from(kinds))
    lands = autopilot == "px4" and kind != "multirotor"
    finish: Finish = "land" if lands else draw(st.sampled_from(["land", "return", "loiter"]))
    reference: AltitudeReference = draw(st.sampled_from(["amsl", "home", "terrain"]))
    # Straight up and down, where there is height to win at all.
    circles = draw(st.booleans())
    plan = make_plan(
        draw(legs()),
        autopilot=autopilot,
        vehicle_type=kind,
        finish=finish,
        start=Pose(
            draw(st.floats(-3000.0, 3000.0)), draw(st.floats(-3000.0, 3000.0)), draw(st.floats(-3.1, 3.1))
        ),
        altitude_m=draw(st.floats(120.0, 900.0) if circles else st.floats(30.0, 900.0)),
        circles=circles,
        altitude_reference=reference,
        ground_m=draw(st.floats(0.0, 1500.0)) if reference == "amsl" else 0.0,
    )
    # As made, or as a file has it, with rounded distances.
    return Flown(read_plan(write_plan(plan)) if draw(st.booleans()) else plan, autopilot, kind)


def over_datum_m(item: MissionItem, plan: Plan) -> float:
    """Altitude of an item over the plan's datum: those over home count from where its path begins."""
    return item.z + (0.0 if item.frame == Frame.GLOBAL else plan.paths[0].line[0][2])


def heights_near_m(plan: Plan, place: tuple[float, float], within_m: float) -> list[float]:
    """Altitudes of the path wherever it passes a place: a line may cross itself."""
    line = np.array(plan.paths[0].line)
    xy = np.column_stack(FRAME.to_local(line[:, :2]).T)
    found: list[float] = []
    for (a, b), (low, high) in zip(pairwise(xy), pairwise(line[:, 2]), strict=True):
        edge = LineString([a, b])
        here = Point(place)
        if edge.distance(here) > within_m:
            continue
        if edge.length < 0.01:
            found += [float(low), float(high)]
            continue
        part = edge.project(here, normalized=True)
        found.append(float(low + part * (high - low)))
    return found


@given(flights())
@settings(max_examples=60, deadline=None)
def test_the_items_lie_on_the_plans_line_at_its_heights(flown: Flown) -> None:
    """Take-off, waypoints and landing: each on the path, each as high as the path is there."""
    options = EncodeOptions(chord_error_m=CHORD_ERROR_M, off_delay_m=0.0)
    items = encode(flown.plan, options=options).mission
    first = next(index for index, item in enumerate(items) if item.command in TAKEOFFS)
    for item in items[first:]:
        if item.command not in (W, *TAKEOFFS, *LANDINGS):
            continue
        heights_m = heights_near_m(flown.plan, local(item), ROUNDING_M)
        assert heights_m, f"item {item.seq} lies off the path"
        assert min(abs(h - over_datum_m(item, flown.plan)) for h in heights_m) < 0.2


@given(flights())
@settings(max_examples=60, deadline=None)
def test_whole_turns_are_circles_up_to_their_height(flown: Flown) -> None:
    """Each climbing or descending circle of the path is one item: centre, side, radius, last height."""
    plan = flown.plan
    items = encode(plan).mission
    turns = [s for s in plan.paths[0].segments if (s.turn_deg or 0.0) >= 359.0]
    circles = [item for item in items if item.command in (L, Command.NAV_LOITER_UNLIM)]
    if flown.kind == "multirotor":
        assert not turns
        assert L not in [item.command for item in items]
        return
    for segment, item in zip(turns, circles, strict=True):
        assert segment.centre is not None
        assert math.dist(local(item), FRAME.to_local(segment.centre)) < 0.05
        signed_m = item.param2 if item.command == L else item.param3
        assert math.copysign(1.0, signed_m) == (1.0 if segment.kind == "right" else -1.0)
        # ArduPlane widens its circles as the air thins: by 15 % at 1500 m.
        assert 0.8 * CIRCLE_M <= abs(signed_m) <= CIRCLE_M
        assert abs(over_datum_m(item, plan) - segment.end_altitude_m) < 0.01


@given(flights())
@settings(max_examples=60, deadline=None)
def test_the_sensor_is_on_over_the_collects_and_off_before_the_end(flown: Flown) -> None:
    """On and off by turns between the ends of each collect; whatever happened, off before it comes down."""
    plan = flown.plan
    items = encode(plan, options=EncodeOptions(off_delay_m=0.0)).mission
    lit: list[tuple[tuple[float, float], tuple[float, float]]] = []
    since: tuple[float, float] | None = None
    place = (0.0, 0.0)
    for item in items:
        if item.command in SWITCHES:
            on = (item.param2 if item.command == Command.DO_SET_RELAY else item.param1) > 0.0
            if on and since is None:
                since = place
            elif not on and since is not None:
                lit.append((since, place))
                since = None
        elif item.x or item.y:
            place = local(item)
    assert since is None
    assert len(lit) == len(plan.collects)
    for pair, collect in zip(lit, plan.collects, strict=True):
        for here, end in zip(pair, collect.line, strict=True):
            assert math.dist(here, FRAME.to_local(end[:2])) < 0.6
    if plan.collects:
        last = max(index for index, item in enumerate(items) if item.command in SWITCHES)
        ends = (*LANDINGS, Command.NAV_RETURN_TO_LAUNCH, Command.NAV_LOITER_UNLIM)
        assert any(item.command in ends for item in items[last:])


@given(flights())
@settings(max_examples=60, deadline=None)
def test_the_autopilot_takes_it_and_gives_it_back(flown: Flown) -> None:
    """No rule of the dialect is broken, PX4's feasibility among them, and the read-back is what was sent."""
    mission = encode(flown.plan, options=EncodeOptions(rally_at_home=True))
    for items in (mission.mission, mission.fence, mission.rally):
        assert mission.dialect.check(items) == ()
    held = mission.dialect.expected_readback(mission.mission)
    assert differences(mission.mission, held, mission.dialect) == ()


@given(flights([("px4", "multirotor")]))
@settings(max_examples=40, deadline=None)
def test_px4s_multirotors_have_no_places_to_stop_at(flown: Flown) -> None:
    """Nearer than its acceptance radius it stops: only where the sensor is switched at both."""
    items = encode(flown.plan).mission
    switched = {before.seq for before, after in pairwise(items) if after.command in SWITCHES}
    places = [item for item in items if item.command == W]
    for before, item in pairwise(places[:-1]):
        near = math.dist(local(before), local(item)) < 2.0
        assert not near or {before.seq, item.seq} <= switched


@given(flights([("px4", "fixed_wing")]))
@settings(max_examples=30, deadline=None)
def test_px4_fixed_wings_get_what_the_feasibility_check_wants(flown: Flown) -> None:
    """Written out from PX4's rules: take-off first and above home, a landing at the end, at most 5° down."""
    items = encode(flown.plan).mission
    placed = [item for item in items if item.frame != Frame.MISSION]
    assert placed[0] is items[0]
    assert items[0].command == Command.NAV_TAKEOFF
    assert items[0].z > 11.0
    numbers = [int(item.command) for item in items]
    assert numbers.count(Command.DO_LAND_START) == 1
    straight_in = flown.plan.paths[0].phase("return") is None
    assert numbers[-2:] == [W if straight_in else L, Command.NAV_LAND]
    assert numbers.index(Command.DO_LAND_START) < len(numbers) - 2
    assert Command.NAV_RETURN_TO_LAUNCH not in numbers
    before, land = items[-2:]
    run_m = math.dist(local(before), local(land))
    drop_m = over_datum_m(before, flown.plan) - over_datum_m(land, flown.plan)
    assert drop_m > 0.0
    if not straight_in:
        assert run_m > abs(before.param2)
        run_m = math.sqrt(run_m**2 - before.param2**2)
    assert math.degrees(math.atan2(drop_m, run_m)) <= 5.0
