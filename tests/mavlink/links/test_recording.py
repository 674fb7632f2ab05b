"""Recordings: pymavlink reads what was written, and we read what is damaged."""

from __future__ import annotations

import resource
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavutil

from mavlink.links.recording import STAMP, TlogLimits, TlogWriter, read_tlog
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message

MOMENT_S = 1_790_000_000.0
UNLIMITED = TlogLimits()


class Clock:
    """Time that stands until it is told to go on."""

    def __init__(self) -> None:
        self.now_s = MOMENT_S

    def __call__(self) -> float:
        return self.now_s


def frames(count: int, system_id: int = 1) -> list[bytes]:
    """Different frames of one sender."""
    codec = Codec(system_id, 1)
    return [
        codec.pack(Message("GLOBAL_POSITION_INT", {"time_boot_ms": 100 * number, "lat": number}))
        for number in range(count)
    ]


def recorded(folder: Path, count: int = 50, limits: TlogLimits = UNLIMITED) -> list[Path]:
    """Files of a recording of so many frames, a tenth of a second apart."""
    clock = Clock()
    writer = TlogWriter(folder / "uav", limits, clock)
    for frame in frames(count):
        writer.write(frame)
        clock.now_s += 0.1
    writer.close()
    return sorted((folder / "uav").iterdir())


def test_pymavlink_reads_what_was_written(tmp_path: Path) -> None:
    """mavutil's log reader finds every message with its time, in order."""
    (path,) = recorded(tmp_path)
    log = mavutil.mavlogfile(str(path))
    found = []
    while (message := log.recv_match(type="GLOBAL_POSITION_INT")) is not None:
        found.append((message.lat, message._timestamp))
    log.f.close()
    assert [lat for lat, _ in found] == list(range(50))
    assert [time_s for _, time_s in found] == pytest.approx([MOMENT_S + n / 10 for n in range(50)], abs=1e-5)


def test_we_read_what_was_written(tmp_path: Path) -> None:
    """Frames come back byte for byte with their times."""
    (path,) = recorded(tmp_path)
    times, read = zip(*read_tlog(path), strict=True)
    assert list(read) == frames(50)
    assert times == pytest.approx([MOMENT_S + n / 10 for n in range(50)], abs=1e-5)


def test_we_read_what_pymavlink_wrote(tmp_path: Path) -> None:
    """A log written as pymavlink's own writers do gives its messages."""
    path = tmp_path / "theirs.tlog"
    with path.open("wb") as file:
        mav = mavutil.mavlink.MAVLink(None, 1, 1)
        for number in range(5):
            file.write(STAMP.pack(round((MOMENT_S + number) * 1e6)))
            file.write(mav.statustext_encode(6, f"line {number}".encode()).pack(mav))
    codec = Codec()
    texts = [message.text("text") for _, frame in read_tlog(path) for message in codec.feed(frame)]
    assert texts == [f"line {number}" for number in range(5)]


@given(st.binary(max_size=60), st.integers(0, 20), st.integers(0, 40))
def test_damage_costs_no_more_than_its_surroundings(
    tmp_path_factory: pytest.TempPathFactory, junk: bytes, at: int, cut: int
) -> None:
    """With junk between two frames and a cut at the end, the frames before the junk are all read."""
    path = tmp_path_factory.mktemp("damaged") / "x.tlog"
    whole = frames(20)
    records = [STAMP.pack(round((MOMENT_S + n) * 1e6)) + frame for n, frame in enumerate(whole)]
    data = b"".join(records[:at]) + junk + b"".join(records[at:])
    path.write_bytes(data[: len(data) - cut])
    read = [frame for _, frame in read_tlog(path)]
    assert read[: min(at, 18)] == whole[: min(at, 18)]
    if not junk:
        assert len(read) >= 18


def test_large_recordings_are_divided_and_the_oldest_go(tmp_path: Path) -> None:
    """No file exceeds its size, all files together no more than theirs, and the newest frame is kept."""
    limits = TlogLimits(file_bytes=1024, total_bytes=4096)
    paths = recorded(tmp_path, 500, limits)
    sizes = [path.stat().st_size for path in paths]
    assert max(sizes) <= 1024
    assert 2048 < sum(sizes) <= 4096 + 1024
    newest = max(paths, key=lambda path: next(read_tlog(path))[0])
    assert list(read_tlog(newest))[-1][1] == frames(500)[-1]


def test_a_clock_set_back_does_not_turn_time_round(tmp_path: Path) -> None:
    """Times of a recording never decrease."""
    clock = Clock()
    writer = TlogWriter(tmp_path / "uav", clock=clock)
    for frame, step_s in zip(frames(3), (0.0, -3600.0, 3601.0), strict=True):
        clock.now_s += step_s
        writer.write(frame)
    writer.close()
    (path,) = (tmp_path / "uav").iterdir()
    times = [time_s for time_s, _ in read_tlog(path)]
    assert times == sorted(times)


def test_a_folder_that_cannot_be_written_stops_the_recording_for_a_while(tmp_path: Path) -> None:
    """The reason is kept and nothing is raised: the link goes on, and so does the recording once it can."""
    clock = Clock()
    (tmp_path / "uav").write_text("a file stands here")
    writer = TlogWriter(tmp_path / "uav", clock=clock)
    for frame in frames(3):
        writer.write(frame)
    assert writer.failure is not None
    assert "recording has stopped" in writer.failure
    (tmp_path / "uav").unlink()
    for _ in range(10):
        clock.now_s += 1.0
        writer.write(frames(1)[0])
    assert writer.failure is None
    writer.close()
    (path,) = (tmp_path / "uav").iterdir()
    assert len(list(read_tlog(path))) > 3


def test_a_full_disk_leaves_no_empty_files(tmp_path: Path) -> None:
    """Tried again and again while there is no room, a recording leaves one file at most behind."""
    clock = Clock()
    writer = TlogWriter(tmp_path / "uav", clock=clock)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        for _ in range(30):
            clock.now_s += 1.0
            writer.write(frames(1)[0])
        assert writer.failure is not None
        assert list((tmp_path / "uav").iterdir()) == []
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    clock.now_s += 10.0
    writer.write(frames(1)[0])
    assert writer.failure is None
    writer.close()


def test_limits_must_make_sense() -> None:
    """A total smaller than one file is refused."""
    with pytest.raises(ValueError, match="no less than one"):
        TlogLimits(file_bytes=4096, total_bytes=2048)
