"""Heights of the ground for vehicles that ask: the ground station's side of the terrain protocol.

Source: MAVLink ``common.xml`` (TERRAIN_REQUEST, TERRAIN_DATA); ArduPilot ``AP_Terrain`` and
``Location::offset_latlng`` for where the posts of a grid lie.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass
from typing import Final

from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message

#: Heights over mean sea level at WGS 84 places (longitude, latitude); None where the ground is not known.
Heights = Callable[[Sequence[tuple[float, float]]], Awaitable[Sequence[float | None]]]

#: A request is for up to 7 × 8 blocks, northwards and eastwards, of 4 × 4 posts.
BLOCKS_EAST, BLOCKS, POSTS = 8, 56, 4
#: So many blocks at a time: a slow link has other things to carry, and what is missing is asked for again.
MOST_BLOCKS: Final = 16
_METRES_A_UNIT = 0.011131884502145034
_LOWEST_M, _HIGHEST_M = -32_767, 32_767


@dataclass(frozen=True, slots=True)
class Wanted:
    """One TERRAIN_REQUEST.

    Parameters
    ----------
    lat, lon
        South-west corner in degrees × 1e7.
    spacing_m
        Between posts.
    blocks
        Numbers of the blocks wanted.
    """

    lat: int
    lon: int
    spacing_m: int
    blocks: tuple[int, ...]

    @classmethod
    def of(cls, message: Message) -> Wanted:
        """Read the message."""
        mask = message.integer("mask")
        return cls(
            message.integer("lat"),
            message.integer("lon"),
            message.integer("grid_spacing"),
            tuple(number for number in range(BLOCKS) if mask >> number & 1),
        )

    def places_deg(self, block: int) -> list[tuple[float, float]]:
        """Longitude and latitude of a block's posts in the order of TERRAIN_DATA, as ArduPilot counts."""
        north, east = divmod(block, BLOCKS_EAST)
        return [
            self._place_deg(POSTS * north + x, POSTS * east + y) for x in range(POSTS) for y in range(POSTS)
        ]

    def _place_deg(self, north: int, east: int) -> tuple[float, float]:
        up = north * self.spacing_m / _METRES_A_UNIT
        narrowing = max(math.cos(math.radians((self.lat + up / 2.0) * 1e-7)), 0.01)
        right = east * self.spacing_m / _METRES_A_UNIT / narrowing
        lon_deg = (self.lon + right) * 1e-7
        return (lon_deg + 180.0) % 360.0 - 180.0, (self.lat + up) * 1e-7

    def answer(self, block: int, heights_m: Sequence[float | None]) -> Message | None:
        """TERRAIN_DATA of a block; None where one of its posts is not known."""
        rounded = [None if height is None else round(height) for height in heights_m]
        if any(height is None or not _LOWEST_M <= height <= _HIGHEST_M for height in rounded):
            return None
        fields = {"lat": self.lat, "lon": self.lon, "grid_spacing": self.spacing_m, "gridbit": block}
        return Message("TERRAIN_DATA", {**fields, "data": tuple(height or 0 for height in rounded)})


class TerrainServer:
    """Answers one vehicle's requests, one after the other; the newest counts where several wait.

    Parameters
    ----------
    heights
        Where they come from. What it raises ends the answer to that request: the vehicle asks again.
    say
        Sends messages to the vehicle.
    """

    def __init__(self, heights: Heights, say: Callable[[list[Message]], None]) -> None:
        self._heights = heights
        self._say = say
        self._waiting: Wanted | None = None
        self._task: asyncio.Task[None] | None = None

    def take(self, message: Message, state: VehicleState) -> None:
        """Take any message of the vehicle; requests for terrain are answered."""
        if message.name != "TERRAIN_REQUEST":
            return
        wanted = Wanted.of(message)
        if wanted.spacing_m < 1 or not wanted.blocks:
            return
        self._waiting = wanted
        if self._task is None or self._task.done():
            self._task = asyncio.create_task(self._serve())

    def close(self) -> None:
        """Answer no more."""
        if self._task is not None:
            self._task.cancel()

    async def _serve(self) -> None:
        while self._waiting is not None:
            wanted, self._waiting = self._waiting, None
            blocks = wanted.blocks[:MOST_BLOCKS]
            places = [place for block in blocks for place in wanted.places_deg(block)]
            heights_m = await self._heights(places)
            size = POSTS * POSTS
            answers = [
                wanted.answer(block, heights_m[size * k : size * (k + 1)]) for k, block in enumerate(blocks)
            ]
            self._say([answer for answer in answers if answer is not None])
