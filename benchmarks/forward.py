"""What forwarding costs the link: an upload over loopback with no, one and eight forwards, one of them stuck.

The vehicle is MAVSDK's autopilot side, as in ``benchmarks.link``. Run as ``python -m benchmarks.forward``;
prints JSON lines.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import statistics
import time

from mavsdk import logging as mavsdk_logging

from benchmarks.link import fields, mission, vehicle
from mavlink.links.udp import open_udp
from mavlink.station.client import VehicleClient
from mavlink.station.forward.address import parse_forward
from mavlink.station.forward.hub import Forwards
from mavlink.wire.items import MissionType

ITEMS = 1000
REPETITIONS = 5


async def upload(stations: int, stuck: int) -> tuple[float, int]:
    """Seconds an upload takes, and frames sent to stations.

    Parameters
    ----------
    stations
        Datagram sockets that take everything.
    stuck
        TCP peers that are connected and never read.
    """
    items = mission(ITEMS)
    forwards = Forwards()
    async with contextlib.AsyncExitStack() as stack:
        addresses = [parse_forward("tcpin:0") for _ in range(stuck)]
        for _ in range(stations):
            listener = await open_udp("127.0.0.1", 0, listen=True)
            stack.push_async_callback(listener.close)
            addresses.append(parse_forward(f"udpout:{listener.local_port}"))
        await forwards.set(addresses)
        stack.push_async_callback(forwards.close)
        for outlet in forwards.outlets[:stuck]:
            _, writer = await asyncio.open_connection("127.0.0.1", int(outlet.url.rpartition(":")[2]))
            stack.callback(writer.close)
        link = await open_udp("127.0.0.1", 0, listen=True)
        client = await stack.enter_async_context(VehicleClient(link, forwards=forwards))
        missions = await stack.enter_async_context(vehicle(link.local_port))
        await client.connect(10.0)
        begin_s = time.perf_counter()
        outcome = await client.upload(items, MissionType.MISSION)
        seconds = time.perf_counter() - begin_s
        received = await asyncio.wait_for(missions.get(), 10.0)
        if outcome.kind != "accepted" or received != tuple(fields(item) for item in items):
            raise RuntimeError(f"the upload ended as {outcome}")
        return seconds, sum(outlet.figures.sent for outlet in forwards.outlets)


def main() -> None:
    """Print a line for each number of forwards."""
    mavsdk_logging.log_subscribe(lambda *_: True)
    for stations, stuck in ((0, 0), (1, 0), (7, 1)):
        runs = [asyncio.run(upload(stations, stuck)) for _ in range(REPETITIONS)]
        line = {
            "benchmark": "forward",
            "items": ITEMS,
            "stations": stations,
            "stuck": stuck,
            "median_s": round(statistics.median(seconds for seconds, _ in runs), 4),
            "frames_sent": max(sent for _, sent in runs),
        }
        print(json.dumps(line), flush=True)


if __name__ == "__main__":
    main()
