"""MAVSDK decodes a PX4's events behind a forward: the metadata it needs comes through it, both ways."""

from __future__ import annotations

import asyncio
import contextlib
import json
import struct
import zlib

import pytest
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.links.link import memory_pair
from mavlink.state.events import event_id
from mavlink.station.client import VehicleClient
from mavlink.station.forward.address import parse_forward
from mavlink.station.forward.hub import Forwards
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import Aircraft
from tests.mavlink.transfer.vehicle import StubVehicle

pytest.importorskip("mavsdk")
from mavsdk.asyncio.plugins.events import EventsAsync

from tests.mavlink.station.forward.test_mavsdk import second_station
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.mavsdk

PX4 = 12
REQUEST_MESSAGE = 512
COMPONENT_METADATA, METADATA_CRC_EXTRA = 397, 182
EVENTS = 4  # COMP_METADATA_TYPE_EVENTS
NAME = "navigator_mis_unsup_cmd"
#: One event as PX4's own metadata has it.
FILES = {
    "events.json": {
        "version": 2,
        "components": {
            "1": {
                "namespace": "px4",
                "event_groups": {
                    "default": {
                        "events": {
                            str(event_id(NAME) & 0xFFFFFF): {
                                "name": NAME,
                                "message": "Mission rejected: item {1}: unsupported command: {2}",
                                "arguments": [
                                    {"name": "index", "type": "uint16_t"},
                                    {"name": "cmd", "type": "uint16_t"},
                                ],
                            }
                        }
                    }
                },
            }
        },
    },
}
CONTENT = {name: json.dumps(content).encode() for name, content in FILES.items()}


def file_crc(content: bytes) -> int:
    """CRC32 as MAVFTP counts it: begun with 0, not inverted."""
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


CONTENT["general.json"] = json.dumps(
    {
        "version": 1,
        "metadataTypes": [
            {"type": EVENTS, "uri": "mftp:///events.json", "fileCrc": file_crc(CONTENT["events.json"])}
        ],
    }
).encode()


class Px4WithFiles(Aircraft):
    """A stub of a PX4 that has files about itself and hands them out."""

    async def _answer(self, message: Message) -> None:
        if message.name == "FILE_TRANSFER_PROTOCOL":
            await self._serve(message)
            return
        wanted = message.name == "COMMAND_LONG" and message.integer("command") == REQUEST_MESSAGE
        if wanted and message.number("param1") == COMPONENT_METADATA:
            await self.say("COMMAND_ACK", command=REQUEST_MESSAGE, target_system=message.system_id)
            await self.link.send(self._metadata())
            return
        await super()._answer(message)

    def _metadata(self) -> bytes:
        """COMPONENT_METADATA, which the dialects here lack."""
        content = CONTENT["general.json"]
        payload = struct.pack("<II100s", 1000, file_crc(content), b"mftp:///general.json").rstrip(b"\0")
        header = struct.pack("<BBBBBBHB", len(payload), 0, 0, 7, 1, 1, COMPONENT_METADATA, 0)
        crc = dialect.x25crc(header + payload + bytes([METADATA_CRC_EXTRA])).crc
        return b"\xfd" + header + payload + struct.pack("<H", crc)

    async def _serve(self, message: Message) -> None:
        """MAVFTP, as far as reading goes. Source: https://mavlink.io/en/services/ftp.html."""
        values = message.fields["payload"]
        assert isinstance(values, tuple)
        request = bytes(int(value) for value in values)
        sequence, session, opcode, size, _, _, offset = struct.unpack_from("<HBBBBBxI", request)
        ack, nak, end_of_file = 128, 129, 6
        reply, data, burst_over, kind = ack, b"", 0, opcode
        match opcode:
            case 4:  # OpenFileRO
                name = request[12 : 12 + size].rstrip(b"\0").decode().lstrip("/")
                if name in CONTENT:
                    self.reading = CONTENT[name]
                    data = struct.pack("<I", len(self.reading))
                else:
                    reply, data = nak, b"\x0a"
            case 5 | 15:  # ReadFile, BurstReadFile
                data = self.reading[offset : offset + min(size or 239, 239)]
                burst_over = 1
                if not data:
                    reply, data = nak, bytes([end_of_file])
            case 14:  # CalcFileCRC32
                name = request[12 : 12 + size].rstrip(b"\0").decode().lstrip("/")
                data = struct.pack("<I", file_crc(CONTENT[name]))
        head = struct.pack(
            "<HBBBBBxI", (sequence + 1) & 0xFFFF, session, reply, len(data), kind, burst_over, offset
        )
        payload = tuple((head + data).ljust(251, b"\0"))
        await self.say(
            "FILE_TRANSFER_PROTOCOL",
            target_system=message.system_id,
            target_component=message.component_id,
            payload=payload,
        )

    reading = b""


async def test_mavsdk_and_our_reader_tell_the_same_event() -> None:
    """Its words come from the file it has fetched from the vehicle; ours need none."""
    ground, air = memory_pair()
    forwards = Forwards()
    await forwards.set([parse_forward("udpin:0", write=True)])
    (outlet,) = forwards.outlets
    async with (
        Px4WithFiles(air, StubVehicle("px4"), PX4) as aircraft,
        VehicleClient(ground, forwards=forwards) as client,
        contextlib.AsyncExitStack() as stack,
    ):
        stack.push_async_callback(forwards.close)
        await client.connect(30)
        system = await stack.enter_async_context(second_station(outlet))
        events = EventsAsync(system)
        told: asyncio.Queue[str] = asyncio.Queue()

        async def listen() -> None:
            async for event in events.subscribe_events():
                told.put_nowait(event.message)

        listening = asyncio.create_task(listen())
        arguments = struct.pack("<HH", 7, 18).ljust(40, b"\0")
        fields = {"id": event_id(NAME), "log_levels": 0x33, "arguments": tuple(arguments)}
        await aircraft.say("EVENT", sequence=1, event_time_boot_ms=1000, **fields)
        # MAVSDK keeps it until it has the metadata.
        words = await asyncio.wait_for(told.get(), PATIENCE_S)
        assert words == "Mission rejected: item 7: unsupported command: 18"
        texts = [text.text for text in client.state.texts]
        assert "mission rejected: item 7 has the unsupported command 18" in texts
        listening.cancel()
        await asyncio.gather(listening, return_exceptions=True)
