"""Messages to state and track; modes in words."""

from __future__ import annotations

import math
from functools import partial

import pytest

from mavlink.state.modes import Autopilot, VehicleType, mode_name, mode_parameters
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import SensorEvent, TrackPoint, TrackRecorder
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message, Value


def received(name: str, /, **fields: Value) -> Message:
    """The message as it comes off the wire, every field present."""
    (message,) = Codec().feed(Codec(1, 1).pack(Message(name, fields)))
    return message


def after(*messages: Message, start: VehicleState | None = None) -> VehicleState:
    state = start or VehicleState()
    for second, message in enumerate(messages):
        state = updated(state, message, float(second))
    return state


@pytest.mark.parametrize(
    ("fields", "autopilot", "kind", "mode"),
    [
        ({"autopilot": 3, "type": 1, "custom_mode": 10}, "ardupilot", "fixed_wing", "AUTO"),
        ({"autopilot": 3, "type": 2, "custom_mode": 3}, "ardupilot", "multirotor", "AUTO"),
        ({"autopilot": 3, "type": 20, "custom_mode": 19}, "ardupilot", "vtol", "QLOITER"),
        ({"autopilot": 3, "type": 1, "custom_mode": 9}, "ardupilot", "fixed_wing", "MODE 9"),
        ({"autopilot": 3, "type": 10, "custom_mode": 10}, "ardupilot", "other", "MODE 10"),
        ({"autopilot": 12, "type": 1, "custom_mode": 4 << 16 | 5 << 24}, "px4", "fixed_wing", "AUTO.RTL"),
        ({"autopilot": 12, "type": 13, "custom_mode": 3 << 16}, "px4", "multirotor", "POSCTL"),
        ({"autopilot": 0, "type": 0, "custom_mode": 5}, "generic", "other", "MODE 5"),
    ],
)
def test_heartbeats_in_words(fields: dict[str, Value], autopilot: str, kind: str, mode: str) -> None:
    """Autopilot, type and mode of every family, unknown numbers kept as numbers."""
    state = after(received("HEARTBEAT", base_mode=0x81, **fields))
    assert (state.autopilot, state.type, state.mode, state.armed) == (autopilot, kind, mode, True)
    assert (state.system_id, state.component_id, state.heard_s) == (1, 1, 0.0)


def test_a_quadplane_is_a_vtol_whatever_its_heartbeats_say() -> None:
    """ArduPlane's say fixed wing; EXTENDED_SYS_STATE tells, and heartbeats after it take nothing back."""
    heartbeat = received("HEARTBEAT", autopilot=3, type=1, custom_mode=10, base_mode=0x81)
    assert after(heartbeat, received("EXTENDED_SYS_STATE", vtol_state=0, landed_state=1)).type == "fixed_wing"
    hovering = received("EXTENDED_SYS_STATE", vtol_state=3, landed_state=2)
    state = after(heartbeat, hovering, heartbeat)
    assert (state.type, state.mode, state.landed) == ("vtol", "AUTO", False)
    copter = received("HEARTBEAT", autopilot=3, type=2, custom_mode=3, base_mode=0x81)
    assert after(copter, hovering).type == "multirotor"


@pytest.mark.parametrize(
    ("autopilot", "kind", "number"),
    [
        *[("ardupilot", "fixed_wing", number) for number in range(30)],
        *[("ardupilot", "multirotor", number) for number in range(30)],
        *[("px4", "fixed_wing", main << 16) for main in range(1, 9)],
        *[("px4", "fixed_wing", 4 << 16 | sub << 24) for sub in range(1, 11)],
    ],
)
def test_a_modes_name_leads_back_to_its_number(autopilot: Autopilot, kind: VehicleType, number: int) -> None:
    """What DO_SET_MODE gets for a name is the mode that bears it; numbers without a mode have no name."""
    name = mode_name(autopilot, kind, number)
    if name.startswith("MODE") or name == "AUTO.-":
        with pytest.raises(ValueError, match="no mode"):
            mode_parameters(autopilot, kind, name)
        return
    enabled, first, second = mode_parameters(autopilot, kind, name)
    assert enabled == 1.0
    assert (int(first) if autopilot == "ardupilot" else int(first) << 16 | int(second) << 24) == number


@pytest.mark.parametrize("name", ["-", "", "AUTO.-", "NO_SUCH", "MANUAL.MISSION"])
@pytest.mark.parametrize("autopilot", ["ardupilot", "px4", "generic"])
def test_unknown_modes_are_refused(autopilot: Autopilot, name: str) -> None:
    """A mode the autopilot has not is a mistake here, before anything is sent."""
    with pytest.raises(ValueError, match="no mode"):
        mode_parameters(autopilot, "fixed_wing", name)


