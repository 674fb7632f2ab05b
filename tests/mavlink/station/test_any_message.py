"""Any message of the dialect, with any bytes in it, from the very vehicle: nothing falls over."""

from __future__ import annotations

import math
import struct
from dataclasses import fields

from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import TrackRecorder
from mavlink.transfer.clear import ClearMachine, SetCurrentMachine
from mavlink.transfer.command import CommandMachine
from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.machine import Machine
from mavlink.transfer.outcome import Outcome
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message
from tests.mavlink.transfer.vehicle import waypoints

# Those that anything here looks at come up more often than the rest.
KNOWN = [
    *(
        "HEARTBEAT",
        "GLOBAL_POSITION_INT",
        "ATTITUDE",
        "VFR_HUD",
        "SYS_STATUS",
        "BATTERY_STATUS",
        "GPS_RAW_INT",
    ),
    *("HOME_POSITION", "MISSION_CURRENT", "MISSION_ITEM_REACHED", "EXTENDED_SYS_STATE", "NAMED_VALUE_INT"),
    *(
        "RELAY_STATUS",
        "STATUSTEXT",
        "CAMERA_FEEDBACK",
        "CAMERA_IMAGE_CAPTURED",
        "MISSION_REQUEST",
        "MISSION_ACK",
    ),
    *("MISSION_REQUEST_INT", "MISSION_COUNT", "MISSION_ITEM", "MISSION_ITEM_INT", "COMMAND_ACK"),
]
IDS = {definition.msgname: number for number, definition in dialect.mavlink_map.items()}


@st.composite
def messages(draw: st.DrawFn) -> Message:
    """A message whose payload is arbitrary bytes."""
    name = draw(st.one_of(st.sampled_from(KNOWN), st.sampled_from(sorted(IDS))))
    definition = dialect.mavlink_map[IDS[name]]
    size = definition.unpacker.size
    not_a_number = (b"\x00\x00\xc0\x7f" * size)[:size]
    payload = draw(st.one_of(st.binary(min_size=size, max_size=size), st.just(not_a_number)))
    head = struct.pack("<BBBBBBHB", size, 0, 0, 0, 1, 1, IDS[name] & 0xFFFF, IDS[name] >> 16)
    crc = dialect.x25crc(head + payload + bytes([definition.crc_extra])).crc
    (message,) = Codec().feed(b"\xfd" + head + payload + struct.pack("<H", crc))
    return message


@settings(max_examples=300, deadline=None)
@given(st.lists(messages(), min_size=1, max_size=12))
def test_no_message_raises_and_no_state_holds_a_non_number(heard: list[Message]) -> None:
    """State, track and every machine take them all; what the state holds can be written as JSON."""
    state, recorder = VehicleState(), TrackRecorder()
    machines: list[Machine[Outcome] | CommandMachine] = [
        UploadMachine(waypoints(3), MissionType.MISSION, 1, 1),
        DownloadMachine(MissionType.MISSION, 1, 1),
        ClearMachine(MissionType.FENCE, 1, 1),
        SetCurrentMachine(2, 1, 1),
        CommandMachine(400, (1.0,), 1, 1),
    ]
    sender = Codec()
    for machine in machines:
        machine.start(0.0)
    for second, message in enumerate(heard):
        state = updated(state, message, float(second))
        recorder.take(message, state)
        for machine in machines:
            for answer in machine.receive(message, float(second)):
                sender.pack(answer)
    track = recorder.track()
    for value in (state, *track.points, *track.events):
        numbers = [getattr(value, entry.name) for entry in fields(value)]
        assert all(math.isfinite(number) for number in numbers if isinstance(number, float))
