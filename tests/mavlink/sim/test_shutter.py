"""The simulated aircraft's camera: photos where planned, told with place and attitude, some lost."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from mavlink.dialects import Autopilot, VehicleType
from mavlink.encoding.encode import encode
from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.state.photos import PhotoTaken
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import CAMERA_MESSAGES, TrackRecorder
from mavlink.wire.items import Command, MissionType
from mavlink.wire.messages import Message
from planner.plan import Plan, Trigger
from tests.mavlink.cameras import with_photos
from tests.mavlink.plans import FRAME, SPEED_M_S, Leg, make_plan
from tests.mavlink.sim.helpers import Station, from_ground

LANES = (
    Leg(length_m=800.0, collect_m=(200.0, 800.0)),
    Leg(turn_deg=180.0, radius_m=100.0),
    Leg(length_m=800.0, collect_m=(150.0, 650.0)),
)
KINDS: list[tuple[Autopilot, VehicleType]] = [
    ("ardupilot", "fixed_wing"),
    ("px4", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("px4", "multirotor"),
]


_TELLING = CAMERA_MESSAGES | {"GLOBAL_POSITION_INT", "SYSTEM_TIME"}


def survey(autopilot: Autopilot, kind: VehicleType, trigger: Trigger = "distance") -> Plan:
    return with_photos(
        make_plan(LANES, autopilot=autopilot, vehicle_type=kind, altitude_m=50.0, circles=False),
        23.0,
        trigger,
    )


def flown(plan: Plan, **settings: object) -> Station:
    """A flight of the plan's mission, from the ground to the ground."""
    vehicle = plan.vehicles[0]
    aircraft = SimulatedAircraft(
        SimSettings(
            # At the sea: the plans' stand-in flies its airspeed at any height.
            home=Place(plan.home[1], plan.home[0], 0.0),
            autopilot=Flavour(vehicle.autopilot),
            vehicle_type=vehicle.type,
            # As PX4 does, which the mission counts on; by default simulated wings fly up to their waypoints.
            acceptance_m=2.24 * SPEED_M_S if (vehicle.autopilot, vehicle.type) == KINDS[1] else 0.0,
            **settings,  # type: ignore[arg-type]
        )
    )
    station = Station(aircraft)
    assert station.upload(encode(plan).mission, MissionType.MISSION) == 0
    station.start()
    while aircraft.armed:
        assert station.now_s < 1500.0, "still flying"
        station.wait(0.5)
    return station


def photos_of(messages: list[Message]) -> tuple[PhotoTaken, ...]:
    """The photos as a station records them."""
    recorder, state = TrackRecorder(), VehicleState()
    for message in messages:
        if message.name not in _TELLING:
            continue
        state = updated(state, message, 0.0)
        recorder.take(message, state)
    return recorder.track().photos


@pytest.mark.parametrize(
    ("autopilot", "kind", "trigger"),
    [*((*kind, "distance") for kind in KINDS), *((*kind, "time") for kind in KINDS[1:3])],
)
def test_a_survey_has_the_photos_of_its_plan(
    autopilot: Autopilot, kind: VehicleType, trigger: Trigger
) -> None:
    """As many as planned within 1 %, each pass begun and ended by one, none missing between.

    What hovers is slow at both ends of a pass, and has some photos more there by time.
    """
    plan = survey(autopilot, kind, trigger)
    station = flown(plan)
    taken = photos_of(station.heard)
    planned = sum(len(photos.places) for photos in plan.photos)
    more = 0.15 if (kind, trigger) == ("multirotor", "time") else 0.01
    assert abs(len(taken) - planned) <= max(1, more * planned)
    if kind == "fixed_wing":
        planned_s = plan.collects[-1].end_s - plan.collects[0].start_s
        assert taken[-1].time_s - taken[0].time_s == pytest.approx(planned_s, rel=0.03)
    places = [FRAME.to_local((photo.lon_deg, photo.lat_deg)) for photo in taken]
    for photos in plan.photos:
        for end in (photos.places[0], photos.places[-1]):
            here = FRAME.to_local(end[:2])
            assert min(math.dist(place, here) for place in places) <= 0.5 * photos.interval_m
        line = [FRAME.to_local(place[:2]) for place in photos.places]
        gaps = [min(math.dist(place, here) for place in places) for here in line]
        assert max(gaps) <= 0.8 * photos.interval_m
    assert all(photo.altitude_amsl_m == pytest.approx(50.0, abs=2.0) for photo in taken)