POSITION = received(
    "GLOBAL_POSITION_INT",
    time_boot_ms=12_500,
    lat=473_977_000,
    lon=-85_456_000,
    alt=588_250,
    relative_alt=100_250,
    vx=-1200,
    vy=1600,
    vz=-150,
    hdg=27_050,
)


def test_positions_in_si_units() -> None:
    """1e-7 degrees, millimetres, centimetres a second and centidegrees become degrees, metres and m/s."""
    state = after(POSITION)
    assert (state.lat_deg, state.lon_deg, state.time_s) == (47.3977, -8.5456, 12.5)
    assert (state.altitude_amsl_m, state.relative_altitude_m) == (588.25, 100.25)
    assert (state.velocity_north_m_s, state.velocity_east_m_s, state.velocity_down_m_s) == (-12.0, 16.0, -1.5)
    assert state.heading_deg == 270.5
    assert state.course_deg == pytest.approx(math.degrees(math.atan2(16, -12)))


def test_what_is_not_known_stays_none_or_as_it_was() -> None:
    """The wire's words for "unknown" are not taken for numbers."""
    still = received("GLOBAL_POSITION_INT", hdg=0xFFFF)
    assert after(still).heading_deg is None
    assert after(POSITION, still).heading_deg == 270.5
    assert after(still).course_deg is None
    state = after(
        received("SYS_STATUS", battery_remaining=-1, voltage_battery=0xFFFF),
        received("GPS_RAW_INT", fix_type=3, satellites_visible=255),
        received("MISSION_CURRENT", seq=2, total=0xFFFF),
        received("EXTENDED_SYS_STATE"),
        received("BATTERY_STATUS", battery_remaining=-1),
    )
    assert (state.battery_percent, state.battery_voltage_v, state.satellites) == (None, None, None)
    assert (state.mission_current, state.mission_total, state.mission_state) == (2, None, None)
    assert (state.gps_fix, state.landed) == ("3d", None)


def test_non_numbers_are_not_measurements() -> None:
    """NaN attitude and speed are None; the heading known before stays."""
    nan = math.nan
    state = after(
        POSITION,
        received("ATTITUDE", roll=nan, pitch=nan, yaw=nan),
        received("VFR_HUD", airspeed=nan, groundspeed=math.inf),
    )
    assert (state.roll_deg, state.pitch_deg, state.heading_deg) == (None, None, 270.5)
    assert (state.airspeed_m_s, state.ground_speed_m_s) == (None, None)


def test_everything_else_a_state_is_made_of() -> None:
    """Attitude, speeds, battery, home, mission, landing state and the sensor's switch."""
    state = after(
        received("HEARTBEAT", autopilot=3, type=1),
        received("ATTITUDE", roll=math.radians(-30), pitch=math.radians(5), yaw=math.radians(-90)),
        received("VFR_HUD", airspeed=22.5, groundspeed=20.0),
        received("SYS_STATUS", battery_remaining=80, voltage_battery=15_200),
        received("BATTERY_STATUS", id=0, battery_remaining=79),
        received("BATTERY_STATUS", id=1, battery_remaining=3),
        received("GPS_RAW_INT", fix_type=6, satellites_visible=14),
        received("HOME_POSITION", latitude=470_000_000, longitude=80_000_000, altitude=488_000),
        received("MISSION_CURRENT", seq=4, total=9, mission_state=3),
        received("MISSION_ITEM_REACHED", seq=3),
        received("EXTENDED_SYS_STATE", landed_state=2),
        received("NAMED_VALUE_INT", name="SAR_ON", value=1),
        received("RELAY_STATUS", on=0b101, present=0b011),
    )
    assert (state.roll_deg, state.pitch_deg, state.heading_deg) == pytest.approx((-30, 5, 270), abs=1e-4)
    assert (state.airspeed_m_s, state.ground_speed_m_s) == (22.5, 20.0)
    assert (state.battery_percent, state.battery_voltage_v) == (79.0, 15.2)
    assert (state.gps_fix, state.satellites) == ("rtk_fixed", 14)
    assert (state.home_lat_deg, state.home_lon_deg, state.home_altitude_amsl_m) == (47.0, 8.0, 488.0)
    # ArduPilot counts its items without the home row.
    assert (state.mission_current, state.mission_total, state.mission_reached) == (4, 10, 3)
    assert (state.mission_state, state.landed, state.sensor_on, state.relays_on) == ("active", False, True, 1)


