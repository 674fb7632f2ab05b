"""Writes the frames of a link in a thread of its own: a disk that takes its time holds nobody up."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from typing import Final

from mavlink.links.recording import TlogWriter

#: So many frames wait for the disk; those that come then are lost, which is told.
MOST_FRAMES: Final = 50_000
#: Frames are written together this often.
_TOGETHER_S: Final = 0.1
#: So long a reader waits for what was recorded before it came, and the end of a link for its last frames.
_PATIENCE_S: Final = 5.0


class Scribe:
    """A recording of one link.

    Parameters
    ----------
    build
        A writer for a clock, which tells when the frame at hand came.
    """

    def __init__(self, build: Callable[[Callable[[], float]], TlogWriter]) -> None:
        self._writer = build(lambda: self._moment_s)
        self._moment_s = 0.0
        # Of what threads may share without a lock: a frame costs whoever records it next to nothing.
        self._frames: deque[tuple[float, bytes]] = deque()
        self._flushes: deque[threading.Event] = deque()
        self._hurry = threading.Event()
        self._ending = False
        self._lost = 0
        self._thread = threading.Thread(target=self._serve, name="recording", daemon=True)
        self._thread.start()

    def write(self, frame: bytes) -> None:
        """Take one frame with the time of now."""
        if self._ending or len(self._frames) >= MOST_FRAMES:
            self._lost += 1
        else:
            self._frames.append((time.time(), frame))

    @property
    def failure(self) -> str | None:
        """Why frames are not recorded now; None while all are."""
        if len(self._frames) >= MOST_FRAMES:
            return f"recording has stopped: the disk takes too long, {self._lost} frames are lost"
        return self._writer.failure

    def flush(self) -> None:
        """Put everything taken so far where readers see it; waits for it."""
        done = threading.Event()
        self._flushes.append(done)
        self._hurry.set()
        done.wait(_PATIENCE_S)

    def close(self) -> None:
        """Write what is left and close the file; closing twice is harmless."""
        self._ending = True
        self._hurry.set()
        self._thread.join(_PATIENCE_S)

    def _serve(self) -> None:
        while not self._ending:
            self._hurry.wait(_TOGETHER_S)
            self._hurry.clear()
            waiting = [self._flushes.popleft() for _ in range(len(self._flushes))]
            self._write_frames()
            if waiting:
                self._writer.flush()
            for done in waiting:
                done.set()
        self._write_frames()
        self._writer.close()
        for done in self._flushes:
            done.set()

    def _write_frames(self) -> None:
        while self._frames:
            self._moment_s, frame = self._frames[0]
            self._writer.write(frame)
            self._frames.popleft()
