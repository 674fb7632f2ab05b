"""MAVProxy as an independent reader: the lists we upload, and the files we write, are the same to it.

The program itself runs, without a terminal: orders go to its standard input, and what it prints is read.
It is installed without its own needs (maps, video): requirements-peers.lock.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import re
import sys
from collections.abc import AsyncIterator
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import pytest

from mavlink.dialects import dialect_for
from mavlink.dialects.compare import differences
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.formats import write_waypoints
from mavlink.links.link import open_link
from mavlink.links.udp import open_udp
from mavlink.sim.geodesy import Place
from mavlink.sim.run import serve_link
from mavlink.sim.settings import SimSettings
from mavlink.station.client import VehicleClient
from mavlink.wire.items import MissionItem, MissionType
from tests.mavlink.plans import make_plan
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.skipif(find_spec("MAVProxy") is None, reason="MAVProxy is not installed")

PLANE = dialect_for("ardupilot", "fixed_wing")
#: ``wp list``: command, frame, latitude, longitude, altitude, p1 to p4 (one decimal), current, autocontinue.
ROW = re.compile(
    r"^(\d+) (\d+) (-?[\d.]+) (-?[\d.]+) (-?[\d.]+)"
    r" p1=(-?[\d.]+) p2=(-?[\d.]+) p3=(-?[\d.]+) p4=(-?[\d.]+) cur=\d auto=1$"
)


class MavProxy:
    """The program, by its standard input and output."""

    def __init__(self, process: asyncio.subprocess.Process) -> None:
        self._process = process

    async def until(self, pattern: str) -> list[str]:
        """The lines up to the one that matches."""
        assert self._process.stdout is not None
        lines: list[str] = []
        async with asyncio.timeout(PATIENCE_S):
            while not lines or not re.search(pattern, lines[-1]):
                line = await self._process.stdout.readline()
                assert line, f"MAVProxy has ended: {lines}"
                lines.append(line.decode().rstrip())
        return lines

    async def order(self, command: str, pattern: str) -> list[str]:
        """Give an order; the lines up to the one that ends it."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{command}\n".encode())
        await self._process.stdin.drain()
        return await self.until(pattern)


@contextlib.asynccontextmanager
async def mavproxy(port: int, home: Path) -> AsyncIterator[MavProxy]:
    """MAVProxy, connected to the vehicle at a port of this machine."""
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        str(Path(sys.executable).with_name("mavproxy.py")),
        f"--master=udpout:127.0.0.1:{port}",
        f"--state-basedir={home}",
        "--default-modules=wp,fence,rally",
        "--streamrate=-1",
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        stderr=asyncio.subprocess.STDOUT,
        env={**os.environ, "HOME": str(home), "PYTHONWARNINGS": "ignore", "PYTHONUNBUFFERED": "1"},
        cwd=home,
    )
    proxy = MavProxy(process)
    try:
        await proxy.until("online system 1")
        yield proxy
    finally:
        # Asked to end, it waits for its standard input.
        process.kill()
        await process.wait()


@contextlib.asynccontextmanager
async def simulated_plane(home: Place) -> AsyncIterator[int]:
    """A simulated ArduPlane that answers everybody on a port."""
    link = await open_udp("127.0.0.1", 0, listen=True)
    stop = asyncio.Event()
    flight = asyncio.create_task(serve_link(link, SimSettings(home=home), stop=stop))
    try:
        yield link.local_port
    finally:
        stop.set()
        await flight
        await link.close()


def assert_same(lines: list[str], items: tuple[MissionItem, ...]) -> None:
    """What MAVProxy lists is what is held: places to the last digit, parameters to the one it prints."""
    rows = [match.groups() for line in lines if (match := ROW.match(line))]
    assert len(rows) == len(items)
    for row, item in zip(rows, items, strict=True):
        assert (int(row[0]), int(row[1])) == (item.command, item.frame)
        assert (round(float(row[2]) * 1e7), round(float(row[3]) * 1e7)) == (item.x, item.y)
        assert float(row[4]) == pytest.approx(item.z, abs=1e-4)
        for printed, value in zip(row[5:], (item.param1, item.param2, item.param3, item.param4), strict=True):
            assert float(printed) == pytest.approx(value, abs=0.051)


async def test_mavproxy_agrees_item_by_item(tmp_path: Path) -> None:
    """It lists mission, fence and rally as we uploaded them, and uploads our file as we would have."""
    mission = encode(make_plan(), options=EncodeOptions(rally_at_home=True, home_altitude_m=120.0))
    file = tmp_path / "mission.waypoints"
    file.write_text(write_waypoints(mission))
    lon_deg, lat_deg = mission.home
    async with contextlib.AsyncExitStack() as stack:
        port = await stack.enter_async_context(simulated_plane(Place(lat_deg, lon_deg, 120.0)))
        link = await open_link(f"udpout:127.0.0.1:{port}")
        async with VehicleClient(link, system_id=254) as client:
            await client.connect(10)
            held = {}
            for kind in MissionType:
                items = mission.items_of(kind)
                uploaded = await client.upload_verified(
                    items, kind, lambda meant, back: differences(meant, back, PLANE)
                )
                assert (uploaded.status, bool(items)) == ("stored", True)
                assert uploaded.held is not None
                held[kind] = uploaded.held
            async with mavproxy(port, tmp_path) as proxy:
                for name, kind in zip(("wp", "fence", "rally"), MissionType, strict=True):
                    assert_same(await proxy.order(f"{name} list", r"Saved \D+ to "), held[kind])
                await client.clear(MissionType.MISSION)
                await proxy.order(f"wp load {file}", f"Sent all {len(mission.mission)} waypoints")
                await proxy.until("MISSION_ACK: TYPE_MISSION: ACCEPTED")
            theirs = await client.download(MissionType.MISSION)
            assert len(theirs) == len(held[MissionType.MISSION])
            for their, our in zip(theirs, held[MissionType.MISSION], strict=True):
                # MAVProxy cuts places to the wire's 1e-7 degrees, where we round.
                assert (abs(their.x - our.x) <= 1, abs(their.y - our.y) <= 1) == (True, True)
                assert replace(their, x=our.x, y=our.y) == our


async def test_a_standard_session(tmp_path: Path) -> None:
    """Parameters are fetched and set, modes change, it is armed, and no fence is said to be broken."""
    async with contextlib.AsyncExitStack() as stack:
        port = await stack.enter_async_context(simulated_plane(Place(47.0, 8.0, 400.0)))
        proxy = await stack.enter_async_context(mavproxy(port, tmp_path))
        # It fetches them at once.
        said = await proxy.order("module load param", r"Saved \d+ parameters")
        for module in ("mode", "arm", "misc"):
            said += await proxy.order(f"module load {module}", f"Loaded module {module}")
        # Setting says nothing when it has worked, and works while the next orders are taken.
        said += await proxy.order("param set WP_LOITER_RAD 120\nmode LOITER", "DO_SET_MODE: ACCEPTED")
        while not re.search(r"WP_LOITER_RAD +120", said[-1]):
            said += await proxy.order("param show WP_LOITER_RAD", r"WP_LOITER_RAD +\d")
        said += await proxy.order("arm throttle", "ARMED")
        said += await proxy.order("fence list", "Requesting 0 fence items")
        assert not [line for line in said if "breach" in line.lower()]
