"""Vehicles that ask get the ground's heights, at the places that ArduPilot means."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect
from pyproj import Geod

from mavlink.state.telemetry import VehicleState
from mavlink.station.terrain import BLOCKS, MOST_BLOCKS, POSTS, TerrainServer, Wanted
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message

pytestmark = pytest.mark.virtual_time

GEOD = Geod(ellps="WGS84")


def request(lat_deg: float, lon_deg: float, spacing_m: int, mask: int) -> Message:
    """As a vehicle sends it, through pymavlink."""
    peer = dialect.MAVLink(None, srcSystem=1, srcComponent=1)
    sent = peer.terrain_request_encode(round(lat_deg * 1e7), round(lon_deg * 1e7), spacing_m, mask)
    (message,) = Codec().feed(sent.pack(peer))
    return message


@given(
    lat_deg=st.floats(-80.0, 80.0),
    lon_deg=st.floats(-180.0, 180.0),
    spacing_m=st.integers(1, 200),
    block=st.integers(0, BLOCKS - 1),
)
def test_posts_lie_where_pyproj_puts_them(lat_deg: float, lon_deg: float, spacing_m: int, block: int) -> None:
    """Rows northwards of the south-west corner, posts eastwards in a row, to half a spacing."""
    places = Wanted.of(request(lat_deg, lon_deg, spacing_m, 1 << block)).places_deg(block)
    for number, (lon, lat) in enumerate(places):
        north_m = (POSTS * (block // 8) + number // POSTS) * spacing_m
        east_m = (POSTS * (block % 8) + number % POSTS) * spacing_m
        azimuth, _, off_m = GEOD.inv(lon_deg, lat_deg, lon, lat)
        # ArduPilot's metres are a sphere's: up to 0.7 % off over the 6 km of a grid.
        near_m = 0.01 * math.hypot(north_m, east_m) + 0.02
        assert off_m * math.cos(math.radians(azimuth)) == pytest.approx(north_m, abs=near_m)
        assert off_m * math.sin(math.radians(azimuth)) == pytest.approx(east_m, abs=near_m)


async def test_what_is_known_is_sent_and_the_rest_is_not() -> None:
    """Every block with all posts known, by pymavlink's reading; few at a time; none made up."""
    said: list[Message] = []

    async def heights(places: Sequence[tuple[float, float]]) -> Sequence[float | None]:
        return [None if lat > 47.004 else 400.0 + 1000.0 * (lat - 47.0) for _, lat in places]

    server = TerrainServer(heights, said.extend)
    server.take(request(47.0, 8.0, 30, (1 << BLOCKS) - 1), VehicleState())
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert len(said) == MOST_BLOCKS
    peer = dialect.MAVLink(None)
    for message in said:
        read = peer.parse_buffer(Codec().pack(message))[0]
        assert (read.lat, read.lon, read.grid_spacing) == (470000000, 80000000, 30)
        north = POSTS * (read.gridbit // 8)
        for number, height_m in enumerate(read.data):
            lat_deg = 47.0 + (north + number // POSTS) * 30 * 360.0 / 40_075_017.0
            assert height_m == pytest.approx(400.0 + 1000.0 * (lat_deg - 47.0), abs=1.0)
    said.clear()
    server.take(request(47.1, 8.0, 30, 0b11), VehicleState())
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert said == []
