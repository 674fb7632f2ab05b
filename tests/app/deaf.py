"""A simulated aircraft that hears of no mission until a test lets it: an upload that lasts until then."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Final

import httpx

from mavlink.links.udp import UdpLink
from mavlink.sim.settings import SimSettings
from tests.app.test_restart import flying
from tests.app.test_vehicles import connected, listening

#: The first byte of a MAVLink 2 frame, and MISSION_COUNT where such a frame names its message.
_MAGIC: Final = 0xFD
_MISSION_COUNT: Final = (44).to_bytes(3, "little")


class DeafLink:
    """A vehicle's link on which announcements of missions are lost until ``hears`` is set."""

    def __init__(self, link: UdpLink) -> None:
        self._link = link
        self.hears = False
        self.url = link.url
        self.send = link.send
        self.close = link.close

    async def receive(self) -> bytes:
        while True:
            data = await self._link.receive()
            if self.hears or data[0] != _MAGIC or data[7:10] != _MISSION_COUNT:
                return data


@asynccontextmanager
async def deaf_vehicle(client: httpx.AsyncClient) -> AsyncIterator[tuple[str, DeafLink]]:
    """The place of such a vehicle, and the link that can be let hear: within nine seconds of an upload."""
    async with listening() as (link, url):
        deaf = DeafLink(link)
        connecting = asyncio.create_task(connected(client, url))
        # It begins to speak when somebody listens, or the first heartbeat would be lost.
        while not (link.peers or connecting.done()):
            await asyncio.sleep(0.005)
        async with flying(deaf, SimSettings()):
            yield await connecting, deaf
