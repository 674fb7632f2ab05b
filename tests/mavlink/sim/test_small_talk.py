"""What the simulated aircraft answers to whoever asks, and what it says of itself, by pymavlink's names."""

from __future__ import annotations

import math
import struct

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from pyproj import Geod

from mavlink.sim.modes import Flavour
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.sim.helpers import GROUND, HOME, from_ground, numbered, place_at
from tests.mavlink.sim.stations import loaded, station, told

PARTNER = {"target_system": GROUND[0], "target_component": GROUND[1]}


def test_it_keeps_time_with_the_ground() -> None:
    """TIMESYNC comes back with the aircraft's time and the asker's own; an answer draws none."""
    s = station()
    (answer,) = s.say(Message("TIMESYNC", {"tc1": 0, "ts1": 123_456_789}, *GROUND))
    assert (answer.name, answer.integer("ts1")) == ("TIMESYNC", 123_456_789)
    assert answer.integer("tc1") == round(s.aircraft.sim_time_s * 1e9)
    assert s.say(Message("TIMESYNC", {"tc1": 5, "ts1": 123}, *GROUND)) == []


def test_a_ping_comes_back_to_its_sender() -> None:
    """With the same number and time, addressed to who sent it."""
    asked = {"time_usec": 77, "seq": 9, "target_system": 0, "target_component": 0}
    (answer,) = station().say(Message("PING", asked, *GROUND))
    assert dict(answer.fields) == {"time_usec": 77, "seq": 9, **PARTNER}


def test_files_are_refused_in_the_protocol_s_own_words() -> None:
    """An FTP request draws a NAK of that request, numbered one higher: nothing waits for a time-out."""
    opened = struct.pack("<HBBBBBBI", 41, 0, 4, 5, 0, 0, 0, 0) + b"a.txt"
    request = from_ground("FILE_TRANSFER_PROTOCOL", target_network=0)
    request = Message(request.name, {**request.fields, "payload": tuple(opened.ljust(251, b"\0"))}, *GROUND)
    (answer,) = station().say(request)
    payload = answer.fields["payload"]
    assert isinstance(payload, tuple)
    number, _, opcode, size, of, *_ = struct.unpack("<HBBBBBBI", bytes(map(int, payload[:12])))
    assert (number, opcode, size, of) == (42, 129, 1, 4)


@pytest.mark.parametrize("flavour", list(Flavour))
def test_its_fence_is_present_and_sound(flavour: Flavour) -> None:
    """SYS_STATUS says so by the bit that MAVProxy reads; enabled once one is stored."""
    bit = mavlink.MAV_SYS_STATUS_GEOFENCE
    s = station(flavour)
    status = told(s, "SYS_STATUS")
    assert status.integer("onboard_control_sensors_health") & bit
    assert not status.integer("onboard_control_sensors_enabled") & bit
    place = place_at(0.0, 500.0)
    x, y = round(place.lat_deg * 1e7), round(place.lon_deg * 1e7)
    circle = MissionItem(0, Frame.GLOBAL, Command.NAV_FENCE_CIRCLE_EXCLUSION, 90.0, x=x, y=y)
    assert s.upload(numbered([circle], MissionType.FENCE), MissionType.FENCE) == 0
    assert told(s, "SYS_STATUS").integer("onboard_control_sensors_enabled") & bit


def test_streams_are_asked_for_in_groups() -> None:
    """REQUEST_DATA_STREAM of ArduPilot's stations stops and starts the messages of a group."""
    s = loaded(Flavour.ARDUPILOT)
    s.say(from_ground("REQUEST_DATA_STREAM", req_stream_id=0, req_message_rate=4, start_stop=0))
    s.heard.clear()
    s.fly(3.0)
    assert s.named("ATTITUDE") == [] == s.named("GLOBAL_POSITION_INT")
    s.say(from_ground("REQUEST_DATA_STREAM", req_stream_id=6, req_message_rate=4, start_stop=1))
    s.fly(5.0)
    assert len(s.named("GLOBAL_POSITION_INT")) == pytest.approx(20, abs=2)
    assert s.named("ATTITUDE") == []


def test_a_gimbal_looks_where_it_is_told_to() -> None:
    """At a place on the ground it is turned to the bearing and the depression that pyproj gives."""
    s = loaded(Flavour.PX4)
    s.start()
    s.fly(60.0)
    target = place_at(900.0, -700.0, HOME.altitude_m)
    x, y = round(target.lat_deg * 1e7), round(target.lon_deg * 1e7)
    gimbal = s.aircraft.gimbal
    assert gimbal is not None
    assert gimbal.handle(MissionItem(0, 0, Command.DO_SET_ROI_LOCATION, x=x, y=y, z=HOME.altitude_m), GROUND)
    s.fly(10.0)
    state = s.aircraft.state
    bearing_deg, _, distance_m = Geod(ellps="WGS84").inv(
        state.lon_deg, state.lat_deg, target.lon_deg, target.lat_deg
    )
    q = gimbal.attitude(state).fields["q"]
    assert isinstance(q, tuple)
    w, i, j, k = q
    pitch_deg = math.degrees(math.asin(2.0 * (w * j - k * i)))
    yaw_deg = math.degrees(math.atan2(2.0 * (w * k + i * j), 1.0 - 2.0 * (j * j + k * k)))
    wanted_deg = -math.degrees(math.atan2(state.altitude_m - HOME.altitude_m, distance_m))
    assert pitch_deg == pytest.approx(wanted_deg, abs=0.5)
    off_deg = (yaw_deg + math.degrees(state.heading_rad) - bearing_deg + 180.0) % 360.0 - 180.0
    assert abs(off_deg) < 1.0