def test_px4_counts_every_item() -> None:
    """Without a home row the total is the number of items."""
    state = after(received("HEARTBEAT", autopilot=12, type=1), received("MISSION_CURRENT", total=9))
    assert state.mission_total == 9


def test_texts_are_kept_and_put_together() -> None:
    """The last twenty; chunks of one text are joined, other texts are not."""
    state = after(*[received("STATUSTEXT", severity=6, text=f"text {number}") for number in range(25)])
    assert [text.text for text in state.texts] == [f"text {number}" for number in range(5, 25)]
    first, second = "x" * 50, "and the end"
    state = after(
        received("STATUSTEXT", severity=2, text=first, id=7, chunk_seq=0),
        received("STATUSTEXT", severity=2, text=second, id=7, chunk_seq=1),
        received("STATUSTEXT", severity=4, text="another", id=8, chunk_seq=0),
    )
    assert [text.text for text in state.texts] == [first + second, "another"]
    assert [text.severity for text in state.texts] == [2, 4]


def test_messages_of_no_concern_leave_the_state_itself() -> None:
    """The very same object: nobody is woken for nothing."""
    state = after(POSITION)
    assert updated(state, received("MISSION_REQUEST", seq=1), 5.0) is state


def record(*messages: Message) -> TrackRecorder:
    recorder = TrackRecorder()
    state = VehicleState()
    for message in messages:
        state = updated(state, message, 0.0)
        recorder.take(message, state)
    return recorder


def at(milliseconds: int) -> Message:
    return received("GLOBAL_POSITION_INT", time_boot_ms=milliseconds, lat=milliseconds, relative_alt=50_000)


def test_an_attitude_that_came_long_before_is_none_of_a_place() -> None:
    """Places go on to come without attitudes: after two seconds the roll is not known any longer."""
    places = [
        received("GLOBAL_POSITION_INT", time_boot_ms=round(1000 * s), lat=1, lon=1)
        for s in (1, 2, 2.9, 3.5, 9)
    ]
    points = record(places[0], received("ATTITUDE", roll=0.1), *places[1:]).track().points
    assert [point.roll_deg is not None for point in points] == [False, True, True, False, False]


def test_points_carry_place_time_and_attitude() -> None:
    """A point is a position with the last attitude and switch before it."""
    recorder = record(
        received("ATTITUDE", roll=math.radians(20)),
        received("NAMED_VALUE_INT", name="SAR_ON", value=1),
        POSITION,
    )
    (point,) = recorder.track().points
    assert point == TrackPoint(
        12.5,
        -8.5456,
        47.3977,
        100.25,
        588.25,
        heading_deg=270.5,
        course_deg=pytest.approx(126.87, abs=0.01),
        roll_deg=pytest.approx(20, abs=1e-5),
        pitch_deg=0.0,
        sensor_on=True,
    )


def test_overtaken_positions_are_left_out_and_reboots_are_not() -> None:
    """Time runs forward within a flight; a clock that fell far back is a new start."""
    times = [
        point.time_s for point in record(*map(at, (9000, 9250, 9250, 9100, 9500, 100, 350))).track().points
    ]
    assert times == [9.0, 9.25, 9.5, 0.1, 0.35]


def test_the_switch_is_recorded_when_it_changes() -> None:
    """Repeated reports are one event; time is the vehicle's, place the last known."""
    reports = [
        received("NAMED_VALUE_INT", name="SAR_ON", value=value, time_boot_ms=1000 + value)
        for value in (0, 1, 1, 0)
    ]
    other = received("NAMED_VALUE_INT", name="OTHER", value=5)
    events = record(at(500), reports[0], reports[1], other, reports[2], reports[3]).track().events
    assert [(event.kind, event.source, event.time_s) for event in events] == [
        ("off", "payload", 1.0),
        ("on", "payload", 1.001),
        ("off", "payload", 1.0),
    ]
    assert events[1].relative_m == 50.0


def test_relays_are_recorded_when_they_change() -> None:
    """Each relay present has its own events; the first report is the state of things, not a change."""
    events = (
        record(
            received("RELAY_STATUS", time_boot_ms=1000, on=0b10, present=0b11),
            received("RELAY_STATUS", time_boot_ms=2000, on=0b01, present=0b11),
            received("RELAY_STATUS", time_boot_ms=3000, on=0b101, present=0b11),
        )
        .track()
        .events
    )
    assert events == (SensorEvent(2.0, "on", "relay", index=0), SensorEvent(2.0, "off", "relay", index=1))


