"""A stub aircraft on a link: heartbeats, the stub vehicle's mission protocol, and answers to commands."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from typing import Self

from mavlink.errors import LinkError
from mavlink.links.link import Link, LinkFaults, MemoryLink, memory_pair
from mavlink.links.memory import NO_FAULTS
from mavlink.station.client import VehicleClient
from mavlink.transfer.machine import TransferSettings
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message, Value
from tests.mavlink.transfer.vehicle import StubVehicle
from tests.virtual_time import loop_time_s

# A tenth of the protocol's patience, so that tests of time-outs are short.
HASTY = TransferSettings(timeout_s=0.15, item_timeout_s=0.025, silence_s=0.8, acknowledgement_s=0.4)
LOST_AFTER_S = 0.6


class Aircraft:
    """What flies at the other end.

    Attributes
    ----------
    commands
        COMMAND_LONG as received: number and seven parameters.
    results
        What a command draws; ACCEPTED where nothing is said, no answer for None.
    heard
        Every message received.
    """

    def __init__(
        self, link: Link, vehicle: StubVehicle, autopilot: int = 3, kind: int = 1, system_id: int = 1
    ) -> None:
        self.link = link
        self.vehicle = vehicle
        self.autopilot = autopilot
        self.kind = kind
        self.commands: list[tuple[int, tuple[float, ...]]] = []
        self.results: dict[int, int | None] = {}
        self.heard: list[Message] = []
        self.vanish_at_item: int | None = None
        self.armed = True
        self._codec = Codec(system_id, 1)
        self._tasks: list[asyncio.Task[None]] = []

    async def __aenter__(self) -> Self:
        self._tasks = [asyncio.create_task(self._read()), asyncio.create_task(self._beat())]
        return self

    async def __aexit__(self, *_: object) -> None:
        for task in self._tasks:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await task
        await self.link.close()

    async def say(self, name: str, /, **fields: Value) -> None:
        """Send a message."""
        with contextlib.suppress(LinkError):
            await self.link.send(self._codec.pack(Message(name, fields)))

    async def _beat(self) -> None:
        mode = 3 if (self.autopilot, self.kind) == (3, 2) else 10  # AUTO of ArduCopter, else of ArduPlane
        while True:
            armed = 0x80 if self.armed else 0
            await self.say(
                "HEARTBEAT", autopilot=self.autopilot, type=self.kind, custom_mode=mode, base_mode=armed
            )
            for answer in self.vehicle.tick(loop_time_s()):
                await self.say(answer.name, **dict(answer.fields))
            await asyncio.sleep(0.1)

    async def _read(self) -> None:
        while True:
            for message in self._codec.feed(await self.link.receive()):
                self.heard.append(message)
                await self._answer(message)

    async def _answer(self, message: Message) -> None:
        if message.name == "COMMAND_LONG":
            number = message.integer("command")
            parameters = tuple(message.number(f"param{index}") for index in range(1, 8))
            self.commands.append((number, parameters))
            result = self.results.get(number, 0)
            if result is not None:
                await self.say("COMMAND_ACK", command=number, result=result, target_system=message.system_id)
            return
        if message.name == "MISSION_SET_CURRENT":
            await self.say("MISSION_CURRENT", seq=message.integer("seq"))
            return
        if message.name == "MISSION_ITEM_INT" and message.integer("seq") == self.vanish_at_item:
            self.vanish()
        for answer in self.vehicle.receive(message, asyncio.get_running_loop().time()):
            await self.say(answer.name, **{**answer.fields, "target_system": message.system_id})

    def vanish(self) -> None:
        """Fly out of range: still hears, is no longer heard."""
        assert isinstance(self.link, MemoryLink)
        self.link.connected = False

    def come_back(self) -> None:
        """Be heard again."""
        assert isinstance(self.link, MemoryLink)
        self.vanish_at_item = None
        self.link.connected = True


@contextlib.asynccontextmanager
async def flying(
    manner: str = "ardupilot",
    kind: int = 1,
    faults: LinkFaults = NO_FAULTS,
    seed: int = 0,
    settings: TransferSettings = HASTY,
    lost_after_s: float = 5.0,
    tap: Callable[[bytes], None] | None = None,
) -> AsyncIterator[tuple[VehicleClient, Aircraft]]:
    """A client and an aircraft joined in memory, connected."""
    ground, air = memory_pair(faults, seed)
    autopilot = {"ardupilot": 3, "px4": 12, "generic": 0}[manner]
    stub = StubVehicle("px4" if manner == "px4" else "ardupilot")
    client = VehicleClient(ground, settings=settings, lost_after_s=lost_after_s, tap=tap, clock=loop_time_s)
    async with Aircraft(air, stub, autopilot, kind) as aircraft, client:
        await client.connect(5)
        yield client, aircraft
