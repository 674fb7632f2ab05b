"""Cameras of a plan: photos where the plan has them, nothing between the lanes, nothing left on."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import (
    JointPayload,
    PayloadError,
    ServoPayload,
    TriggerPayload,
    off_items,
    parse_payload,
)
from mavlink.encoding.trigger import payload_of, specified
from mavlink.state.passes import passes_of
from mavlink.wire.items import Command, MissionItem
from planner.plan import Plan, Trigger
from tests.mavlink.cameras import with_photos
from tests.mavlink.encoding.missions import KINDS, W, flight, local
from tests.mavlink.plans import FRAME, SPEED_M_S, Leg, make_plan

DISTANCE, DIGICAM, IMAGE, STOP = (
    Command.DO_SET_CAM_TRIGG_DIST,
    Command.DO_DIGICAM_CONTROL,
    Command.IMAGE_START_CAPTURE,
    Command.IMAGE_STOP_CAPTURE,
)
#: How often each autopilot looks, and how long it takes from there to the shutter, in seconds: by its source,
#: and so that photos come as late as measured.
LOOKS_S = {"ardupilot": 0.02, "px4": 0.05}
LAGS_S = {"ardupilot": 0.005, "px4": 0.010}


def orders(plan: Plan, options: EncodeOptions | None = None) -> list[MissionItem]:
    """What a mission orders of its sensors, in flight order."""
    mission = encode(plan, options=options or EncodeOptions())
    flown_to = (W, Command.NAV_LOITER_TURNS)
    return [item for item in flight(mission) if item.command not in flown_to]


def said(item: MissionItem) -> tuple[float, ...]:
    return (item.command, item.param1, item.param2, item.param3)


def taken(spacing_m: float, way_m: float, look_m: float, lag_m: float, seed: int) -> list[float]:
    """Where photos by distance are taken on a way, looked for every so many metres, never quite evenly."""
    chance = random.Random(seed)
    found, at_m = [0.0], 0.0
    while (at_m := at_m + look_m * chance.uniform(0.7, 1.3)) <= way_m:
        if at_m - found[-1] >= spacing_m:
            found.append(at_m + lag_m)
    return found


@given(
    kind=st.sampled_from(KINDS),
    length_m=st.floats(90.0, 1500.0),
    wanted_m=st.floats(25.0, 80.0),
    off=st.floats(-1.0, 0.9),
    seed=st.integers(0, 1000),
)
def test_exactly_the_photos_of_the_plan_are_taken(
    kind: tuple[Autopilot, VehicleType], length_m: float, wanted_m: float, off: float, seed: int
) -> None:
    """Wherever within half a second the ends are passed: a photo at each end, the others evenly between."""
    autopilot, vehicle_type = kind
    legs = (Leg(length_m=length_m + 600.0, collect_m=(300.0, 300.0 + length_m)), Leg(turn_deg=90.0))
    plan = with_photos(make_plan(legs, autopilot=autopilot, vehicle_type=vehicle_type), wanted_m)
    on, end = orders(plan)
    (photos,) = plan.photos
    late_m = off * (0.8 if vehicle_type == "multirotor" else min(0.5 * SPEED_M_S, 0.2 * photos.interval_m))
    assert said(end) == (DISTANCE, 0.0, 0.0, 1.0), "off, with a last photo"
    assert (on.command, on.param3) == (DISTANCE, 1.0), "the first one at once"
    look_m, lag_m = (SPEED_M_S * table[autopilot] for table in (LOOKS_S, LAGS_S))
    places_m = taken(on.param1, length_m + late_m, look_m, lag_m, seed)
    assert len(places_m) + 1 == len(photos.places)
    gaps_m = [b - a for a, b in zip(places_m, [*places_m[1:], length_m + late_m], strict=True)]
    assert max(gaps_m) <= 1.3 * photos.interval_m + 2.0


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
@pytest.mark.parametrize("trigger", ["distance", "time", "video"])
def test_cameras_are_on_in_their_passes_alone(
    autopilot: Autopilot, kind: VehicleType, trigger: Trigger
) -> None:
    """Every pass lies between its orders; before the landing everything is off once more, without a photo."""
    plan = with_photos(make_plan(autopilot=autopilot, vehicle_type=kind), trigger=trigger)
    mission = encode(plan)
    payload = payload_of(plan, "uav-1", None)
    assert not mission.dialect.check(mission.mission)
    passes = passes_of(mission.mission, payload, autopilot)
    assert len(passes) == len(plan.collects)
    for run in passes:
        inside = [mission.mission[seq].command for seq in run[1:-1]]
        assert Command.NAV_WAYPOINT in inside
    (off,) = off_items(payload)
    behind = [said(item) for item in mission.mission[passes[-1][-1] + 1 :]]
    assert behind.count(said(off)) == 1
    assert off.param3 == 0.0
    back = mission.dialect.expected_readback(mission.mission)
    sent = [item for item in mission.mission if item.command in (DISTANCE, IMAGE, STOP)]
    kept = [item for item in back if item.command in (DISTANCE, IMAGE, STOP)]
    assert [said(item) for item in sent] == [said(item) for item in kept]


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_runs_by_time_are_counted(autopilot: Autopilot) -> None:
    """A camera stops by itself soon after the photos of its pass, whatever becomes of the order to stop."""
    plan = with_photos(make_plan(autopilot=autopilot), trigger="time")
    found = [said(item) for item in orders(plan)]
    for photos in plan.photos:
        on, *rest = found[:3] if autopilot == "ardupilot" else found[:2]
        found = found[1 + len(rest) :]
        assert photos.interval_s is not None
        assert on[2] == pytest.approx(photos.interval_s, rel=0.1)
        assert len(photos.places) < on[3] <= 1.25 * len(photos.places) + 2
        assert ((IMAGE, 0.0, 0.0, 1.0) in rest) == (autopilot == "ardupilot")
        assert rest[-1] == (STOP, 0.0, 0.0, 0.0)
    assert not found


def test_a_pass_of_one_photo_is_one_order() -> None:
    """A single photo is ordered where it is taken, and nothing has to be switched off."""
    plan = with_photos(make_plan((Leg(length_m=600.0, collect_m=(300.0, 305.0)),)))
    one = replace(plan.photos[0], places=plan.photos[0].places[:1])
    for trigger, expected in (("distance", DIGICAM), ("time", IMAGE)):
        camera = replace(plan.cameras[0], trigger=trigger)
        alone = replace(plan, photos=(one,), cameras=(camera,))
        (order,) = orders(alone)
        assert order.command == expected
        assert order.x == 1 if expected == DIGICAM else order.param3 == 1.0
        payload = payload_of(alone, "uav-1", None)
        assert [len(run) for run in passes_of(encode(alone).mission, payload, "ardupilot")] == [1]


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_a_radar_beside_a_camera_is_switched_by_its_output(autopilot: Autopilot) -> None:
    """Each pass by what its sensor is; in the end both are off."""
    plan = with_photos(make_plan(autopilot=autopilot), collects=1)
    output = Command.DO_SET_RELAY if autopilot == "ardupilot" else Command.DO_SET_ACTUATOR
    assert [item.command for item in orders(plan)][:4] == [DISTANCE, DISTANCE, output, output]
    payload = payload_of(plan, "uav-1", None)
    assert isinstance(payload, JointPayload)
    text = specified(plan, "uav-1", None)
    assert text is not None
    assert text.startswith("relay:0+trigger:distance=")
    mission = encode(plan)
    assert len(passes_of(mission.mission, payload, autopilot)) == 2
    assert encode(plan, options=EncodeOptions(payload=parse_payload(text))).mission == mission.mission
    assert {DISTANCE, output} <= {item.command for item in mission.mission[-7:]}


def test_what_is_wished_goes_before_what_the_plan_says() -> None:
    """An output for all of a camera's passes, or another trigger; for radars a trigger is refused."""
    plan = with_photos(make_plan())
    servo = EncodeOptions(payload=ServoPayload(9))
    assert {item.command for item in orders(plan, servo)} == {Command.DO_SET_SERVO}
    video = EncodeOptions(payload=TriggerPayload("video"))
    assert {item.command for item in orders(plan, video)} == {
        Command.VIDEO_START_CAPTURE,
        Command.VIDEO_STOP_CAPTURE,
    }
    assert specified(plan, "uav-1", "servo:9:1900:1100") == "servo:9:1900:1100"
    assert specified(make_plan(), "uav-1", None) is None
    assert payload_of(make_plan(), "uav-1", None) == DEFAULT_PAYLOAD
    with pytest.raises(PayloadError, match="nothing to trigger"):
        encode(make_plan(), options=EncodeOptions(payload=TriggerPayload("distance")))