def test_photos_of_both_kinds_are_recorded_once() -> None:
    """ArduPilot's and the camera's own feedback; repeated and failed captures are left out."""
    feedback = received(
        "CAMERA_FEEDBACK",
        img_idx=1,
        lat=470_000_000,
        lng=80_000_000,
        alt_rel=99.5,
        alt_msl=587.5,
        roll=4.0,
        pitch=-2.0,
        yaw=-90.0,
    )
    # Heading east, rolled right: a turn by 90 degrees about down, then by 30 about the nose.
    half, bank = math.sqrt(0.5), math.radians(15.0)
    turned = tuple(half * part for part in (math.cos(bank), math.sin(bank), math.sin(bank), math.cos(bank)))
    captured = received(
        "CAMERA_IMAGE_CAPTURED",
        image_index=2,
        time_boot_ms=7000,
        lat=471_000_000,
        lon=81_000_000,
        relative_alt=98_500,
        alt=586_500,
        capture_result=1,
        q=turned,
    )
    failed = received("CAMERA_IMAGE_CAPTURED", image_index=3, capture_result=0)
    events = record(at(6500), feedback, feedback, captured, captured, failed).track().events
    near = partial(pytest.approx, abs=1e-3)
    assert events == (
        SensorEvent(6.5, "photo", "camera", 8.0, 47.0, 99.5, 1, 587.5, 270.0, 4.0, -2.0),
        SensorEvent(7.0, "photo", "camera", 8.1, 47.1, 98.5, 2, 586.5, near(90.0), near(30.0), near(0.0)),
    )


def test_photos_in_radians_and_whose_attitude_they_tell() -> None:
    """In order of time; a camera's own attitude is told apart from the airframe's, no place is no photo."""
    of_autopilot = received(
        "CAMERA_FEEDBACK", img_idx=4, time_usec=9_000_000, lat=470_000_000, lng=80_000_000, alt_msl=587.5,
        roll=-30.0, pitch=6.0, yaw=-90.0,
    )  # fmt: skip
    down_q = (math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0)
    fields: dict[str, Value] = {"image_index": 7, "time_boot_ms": 8000, "lat": 1, "lon": 1, "alt": 90_000}
    captured = Message("CAMERA_IMAGE_CAPTURED", fields | {"capture_result": 1, "q": down_q})
    (of_camera,) = Codec().feed(Codec(1, 100).pack(captured))
    nowhere = received("CAMERA_FEEDBACK", img_idx=1)
    photos = record(nowhere, at(9000), of_autopilot, of_camera).track().photos
    assert [(photo.index, photo.source, photo.time_s) for photo in photos] == [
        (7, "camera", 8.0),
        (4, "autopilot", 9.0),
    ]
    down, level = photos
    assert down.pitch_rad == pytest.approx(-math.pi / 2.0, abs=1e-3)
    assert level.altitude_amsl_m == 587.5
    assert (level.roll_rad, level.pitch_rad, level.yaw_rad) == pytest.approx(
        (math.radians(-30.0), math.radians(6.0), math.radians(270.0))
    )


def test_a_photo_has_the_time_of_the_camera_in_the_vehicles_clock() -> None:
    """Since 1970 or since boot, as the camera tells; what fits neither clock has the time it was heard."""

    def photo(index: int, time_s: float) -> Message:
        return received("CAMERA_FEEDBACK", img_idx=index, time_usec=round(time_s * 1e6), lat=1, lng=1)

    clock = received("SYSTEM_TIME", time_unix_usec=1_700_000_100_000_000, time_boot_ms=100_000)
    heard = [at(103_000), photo(1, 1_700_000_102.8), photo(2, 102.9), photo(3, 77.0), photo(4, 0.0)]
    events = record(clock, *heard).track().events
    assert [event.time_s for event in events] == pytest.approx([102.8, 102.9, 103.0, 103.0])


def test_a_camera_without_a_position_has_the_vehicles() -> None:
    """Latitude and longitude zero are no place."""
    (event,) = record(POSITION, received("CAMERA_FEEDBACK", img_idx=1)).track().events
    assert (event.lon_deg, event.lat_deg, event.relative_m) == (-8.5456, 47.3977, 100.25)
    assert event.amsl_m == 588.25


def test_a_very_long_flight_is_thinned_not_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beyond the limit every second point goes, from then on also of those to come; the ends stay."""
    monkeypatch.setattr("mavlink.state.track._MOST_POINTS", 10)
    points = record(*[at(1000 * second) for second in range(60)]).track().points
    assert len(points) <= 11
    assert points[0].time_s == 0.0
    assert points[-1].time_s > 50.0
