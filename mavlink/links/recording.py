"""Recordings of a link: .tlog files, as MAVProxy, Mission Planner, QGroundControl and pymavlink read them.

A .tlog holds frame after frame as they went over the wire, both ways, each behind its time: microseconds
since 1970 as eight bytes, most significant first.

Source: pymavlink ``mavutil.mavlogfile``.
"""

from __future__ import annotations

import contextlib
import struct
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO, Final

from mavlink.wire.codec import MAGIC, frame_end

STAMP: Final = struct.Struct(">Q")
SUFFIX: Final = ".tlog"

_MICROSECONDS: Final = 1_000_000
_FLUSH_S: Final = 1.0
_RETRY_S: Final = 5.0
_CHUNK_BYTES: Final = 1 << 16
#: A frame's time may lie this far from the one before; what claims more is no time.
_LONGEST_GAP_US: Final = 7 * 86_400 * _MICROSECONDS
_LATEST_US: Final = 7_258_118_400 * _MICROSECONDS  # the year 2200


@dataclass(frozen=True, slots=True)
class TlogLimits:
    """How much is recorded.

    Parameters
    ----------
    file_bytes
        A file that has grown to this size is closed and a new one begun.
    total_bytes
        When all recordings below the folder are larger than this, the oldest go; the open one stays.
    """

    file_bytes: int = 64_000_000
    total_bytes: int = 2_000_000_000

    def __post_init__(self) -> None:
        if self.file_bytes < 1024 or self.total_bytes < self.file_bytes:
            raise ValueError(f"a file takes 1024 bytes at least, all files no less than one: {self}")


class TlogWriter:
    """Writes the frames of one link; hand ``write`` to a client as its ``tap``.

    Parameters
    ----------
    folder
        Made when the first frame comes. Its parent's recordings count together for ``total_bytes``.
    clock
        Seconds since 1970.

    Attributes
    ----------
    failure
        Why nothing is recorded, e.g. a full disk; the link goes on without, and a new file is tried every
        few seconds. None while all is well.
    """

    def __init__(
        self, folder: Path, limits: TlogLimits = TlogLimits(), clock: Callable[[], float] = time.time
    ) -> None:
        self.folder = folder
        self.failure: str | None = None
        self._limits = limits
        self._clock = clock
        self._file: BinaryIO | None = None
        self._written = 0
        self._flushed_s = 0.0
        self._failed_s = 0.0
        self._last_us = 0
        self._closed = False

    def write(self, frame: bytes) -> None:
        """Write one frame with the time of now."""
        now_s = self._clock()
        if self._closed or (self.failure is not None and abs(now_s - self._failed_s) < _RETRY_S):
            return
        # Readers take time to run forwards; a clock set back must not make a recording unreadable.
        self._last_us = max(self._last_us, round(now_s * _MICROSECONDS))
        try:
            if self._file is None or self._written + STAMP.size + len(frame) > self._limits.file_bytes:
                self._begin()
            assert self._file is not None
            self._file.write(STAMP.pack(self._last_us) + frame)
            self._written += STAMP.size + len(frame)
            if self.failure is not None or abs(now_s - self._flushed_s) >= _FLUSH_S:
                self._flushed_s = now_s
                self._file.flush()
            self.failure = None
        except OSError as error:
            self._fail(error)

    def flush(self) -> None:
        """Put everything written so far where readers see it."""
        if self._file is not None:
            try:
                self._file.flush()
            except OSError as error:
                self._fail(error)

    def close(self) -> None:
        """Write what is left and close the file; closing twice is harmless."""
        self.flush()
        self._closed = True
        self._abandon()

    def _begin(self) -> None:
        if self._file is not None:
            self._file.close()
            self._file = None
        self.folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        stamp = datetime.fromtimestamp(self._last_us / _MICROSECONDS, UTC).strftime("%Y%m%dT%H%M%S")
        number = 1
        while True:
            try:
                path = self.folder / f"{stamp}-{number:03d}{SUFFIX}"
                # Where an aircraft has been, and what it was told, is for this user alone.
                path.touch(mode=0o600, exist_ok=False)
                self._file = path.open("wb")
                break
            except FileExistsError:
                number += 1
        self._written = 0
        prune(self.folder.parent, self._limits.total_bytes, keep=Path(self._file.name))

    def _fail(self, error: OSError) -> None:
        self.failure, self._failed_s = _words(error), self._clock()
        path = None if self._file is None else Path(self._file.name)
        self._abandon()
        if path is not None:
            with contextlib.suppress(OSError):
                # Tried every few seconds, empty files would be many.
                if path.stat().st_size == 0:
                    path.unlink()

    def _abandon(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            try:
                file.close()
            except OSError as error:
                self.failure = self.failure or _words(error)


def _words(error: OSError) -> str:
    return f"recording has stopped: {error.strerror or error}"


def prune(folder: Path, total_bytes: int, keep: Path) -> None:
    """Delete the oldest recordings below a folder until the rest are no larger than ``total_bytes``."""
    files = []
    for path in folder.rglob(f"*{SUFFIX}"):
        status = path.stat()
        files.append((status.st_mtime_ns, path.name, path, status.st_size))
    total = sum(size for _, _, _, size in files)
    for _, _, path, size in sorted(files, key=lambda entry: entry[:2]):
        if total <= total_bytes:
            return
        if path != keep:
            path.unlink(missing_ok=True)
            total -= size


def read_tlog(path: Path) -> Iterator[tuple[float, bytes]]:
    """Times in seconds since 1970 and frames of a recording.

    What is no frame behind a plausible time is skipped, as is a frame cut off at the end. Checksums are
    left to the codec.
    """
    buffer = b""
    last_us: int | None = None
    with path.open("rb") as file:
        while True:
            chunk = file.read(_CHUNK_BYTES)
            buffer += chunk
            position = 0
            while position + STAMP.size < len(buffer):
                end, stamp_us = _record(buffer, position, last_us)
                if end is None and chunk:
                    break  # cut off by the end of the chunk
                if end is None or stamp_us is None:
                    position = _next(buffer, position)
                    continue
                yield stamp_us / _MICROSECONDS, buffer[position + STAMP.size : end]
                last_us, position = stamp_us, end
            buffer = buffer[position:]
            if not chunk:
                return


def _record(buffer: bytes, position: int, last_us: int | None) -> tuple[int | None, int | None]:
    """End and time of the record at a position; no time when there is none, no end when it is cut off."""
    start = position + STAMP.size
    if MAGIC.match(buffer, start) is None:
        return start, None
    (stamp_us,) = STAMP.unpack_from(buffer, position)
    if stamp_us > _LATEST_US or (last_us is not None and abs(stamp_us - last_us) > _LONGEST_GAP_US):
        return start, None
    end = frame_end(buffer, start)
    return (start, None) if end == start else (end, stamp_us)


def _next(buffer: bytes, position: int) -> int:
    """The next position at which a record may begin."""
    found = MAGIC.search(buffer, position + STAMP.size + 1)
    return len(buffer) - STAMP.size if found is None else found.start() - STAMP.size
