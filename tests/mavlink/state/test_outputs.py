"""Which output shows that the sensor is on, and what the track makes of it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.encoding.payload import ActuatorPayload, Payload, parse_payload, switch_items
from mavlink.links.link import memory_pair
from mavlink.sim.modes import Flavour
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.state.outputs import (
    CameraOutput,
    PhotoOutput,
    RelayOutput,
    SensorOutput,
    ServoOutput,
    function_parameters,
    output_of,
    pulse_parameters,
    switched_by,
)
from mavlink.state.sensor import SensorWatch
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import Track, TrackRecorder, unwrapped_s
from mavlink.station.client import VehicleClient
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from tests.mavlink.state.test_telemetry import at, received
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time


def recorded(output: SensorOutput | None, *messages: Message) -> Track:
    """The track of some messages."""
    recorder, state = TrackRecorder(output), VehicleState()
    for message in messages:
        state = updated(state, message, 0.0)
        recorder.take(message, state)
    return recorder.track()


def pulses(time_s: float, port: int = 0, **channels: int) -> Message:
    """SERVO_OUTPUT_RAW, its time in the 32 bits it has."""
    return received("SERVO_OUTPUT_RAW", time_usec=round(time_s * 1e6) & 0xFFFFFFFF, port=port, **channels)


@pytest.mark.parametrize(
    ("text", "output"),
    [
        ("relay:3", RelayOutput(3)),
        ("servo:9", ServoOutput(0, 9, 1900.0, 1100.0)),
        ("servo:17:1000:2000", ServoOutput(1, 1, 1000.0, 2000.0)),
        ("camera:distance=25", PhotoOutput()),
        ("trigger:distance=25", PhotoOutput()),
        ("trigger:time=1.5", CameraOutput()),
        ("trigger:video", None),
        ("relay:1+trigger:distance=25", None),
        ("image:interval=2", CameraOutput()),
        ("command:31010:1/0", None),
    ],
)
def test_payloads_that_say_themselves_where_they_show(text: str, output: SensorOutput | None) -> None:
    """No parameter is needed."""
    payload = parse_payload(text)
    assert function_parameters(payload, "ardupilot") == ()
    assert output_of(payload, "ardupilot") == output


def test_an_actuator_is_found_by_its_function() -> None:
    """Group and number from the function, the pulses from limits and direction where the vehicle has them."""
    payload = switched_by(parse_payload("relay:1"), "px4")
    assert payload == ActuatorPayload(2)
    names = function_parameters(payload, "px4")
    assert {"PWM_MAIN_FUNC1", "PWM_AUX_FUNC8"} <= set(names)
    functions = dict.fromkeys(names, 0.0) | {"PWM_MAIN_FUNC3": 301.0, "PWM_AUX_FUNC6": 302.0}
    assert pulse_parameters(payload, "px4", functions) == ("PWM_AUX_MIN6", "PWM_AUX_MAX6", "PWM_AUX_REV")
    assert output_of(payload, "px4", functions) == ServoOutput(1, 6, 2000.0, 1000.0)
    limited = functions | {"PWM_AUX_MIN6": 900.0, "PWM_AUX_MAX6": 2100.0, "PWM_AUX_REV": 32.0}
    assert output_of(payload, "px4", limited) == ServoOutput(1, 6, 900.0, 2100.0)
    half = ActuatorPayload(2, 0.5, 0.0)
    assert output_of(half, "px4", functions) == ServoOutput(1, 6, 1750.0, 1500.0)


def test_a_named_output_alone_is_asked_for_and_watched() -> None:
    """Others that follow the same actuator are left alone; one that follows another shows nothing."""
    payload = switched_by(parse_payload("aux:3:2"), "px4")
    assert function_parameters(payload, "px4") == ("PWM_AUX_FUNC3",)
    functions = {"PWM_AUX_FUNC3": 302.0, "PWM_MAIN_FUNC1": 302.0}
    assert pulse_parameters(payload, "px4", functions) == ("PWM_AUX_MIN3", "PWM_AUX_MAX3", "PWM_AUX_REV")
    assert output_of(payload, "px4", functions) == ServoOutput(1, 3, 2000.0, 1000.0)
    assert output_of(payload, "px4", {**functions, "PWM_AUX_FUNC3": 301.0}) is None


def test_an_actuator_without_output_shows_nowhere() -> None:
    """No output has its function: there is nothing to watch."""
    payload = ActuatorPayload(1)
    assert pulse_parameters(payload, "px4", {}) == ()
    assert output_of(payload, "px4", {"PWM_MAIN_FUNC1": 101.0}) is None


@pytest.mark.parametrize(
    ("text", "on", "off"),
    [
        ("servo:9:1900:1100", pulses(1.0, servo9_raw=1800), pulses(2.0, servo9_raw=1500)),
        ("servo:9:1100:1900", pulses(1.0, servo9_raw=1100), pulses(2.0, servo9_raw=0)),
        ("servo:18", pulses(1.0, 1, servo2_raw=1900), pulses(2.0, 1, servo2_raw=1100)),
        (
            "relay:2",
            received("RELAY_STATUS", on=0b100, present=0b100),
            received("RELAY_STATUS", on=0b011, present=0b111),
        ),
        (
            "image:interval=2",
            received("CAMERA_CAPTURE_STATUS", image_status=3),
            received("CAMERA_CAPTURE_STATUS", image_status=1),
        ),
    ],
)
def test_points_know_whether_the_output_was_on(text: str, on: Message, off: Message) -> None:
    """Unknown before the first report, then as last reported."""
    output = output_of(parse_payload(text), "ardupilot")
    track = recorded(output, at(0), on, at(1000), off, at(2000))
    assert [point.sensor_on for point in track.points] == [None, True, False]


@pytest.mark.parametrize(
    "other",
    [
        pulses(1.0, servo8_raw=1900, servo9_raw=1100),
        pulses(1.0, port=1, servo9_raw=1900),
        received("RELAY_STATUS", on=1, present=1),
        received("CAMERA_CAPTURE_STATUS", image_status=2),
    ],
)
def test_other_outputs_are_of_no_concern(other: Message) -> None:
    """Another channel, another port, another kind: the sensor is not on for them."""
    output = output_of(parse_payload("servo:9"), "ardupilot")
    track = recorded(output, other, at(1000))
    assert not track.points[0].sensor_on
    assert [event for event in track.events if event.source == "servo"] == []


def test_switches_of_a_servo_are_events_in_the_vehicles_time() -> None:
    """Past 71.6 minutes the message's own count has begun anew; the event's has not."""
    output = output_of(parse_payload("servo:5"), "ardupilot")
    late_s = 2 * 2**32 / 1e6 + 12.0
    track = recorded(
        output,
        at(round(late_s * 1000)),
        pulses(late_s + 0.1, servo5_raw=1100),
        pulses(late_s + 0.2, servo5_raw=1900),
        pulses(late_s + 0.3, servo5_raw=1890),
        pulses(late_s + 0.4, servo5_raw=1100),
    )
    assert [(event.kind, event.source, event.index) for event in track.events] == [
        ("on", "servo", 5),
        ("off", "servo", 5),
    ]
    assert [event.time_s for event in track.events] == pytest.approx([late_s + 0.2, late_s + 0.4], abs=2e-3)


@given(st.floats(0, 4e6), st.floats(-600, 600))
def test_a_time_is_made_whole_again(time_s: float, off_s: float) -> None:
    """Whatever was cut off comes back from a time some minutes away."""
    told_s = (round(time_s * 1e6) & 0xFFFFFFFF) / 1e6
    assert unwrapped_s(told_s, time_s + off_s) == pytest.approx(time_s, abs=1e-3)


def test_a_sensor_that_reports_itself_is_believed_before_its_output() -> None:
    """The output says what was ordered, the sensor what it does."""
    output = output_of(parse_payload("relay:0"), "ardupilot")
    closed = received("RELAY_STATUS", on=1, present=1)
    dead = received("NAMED_VALUE_INT", name="SAR_ON", value=0)
    track = recorded(output, closed, at(0), dead, at(1000))
    assert [point.sensor_on for point in track.points] == [True, False]


@pytest.mark.parametrize("on", [True, False])
def test_a_sensor_that_repeats_itself_and_falls_silent_tells_nothing(on: bool) -> None:
    """Its output closed it may be dead; open it is off. One that tells changes alone still counts."""
    output = output_of(parse_payload("relay:0"), "ardupilot")
    told = received("NAMED_VALUE_INT", name="SAR_ON", value=int(on))
    switched = received("RELAY_STATUS", on=int(on), present=1)
    track = recorded(output, at(500), told, at(1000), told, at(5500), switched, at(9000))
    assert [point.sensor_on for point in track.points] == [None, on, on, None if on else False]
    track = recorded(output, at(500), told, at(1000), at(60_000))
    assert [point.sensor_on for point in track.points] == [None, on, on]


PAYLOADS: list[Payload] = [parse_payload(t) for t in ("relay:0", "servo:9", "actuator:1", "image:interval=1")]


@pytest.mark.parametrize("payload", PAYLOADS)
def test_without_a_report_nothing_is_claimed(payload: Payload) -> None:
    """A vehicle that never tells of the output leaves the sensor unknown."""
    output = output_of(payload, "ardupilot", {"PWM_MAIN_FUNC1": 301.0})
    assert output is not None
    assert [point.sensor_on for point in recorded(output, at(0), at(1000)).points] == [None, None]


@asynccontextmanager
async def simulated(settings: SimSettings) -> AsyncIterator[VehicleClient]:
    """A client of a simulated aircraft that stands on the ground."""
    here, there = memory_pair()
    flying = asyncio.create_task(serve_link(there, settings))
    try:
        async with VehicleClient(here, clock=loop_time_s) as client:
            await client.connect(5.0)
            yield client
    finally:
        flying.cancel()
        with contextlib.suppress(asyncio.CancelledError):
            await flying


@pytest.mark.parametrize(
    ("flavour", "text", "expected"),
    [
        (Flavour.ARDUPILOT, "relay:3", RelayOutput(3)),
        (Flavour.ARDUPILOT, "servo:9:1100:1900", ServoOutput(0, 9, 1100.0, 1900.0)),
        (Flavour.ARDUPILOT, "servo:20", ServoOutput(1, 4, 1900.0, 1100.0)),
        (Flavour.ARDUPILOT, "image:interval=1", CameraOutput()),
        (Flavour.PX4, "relay:1", ServoOutput(0, 6, 2000.0, 1000.0)),
        (Flavour.PX4, "actuator:1:-0.5:0.5", ServoOutput(0, 5, 1250.0, 1750.0)),
    ],
)
async def test_the_track_follows_the_orders_of_every_payload(
    flavour: Flavour, text: str, expected: SensorOutput
) -> None:
    """Parameters, message intervals and reports come from the vehicle; the sensor itself says nothing."""
    payload = parse_payload(text)
    async with simulated(SimSettings(autopilot=flavour, sensor_reports=False)) as client:
        output = await client.sensor_output(payload)
        assert output == expected
        recorder = client.start_recording(output)
        on, off = switch_items(switched_by(payload, client.state.autopilot))
        for item, wanted in ((on, True), (off, False), (on, True)):
            parameters = (item.param1, item.param2, item.param3, item.param4)
            assert (await client.command(item.command, parameters)).accepted
            async with asyncio.timeout(PATIENCE_S):
                while [point.sensor_on for point in recorder.track().points[-1:]] != [wanted]:
                    await asyncio.sleep(0.02)
        kinds = [event.kind for event in recorder.track().events if event.kind != "photo"]
        assert kinds[-2:] == ["off", "on"]


async def test_cameras_beside_the_autopilot_are_heard() -> None:
    """Photos of another component of the same system are in the track; those of another system are not."""
    here, there = memory_pair()
    photo = Message("CAMERA_IMAGE_CAPTURED", {"image_index": 1, "capture_result": 1, "lat": 1, "lon": 1})
    heartbeat = Message("HEARTBEAT", {"autopilot": 3, "type": 1, "mavlink_version": 3})
    async with VehicleClient(here, clock=loop_time_s) as client:
        connecting = asyncio.create_task(client.connect(5.0))
        await there.send(Codec(7, 1).pack(heartbeat))
        await connecting
        recorder = client.start_recording()
        for system, component in ((8, 100), (7, 100), (7, 101)):
            await there.send(Codec(system, component).pack(photo))
        async with asyncio.timeout(PATIENCE_S):
            while len(recorder.track().events) < 2:
                await asyncio.sleep(0.01)
    assert [event.kind for event in recorder.track().events] == ["photo", "photo"]
    await there.close()


def test_each_photo_shows_a_while_that_its_camera_is_on() -> None:
    """Released by distance, a camera that rests shows nothing: then nobody can tell, and it may be on."""
    watch, state, told = SensorWatch(PhotoOutput()), VehicleState(), []
    photo = received("CAMERA_FEEDBACK", img_idx=1)
    times_s = (1.0, 2.0, 4.0, 4.5, 9.0)
    for time_s in times_s:
        messages = [received("GLOBAL_POSITION_INT", time_boot_ms=round(1000 * time_s), lat=1, lon=1)]
        for message in (*messages, *([photo] if time_s == 2.0 else [])):
            state = watch.watched(updated(state, message, time_s), message, time_s)
        told.append(state.sensor_shown)
    assert told == [None, True, True, True, None]
    failed = received("CAMERA_IMAGE_CAPTURED", image_index=2, capture_result=0)
    assert watch.watched(updated(state, failed, 9.0), failed, 9.0).sensor_shown is None


def test_videos_show_on_px4() -> None:
    """By the camera's own status; ArduPilot's says nothing of them."""
    payload = parse_payload("trigger:video")
    output = output_of(payload, "px4")
    assert output is not None
    for video, interval, on in ((1, 0, True), (0, 0, False), (0, 2, False)):
        message = received("CAMERA_CAPTURE_STATUS", image_status=interval, video_status=video)
        assert output.reads(message) is on
    assert output_of(payload, "ardupilot") is None


@pytest.mark.parametrize(
    ("output", "on", "off"),
    [
        (
            RelayOutput(0),
            received("RELAY_STATUS", on=1, present=1),
            received("RELAY_STATUS", on=0, present=1),
        ),
        (ServoOutput(0, 9, 1900.0, 1100.0), pulses(1.0, servo9_raw=1900), pulses(1.0, servo9_raw=1100)),
    ],
)
def test_an_output_that_is_silent_tells_nothing(output: SensorOutput, on: Message, off: Message) -> None:
    """Of places that come long after it was last told nobody knows; told again, it is on again."""

    def shown(*messages: Message) -> list[bool | None]:
        return [point.sensor_on for point in recorded(output, *messages).points]

    assert shown(at(1000), on, at(2000), at(5500), at(6500), at(60_000)) == [None, True, True, None, None]
    assert shown(on, at(1000), at(5500), at(6500), on, at(7000)) == [True, True, None, True]
    assert shown(at(1000), off, at(2000), at(60_000)) == [None, False, None]


STEPS = st.one_of(
    st.tuples(st.just("at"), st.sampled_from([200, 1000, 2500, 4900, 5100, 9000])),
    st.tuples(st.sampled_from(["output", "report"]), st.booleans()),
)


@given(st.lists(STEPS, max_size=30), st.sampled_from([RelayOutput(0), ServoOutput(0, 9, 1900.0, 1100.0)]))
def test_what_is_shown_live_is_what_the_record_holds(
    steps: list[tuple[str, int]], output: RelayOutput | ServoOutput
) -> None:
    """Whatever was told and when: at each place, both know as much of the sensor."""
    now_ms, messages = 0, []
    for kind, value in steps:
        if kind == "at":
            now_ms += value
            messages.append(at(now_ms))
        elif kind == "report":
            messages.append(received("NAMED_VALUE_INT", name="SAR_ON", value=int(value)))
        elif isinstance(output, RelayOutput):
            messages.append(received("RELAY_STATUS", on=int(value), present=1))
        else:
            messages.append(pulses(now_ms / 1000.0, servo9_raw=1900 if value else 1100))
    watch, state, live = SensorWatch(output), VehicleState(), []
    for message in messages:
        state = watch.watched(updated(state, message, 0.0), message, 0.0)
        if message.name == "GLOBAL_POSITION_INT":
            live.append(state.sensor_shown)
    assert live == [point.sensor_on for point in recorded(output, *messages).points]