@pytest.mark.parametrize(
    ("autopilot", "fault", "lost"), [("ardupilot", "photos_lost", True), ("px4", "feedback_lost", False)]
)
def test_lost_photos_are_missing_and_lost_words_too(autopilot: Autopilot, fault: str, lost: bool) -> None:
    """Every seventh: numbers that nobody hears of; what is lost on the way is on the card all the same."""
    station = flown(survey(autopilot, "multirotor"), faults=(fault,))
    numbers = {photo.index for photo in photos_of(station.heard) if photo.index is not None}
    missing = set(range(min(numbers), max(numbers) + 1)) - numbers
    assert len(missing) >= (len(numbers) + len(missing)) // 7 - 1 > 4
    assert station.aircraft.payload.photos >= len(numbers) + (0 if lost else len(missing))


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_a_camera_too_slow_for_what_is_ordered(autopilot: Autopilot) -> None:
    """ArduPilot takes late what comes too soon, PX4 leaves it out: fewer, never nearer in time."""
    plan, least_s = survey(autopilot, "fixed_wing"), 1.5 * 23.0 / SPEED_M_S
    taken = photos_of(flown(plan, camera_interval_s=least_s).heard)
    assert len(taken) < 0.75 * sum(len(photos.places) for photos in plan.photos)
    assert min(b.time_s - a.time_s for a, b in pairwise(taken)) >= least_s - 0.01


@pytest.mark.parametrize(("autopilot", "goes_on"), [("ardupilot", True), ("px4", False)])
def test_photos_go_on_out_of_the_mission_on_ardupilot_alone(autopilot: Autopilot, goes_on: bool) -> None:
    """A return in the midst of a pass: PX4 ends the photos, ArduPilot has to be told."""
    plan = survey(autopilot, "fixed_wing")
    vehicle = plan.vehicles[0]
    home = Place(plan.home[1], plan.home[0], 488.0)
    station = Station(SimulatedAircraft(SimSettings(home=home, autopilot=Flavour(vehicle.autopilot))))
    assert station.upload(encode(plan).mission, MissionType.MISSION) == 0
    station.start()
    while len(photos_of(station.heard)) < 5:
        station.wait(0.5)
    station.say(from_ground("COMMAND_LONG", command=int(Command.NAV_RETURN_TO_LAUNCH), **_ZEROS))
    before = station.aircraft.payload.photos
    station.wait(20.0)
    assert (station.aircraft.payload.photos > before + 5) == goes_on
    station.say(from_ground("COMMAND_LONG", command=int(Command.DO_SET_CAM_TRIGG_DIST), **_ZEROS))
    before = station.aircraft.payload.photos
    station.wait(20.0)
    assert station.aircraft.payload.photos == before
    assert not station.aircraft.payload.sensor_on


def test_px4_tells_of_videos_and_of_what_it_orders() -> None:
    """The capture status says a video and for how long; CAMERA_TRIGGER comes with every photo."""
    plan = survey("px4", "fixed_wing", "video")
    home = Place(plan.home[1], plan.home[0], 488.0)
    station = Station(SimulatedAircraft(SimSettings(home=home, autopilot=Flavour.PX4)))
    assert station.upload(encode(plan).mission, MissionType.MISSION) == 0
    station.start()
    told = []
    while station.aircraft.armed:
        assert station.now_s < 1500.0
        station.wait(0.5)
        status = station.aircraft.payload.reports("CAMERA_CAPTURE_STATUS", station.aircraft.state)[0]
        told.append((status.integer("video_status"), status.integer("recording_time_ms")))
    runs = [now for before, now in pairwise(told) if now[0] and not before[0]]
    assert len(runs) == len(plan.collects)
    longest_s = max(time_ms for _, time_ms in told) / 1000.0
    assert longest_s == pytest.approx(max(c.end_s - c.start_s for c in plan.collects), abs=3.0)
    photos = flown(survey("px4", "fixed_wing")).heard
    names = [message.name for message in photos]
    assert names.count("CAMERA_TRIGGER") == names.count("CAMERA_IMAGE_CAPTURED") > 50


_ZEROS = {f"param{number}": 0.0 for number in range(1, 8)} | {"confirmation": 0}
