"""Upload of a long mission over loopback: this project's client beside MAVSDK's own, in one run.

The vehicle is MAVSDK's autopilot side (``mission_raw_server``), a fresh one for every repetition; the two
clients take turns. Run as ``python -m benchmarks.link``; prints JSON lines.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import statistics
import time
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from dataclasses import dataclass

from mavsdk import logging as mavsdk_logging
from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
from mavsdk.asyncio.plugins.mission_raw import MissionItem as PeerItem
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.mission_raw_server import MissionRawServerAsync

from mavlink.links.udp import open_udp
from mavlink.station.client import VehicleClient
from mavlink.wire.items import Command, Frame, MissionItem, MissionType

#: Items of short missions and of long ones; the last is longer than any autopilot holds.
SIZES = (1, 10, 100, 1000, 10_000)
REPETITIONS = 5
#: Either client asks a vehicle that it has met for its version and its telemetry: that is over when this is.
ACQUAINTED_S = 0.5


@dataclass(frozen=True, slots=True)
class Received:
    """One upload: how long the client took, and the item fields the vehicle got."""

    seconds: float
    items: tuple[tuple[float, ...], ...]


def mission(count: int) -> tuple[MissionItem, ...]:
    """A mission of waypoints; every number fits a 32-bit float, so it arrives bit for bit."""
    return tuple(
        MissionItem(
            seq=seq,
            frame=Frame.GLOBAL_RELATIVE_ALT_INT,
            command=Command.NAV_WAYPOINT,
            param1=seq % 7 / 2,
            param2=30.0,
            x=473_977_000 + 900 * seq,
            y=85_456_000 - 700 * seq,
            z=100.0 + seq / 8,
            current=seq == 0,
        )
        for seq in range(count)
    )


def fields(item: MissionItem | PeerItem) -> tuple[float, ...]:
    """What must arrive, in one order for both libraries."""
    parameters = (item.param1, item.param2, item.param3, item.param4)
    return (item.seq, item.frame, item.command, int(item.current), *parameters, item.x, item.y, item.z)


@contextlib.asynccontextmanager
async def vehicle(port: int) -> AsyncIterator[asyncio.Queue[tuple[tuple[float, ...], ...]]]:
    """MAVSDK's autopilot side, calling a local port; yields the missions it receives."""
    peer = Mavsdk(Configuration.create_with_component_type(ComponentType.AUTOPILOT))
    missions: asyncio.Queue[tuple[tuple[float, ...], ...]] = asyncio.Queue()
    try:
        await peer.add_any_connection(f"udpout://127.0.0.1:{port}")
        server = MissionRawServerAsync(await peer.server_component_by_type(ComponentType.AUTOPILOT))

        async def listen() -> None:
            async for _, plan in server.subscribe_incoming_mission():
                missions.put_nowait(tuple(fields(item) for item in plan.mission_items))

        listener = asyncio.create_task(listen())
        try:
            yield missions
        finally:
            listener.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await listener
    finally:
        peer.destroy()


async def ours(items: tuple[MissionItem, ...]) -> Received:
    """Upload with this project's client."""
    link = await open_udp("127.0.0.1", 0, listen=True)
    async with VehicleClient(link) as client, vehicle(link.local_port) as missions:
        await client.connect(10.0)
        await asyncio.sleep(ACQUAINTED_S)
        begin_s = time.perf_counter()
        outcome = await client.upload(items, MissionType.MISSION)
        seconds = time.perf_counter() - begin_s
        if outcome.kind != "accepted":
            raise RuntimeError(f"our upload ended as {outcome}")
        return Received(seconds, await asyncio.wait_for(missions.get(), 10.0))


async def theirs(items: tuple[MissionItem, ...]) -> Received:
    """Upload with MAVSDK's client."""
    probe = await open_udp("127.0.0.1", 0, listen=True)
    port = probe.local_port
    await probe.close()
    client = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    try:
        await client.add_any_connection(f"udpin://127.0.0.1:{port}")
        async with vehicle(port) as missions:
            system = await client.first_autopilot(10.0)
            if system is None:
                raise RuntimeError("MAVSDK's client found no autopilot")
            raw = MissionRawAsync(system)
            peer_items = [
                PeerItem(
                    *(item.seq, item.frame, item.command, int(item.current), int(item.autocontinue)),
                    *(item.param1, item.param2, item.param3, item.param4),
                    *(item.x, item.y, item.z, int(item.mission_type)),
                )
                for item in items
            ]
            await asyncio.sleep(ACQUAINTED_S)
            begin_s = time.perf_counter()
            await raw.upload_mission(peer_items)
            seconds = time.perf_counter() - begin_s
            return Received(seconds, await asyncio.wait_for(missions.get(), 10.0))
    finally:
        client.destroy()


def run(items: int | None = None, repetitions: int = REPETITIONS) -> Iterator[dict[str, object]]:
    """Uploads of one size, or of each of ``SIZES``."""
    mavsdk_logging.log_subscribe(lambda *_: True)
    for size in SIZES if items is None else (items,):
        yield from compare(size, repetitions)


def compare(items: int, repetitions: int) -> Iterator[dict[str, object]]:
    """One line for each client and repetition, then the comparison of the medians."""
    meant = mission(items)
    expected = tuple(fields(item) for item in meant)
    clients: dict[str, Callable[[tuple[MissionItem, ...]], Awaitable[Received]]] = {
        "swathplan": ours,
        "mavsdk": theirs,
    }
    times: dict[str, list[float]] = {name: [] for name in clients}
    for repetition in range(repetitions):
        for name, upload in clients.items():

            async def once(upload: Callable[..., Awaitable[Received]] = upload) -> Received:
                return await upload(meant)

            received = asyncio.run(once())
            times[name].append(received.seconds)
            yield {
                "benchmark": "upload",
                "client": name,
                "repetition": repetition,
                "items": items,
                "seconds": round(received.seconds, 4),
                "received_equal": received.items == expected,
            }
    medians = {name: statistics.median(seconds) for name, seconds in times.items()}
    yield {
        "benchmark": "upload",
        "items": items,
        "median_s": {name: round(seconds, 4) for name, seconds in medians.items()},
        "ratio": round(medians["swathplan"] / medians["mavsdk"], 3),
        "target_ratio": 1.1,
    }


def main() -> None:
    """Print the lines as they come."""
    for line in run():
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
