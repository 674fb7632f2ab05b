"""Replay: a recorded flight as a vehicle that can be watched and not commanded."""

from __future__ import annotations

import asyncio
import contextlib
from pathlib import Path

import pytest

from mavlink.errors import LinkError, NotConnectedError, ReadOnlyError
from mavlink.links.link import open_link
from mavlink.links.recording import TlogWriter, read_tlog
from mavlink.station.client import VehicleClient
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message
from tests.mavlink.station.aircraft import flying
from tests.mavlink.transfer.vehicle import waypoints
from tests.patience import PATIENCE_S
from tests.virtual_time import loop_time_s

pytestmark = pytest.mark.virtual_time


def flight(folder: Path, seconds: int = 60) -> Path:
    """A recording of an aircraft that flies north at 20 m/s, with a ground station's heartbeats between."""
    now_s = 1_790_000_000.0
    writer = TlogWriter(folder / "uav", clock=lambda: now_s)
    aircraft, ground = Codec(7, 1), Codec(255, 190)
    beat = {"type": 1, "autopilot": 3, "base_mode": 0x81, "custom_mode": 10, "system_status": 4}
    for second in range(seconds):
        writer.write(ground.pack(Message("HEARTBEAT", {"type": 6, "autopilot": 8})))
        writer.write(aircraft.pack(Message("HEARTBEAT", beat)))
        place = {"time_boot_ms": 1000 * second, "lat": 10_000_000 + 1800 * second, "relative_alt": 100_000}
        writer.write(aircraft.pack(Message("GLOBAL_POSITION_INT", place)))
        now_s += 1.0
    writer.close()
    (path,) = (folder / "uav").iterdir()
    return path


async def test_a_recording_is_watched_like_a_vehicle(tmp_path: Path) -> None:
    """State and track are those of the flight; at its end the client says so."""
    url = f"replay:{flight(tmp_path)}?speedup=200"
    async with VehicleClient(await open_link(url), clock=loop_time_s) as client:
        recorder = client.start_recording()
        state = await client.connect(5)
        assert (state.system_id, state.mode) == (7, "AUTO")
        async with asyncio.timeout(PATIENCE_S):
            while client.failure is None:
                await asyncio.sleep(0.01)
        assert "the recording is over" in client.failure
        assert not client.state.connected
        track = recorder.track()
    assert [point.time_s for point in track.points] == [float(second) for second in range(60)]
    assert track.points[-1].lat_deg == pytest.approx(1.0 + 59 * 1.8e-4)


async def test_a_recording_takes_no_orders(tmp_path: Path) -> None:
    """Uploads, downloads, clearing and commands are refused by name, at once."""
    url = f"replay:{flight(tmp_path)}?speedup=10"
    async with VehicleClient(await open_link(url), clock=loop_time_s) as client:
        await client.connect(5)
        for order in (
            client.upload(waypoints(2), MissionType.MISSION),
            client.download(MissionType.MISSION),
            client.clear(MissionType.FENCE),
            client.set_current(1),
            client.arm(),
        ):
            with pytest.raises(ReadOnlyError, match="is a recording: it takes no transfers"):
                await order


async def test_what_a_client_records_it_can_play(tmp_path: Path) -> None:
    """A link recorded both ways, uploads included, plays back to the same vehicle."""
    writer = TlogWriter(tmp_path / "uav")
    async with flying(tap=writer.write) as (client, aircraft):
        assert (await client.upload(waypoints(3), MissionType.MISSION)).kind == "accepted"
        system_id = client.state.system_id
        assert aircraft.heard
    writer.close()
    (path,) = (tmp_path / "uav").iterdir()
    codec = Codec()
    # By record: a byte of a time may look like a frame's first, and a codec fed with both loses frames.
    names = [m.name for _, frame in read_tlog(path) for m in codec.feed(frame)]
    assert names.count("MISSION_ITEM_INT") == 3
    assert {"HEARTBEAT", "MISSION_COUNT", "MISSION_ACK"} <= set(names)
    async with VehicleClient(await open_link(f"replay:{path}"), clock=loop_time_s) as replayed:
        with contextlib.suppress(NotConnectedError):  # it may be over before anybody waits
            await replayed.connect(5)
        with pytest.raises(NotConnectedError, match="is over"):
            await replayed.wait_for(lambda state: False, PATIENCE_S)
        assert replayed.state.system_id == system_id


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("replay:", "names no file"),
        ("replay:/nowhere/at/all.tlog", "no recording"),
        ("replay:{file}?speedup=0", "speed-up"),
        ("replay:{file}?speedup=nan", "speed-up"),
        ("replay:{file}?colour=red", "no option colour"),
        ("replay:{file}?speedup", "not understood"),
        ("replay:{folder}", "no recording"),
        ("replay:{text}", "no recording"),
        ("replay:/dev/zero", "no recording"),
    ],
)
async def test_addresses_that_cannot_be_played(tmp_path: Path, url: str, words: str) -> None:
    """Each is refused in words that say what is wrong."""
    text = tmp_path / "text.tlog"
    text.write_bytes(b"\xfd no recording at all \xfe" * 40)
    known = {"file": flight(tmp_path, 2), "folder": tmp_path, "text": text}
    with pytest.raises(LinkError, match=words):
        await open_link(url.format(**known))


async def test_a_recording_keeps_its_own_clock(tmp_path: Path) -> None:
    """Played a hundred times as fast, the track begins and ends when it was flown."""
    url = f"replay:{flight(tmp_path, 20)}?speedup=100"
    async with VehicleClient(await open_link(url), clock=loop_time_s) as client:
        recorder = client.start_recording()
        assert recorder.recorded is None
        await client.connect(5)
        async with asyncio.timeout(PATIENCE_S):
            while client.failure is None:
                await asyncio.sleep(0.01)
        assert recorder.recorded == pytest.approx((1_790_000_000.0, 1_790_000_019.0), abs=1e-3)
        recorder.forget()
        assert recorder.recorded is None