def test_a_camera_without_photos_is_refused() -> None:
    """A plan that says not where its photos are cannot be flown by them."""
    plan = replace(with_photos(make_plan()), photos=())
    with pytest.raises(EncodeError, match="collect 0 of 'uav-1' has no photos"):
        encode(plan)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("trigger:never", "distance, time or video"),
        ("trigger:distance=-3", "positive"),
        ("trigger:distance=x", "could not convert"),
        ("relay:0+servo:9", "one output"),
        ("trigger:time+trigger:time", "each trigger once"),
    ],
)
def test_specifications_that_cannot_be_meant_are_refused(text: str, match: str) -> None:
    """In words that say what is meant instead."""
    with pytest.raises(PayloadError, match=match):
        parse_payload(text)


def test_the_largest_spacing_is_told_rounded_up() -> None:
    """What is farther apart than told is a gap, so nothing planned may be."""
    plan = with_photos(make_plan(), 41.0)
    payload = parse_payload(str(specified(plan, "uav-1", None)))
    assert isinstance(payload, TriggerPayload)
    largest_m = max(photos.interval_m for photos in plan.photos)
    assert payload.spacing is not None
    assert largest_m <= payload.spacing <= largest_m + 0.01 + 1e-9
    assert math.isclose(largest_m, payload.spacing, rel_tol=1e-3)


@pytest.mark.parametrize("kind", ["fixed_wing", "multirotor"])
def test_px4_begins_where_the_pass_does(kind: VehicleType) -> None:
    """It counts waypoints as reached early: that of the first photo lies as far within the pass."""
    plan = with_photos(make_plan(autopilot="px4", vehicle_type=kind))
    early_m = 2.02 if kind == "multirotor" else 2.24 * SPEED_M_S
    items = encode(plan).mission
    begun = [at for at, item in pairwise(items) if item.command == DISTANCE and item.param1]
    for before, collect in zip(begun, plan.collects, strict=True):
        begin, end = (FRAME.to_local(place[:2]) for place in collect.line)
        assert math.dist(local(before), begin) == pytest.approx(early_m, abs=0.05)
        along_m = math.dist(local(before), end) + math.dist(local(before), begin)
        assert along_m == pytest.approx(math.dist(begin, end), abs=0.05)
