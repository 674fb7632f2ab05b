"""Recordings written by a thread: the frames, their times, and a disk that does not keep up."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from app.services.vehicles import scribe
from app.services.vehicles.scribe import Scribe
from mavlink.links.recording import TlogWriter, read_tlog
from tests.mavlink.links.test_recording import frames


class HeldUp(TlogWriter):
    """A writer whose disk stands still until it is let go."""

    go = threading.Event()

    def write(self, frame: bytes) -> None:
        self.go.wait(20)
        super().write(frame)


def test_frames_are_written_with_the_times_they_came(tmp_path: Path) -> None:
    """Flushed, they are there for readers; closed, all of them."""
    taken = Scribe(lambda clock: TlogWriter(tmp_path, clock=clock))
    given = list(frames(6))
    before_s = time.time()
    for frame in given[:3]:
        taken.write(frame)
    taken.flush()
    (path,) = tmp_path.glob("*.tlog")
    assert [frame for _, frame in read_tlog(path)] == given[:3]
    for frame in given[3:]:
        taken.write(frame)
    taken.close()
    taken.close()
    found = list(read_tlog(path))
    assert [frame for _, frame in found] == given
    assert before_s - 1e-3 <= found[0][0] <= found[-1][0] <= time.time() + 1e-3
    assert taken.failure is None


def test_a_disk_that_stands_still_holds_nobody_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What comes is taken at once and written later under its own time; too much is lost, and told."""
    monkeypatch.setattr(scribe, "MOST_FRAMES", 4)
    monkeypatch.setattr(HeldUp, "go", threading.Event())

    def build(clock: Callable[[], float]) -> HeldUp:
        return HeldUp(tmp_path, clock=clock)

    taken = Scribe(build)
    given = list(frames(8))
    taken.write(given[0])
    for frame in given[1:]:
        taken.write(frame)
    assert "frames are lost" in (taken.failure or "")
    released_s = time.time()
    HeldUp.go.set()
    taken.close()
    (path,) = tmp_path.glob("*.tlog")
    found = list(read_tlog(path))
    assert 4 <= len(found) < 8
    assert [frame for _, frame in found] == given[: len(found)]
    assert all(at_s <= released_s + 1e-3 for at_s, _ in found)
    assert taken.failure is None
