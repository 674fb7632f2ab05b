"""Clients that keep every endpoint of a service busy, in a process of their own.

``python -m benchmarks.request_flood ADDRESS CLIENTS VEHICLE OTHER``: so many connections, each sending one
request after the other, until standard input ends; then a line of JSON on standard output counts answers by
status. Half of the clients keep their connection, the others open a new one each time.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
import sys
from collections import Counter
from typing import Any
from urllib.parse import urlsplit

from app.priority import go_usual

_SIDE_DEG = 0.002
_PER_ROW = 20


def regions(count: int) -> dict[str, Any]:
    """A scenario with so many square regions."""
    features: list[dict[str, Any]] = [
        {
            "type": "Feature",
            "id": "start",
            "geometry": {"type": "Point", "coordinates": [-117.75, 33.48]},
            "properties": {"role": "start"},
        }
    ]
    for number in range(count):
        row, column = divmod(number, _PER_ROW)
        west, south = -117.74 + 2 * _SIDE_DEG * column, 33.49 + 2 * _SIDE_DEG * row
        east, north = west + _SIDE_DEG, south + _SIDE_DEG
        ring = [[west, south], [east, south], [east, north], [west, north], [west, south]]
        features.append(
            {
                "type": "Feature",
                "id": f"R{number}",
                "geometry": {"type": "Polygon", "coordinates": [ring]},
                "properties": {"role": "roi"},
            }
        )
    aircraft = {"name": "uav", "type": "fixed_wing", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0}
    sensor = {"name": "sar", "type": "sar", "incidence_deg": 45.0, "elevation_beamwidth_deg": 20.0}
    return {
        "type": "FeatureCollection",
        "features": features,
        "vehicles": [{**aircraft, "autopilot": "ardupilot", "max_climb_deg": 8.0}],
        "sensors": [{**sensor, "azimuth_beamwidth_deg": 6.0, "wavelength_m": 0.03, "resolution_m": 0.5}],
        "altitude_m": 500.0,
        "altitude_reference": "home",
    }


def _kml(count: int) -> bytes:
    places = "".join(
        "<Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>"
        f"{n % 90},0 {n % 90},1 {n % 90 + 1},1 {n % 90},0"
        "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark>"
        for n in range(count)
    )
    return f"<kml xmlns='http://www.opengis.net/kml/2.2'><Document>{places}</Document></kml>".encode()


def requests_of(vehicle_id: str, other_id: str) -> list[tuple[str, str, bytes]]:
    """Method, path and body of one request to each kind of endpoint; the other vehicle is worked on."""
    small, large = (json.dumps(regions(count)).encode() for count in (3, 300))
    vehicle, other = f"/api/v1/vehicles/{vehicle_id}", f"/api/v1/vehicles/{other_id}"
    gets = [
        "/api/v1/plans?limit=1000", "/api/v1/scenarios?limit=1000", "/api/v1/terrain", "/api/v1/flights",
        "/api/v1/vehicles", vehicle, f"{vehicle}/commands", f"{vehicle}/logs", f"{vehicle}/forward",
        "/health/live", "/health/ready", "/metrics", "/docs", "/openapi.json", "/",
        "/api/v1/plans/none", "/api/v1/flights/none/coverage.geojson",
    ]  # fmt: skip
    return [
        *(("GET", path, b"") for path in gets),
        ("POST", "/api/v1/scenarios/validate", large),
        ("POST", "/api/v1/plans", small),
        ("POST", "/api/v1/plans", large),
        ("POST", "/api/v1/scenarios", large),
        ("POST", "/api/v1/scenarios/import?format=kml", _kml(2000)),
        ("POST", "/api/v1/terrain", b"II*\0" + bytes(1_000_000)),
        ("POST", "/api/v1/plans", bytes(4_000_000)),
        ("POST", f"{other}/mission", b'{"plan_id": "none"}'),
        ("POST", f"{other}/preflight", b'{"plan_id": "none"}'),
        ("GET", f"{vehicle}/telemetry", b""),
    ]


class Flood:
    """The clients."""

    def __init__(self, address: str, vehicle_id: str, other_id: str) -> None:
        self._place = urlsplit(address)
        self.answers: Counter[str] = Counter()
        self._requests = itertools.cycle(requests_of(vehicle_id, other_id))

    async def client(self, *, keeps: bool) -> None:
        """Send one request after the other."""
        while True:
            try:
                reader, writer = await asyncio.open_connection(self._place.hostname, self._place.port)
                with contextlib.closing(writer):
                    while await self._ask(reader, writer, keeps=keeps) and keeps:
                        pass
            except (OSError, asyncio.IncompleteReadError) as error:
                self.answers[type(error).__name__] += 1
                await asyncio.sleep(0.05)

    async def _ask(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, keeps: bool) -> bool:
        method, path, body = next(self._requests)
        head = f"{method} {path} HTTP/1.1\r\nHost: {self._place.netloc}\r\nContent-Length: {len(body)}\r\n"
        head += "Content-Type: application/json\r\n" + ("" if keeps else "Connection: close\r\n") + "\r\n"
        writer.write(head.encode() + body)
        await writer.drain()
        answer = (await reader.readuntil(b"\r\n\r\n")).lower()
        self.answers[answer.split(b" ", 2)[1].decode()] += 1
        if path.endswith("/telemetry"):
            for _ in range(5):
                await reader.readline()
            return False
        _, said, rest = answer.partition(b"content-length: ")
        if not said:
            await reader.read()
            return False
        await reader.readexactly(int(rest.partition(b"\r\n")[0]))
        return b"connection: close" not in answer


async def _run(address: str, clients: int, vehicle_id: str, other_id: str) -> None:
    flood = Flood(address, vehicle_id, other_id)
    tasks = [asyncio.create_task(flood.client(keeps=number % 2 == 0)) for number in range(clients)]
    await asyncio.to_thread(sys.stdin.read)
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    sys.stdout.write(json.dumps(flood.answers) + "\n")


if __name__ == "__main__":
    go_usual()
    asyncio.run(_run(sys.argv[1], int(sys.argv[2]), *sys.argv[3:]))
