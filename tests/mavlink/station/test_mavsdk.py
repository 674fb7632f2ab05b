"""MAVSDK's autopilot side as an independent peer: what it received, item by item."""

from __future__ import annotations

import math

import pytest

from benchmarks.link import fields, mission, run, vehicle
from mavlink.links.udp import open_udp
from mavlink.station.client import VehicleClient
from mavlink.transfer.outcome import Accepted
from mavlink.wire.items import Command, MissionItem, MissionType

pytestmark = pytest.mark.mavsdk


@pytest.mark.parametrize("count", [1, 50, 1000])
async def test_mavsdk_receives_every_item_and_gives_it_back(count: int) -> None:
    """Uploaded over loopback, MAVSDK's server reports each item as meant, and its download is the same."""
    items = mission(count)
    link = await open_udp("127.0.0.1", 0, listen=True)
    async with VehicleClient(link) as client, vehicle(link.local_port) as missions:
        await client.connect(10)
        assert await client.upload(items, MissionType.MISSION) == Accepted()
        assert await missions.get() == tuple(fields(item) for item in items)
        result = await client.upload_verified(items, MissionType.MISSION, lambda *_: ())
        assert result.held == items
        assert await client.clear(MissionType.MISSION) == Accepted()


async def test_mavsdk_receives_extremes() -> None:
    """NaN, negative and largest numbers, odd frames and commands cross unharmed."""
    items = (
        MissionItem(0, 2, Command.DO_SET_RELAY, 1.0, 0.0, current=True),
        MissionItem(1, 6, 16, 0.0, 0.0, 0.0, math.nan, 2**31 - 1, -(2**31), -430.5),
        MissionItem(
            2, 11, 31010, 1e30, -1e-30, 0.5, 0.25, -900_000_000, 1_799_999_999, 8848.0, autocontinue=False
        ),
    )
    link = await open_udp("127.0.0.1", 0, listen=True)
    async with VehicleClient(link) as client, vehicle(link.local_port) as missions:
        await client.connect(10)
        assert await client.upload(items, MissionType.MISSION) == Accepted()
        received = await missions.get()
    for item, got in zip(items, received, strict=True):
        assert got == pytest.approx(fields(item), rel=1e-6, abs=0.0, nan_ok=True)


def test_the_benchmark_compares_like_with_like() -> None:
    """Both clients deliver the same mission, and the last line relates their medians."""
    *uploads, summary = run(items=20, repetitions=1)
    assert [line["client"] for line in uploads] == ["swathplan", "mavsdk"]
    assert all(line["received_equal"] for line in uploads)
    assert summary["items"] == 20
