"""Recordings of the vehicles' links: one folder a vehicle, .tlog files in it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from app.services.errors import NotFoundError
from app.services.vehicles.scribe import Scribe
from mavlink.links.recording import SUFFIX, TlogLimits, TlogWriter

#: Names this service gives; anything else asked for is not there.
_FOLDER: Final = re.compile(r"[0-9a-f-]{36}")
_FILE: Final = re.compile(r"[0-9A-Za-z-]{1,60}" + re.escape(SUFFIX))


@dataclass(frozen=True, slots=True)
class RecordingFile:
    """One file; ``ended_at`` is when it was last written to."""

    name: str
    size_bytes: int
    ended_at: datetime


class Recordings:
    """The folder of all recordings; they outlive the service and the vehicles."""

    def __init__(self, folder: Path, limits: TlogLimits) -> None:
        self.folder = folder
        self._limits = limits

    def scribe(self, vehicle_id: str) -> Scribe:
        """Who writes down a vehicle's link."""
        return Scribe(lambda clock: TlogWriter(self.folder / vehicle_id, self._limits, clock))

    def files(self, vehicle_id: str) -> tuple[RecordingFile, ...]:
        """A vehicle's recordings, oldest first; none for a vehicle never heard of."""
        folder = self.folder / vehicle_id
        if not _FOLDER.fullmatch(vehicle_id) or not folder.is_dir():
            return ()
        found = []
        for path in sorted(folder.glob(f"*{SUFFIX}")):
            status = path.stat()
            found.append(
                RecordingFile(path.name, status.st_size, datetime.fromtimestamp(status.st_mtime, UTC))
            )
        return tuple(found)

    def path(self, vehicle_id: str, name: str) -> Path:
        """Where a recording lies; raises NotFoundError."""
        path = self.folder / vehicle_id / name
        if not _FOLDER.fullmatch(vehicle_id) or not _FILE.fullmatch(name) or not path.is_file():
            raise NotFoundError("recording", name)
        return path


class Tape:
    """The recording of one vehicle's link, anew each time the link is opened; none where nothing records."""

    def __init__(self, recordings: Recordings | None, vehicle_id: str) -> None:
        self._recordings = recordings
        self._vehicle_id = vehicle_id
        self._writer: Scribe | None = None

    def begin(self) -> None:
        """Record from now on."""
        if self._recordings is not None:
            self._writer = self._recordings.scribe(self._vehicle_id)

    @property
    def write(self) -> Callable[[bytes], None] | None:
        """Takes every frame of the link; None where it is not recorded."""
        return None if self._writer is None else self._writer.write

    @property
    def failure(self) -> str | None:
        """Why the link is not recorded now; None while it is, or was never to be."""
        return None if self._writer is None else self._writer.failure

    def flush(self) -> None:
        """Put everything recorded so far where readers see it; waits for the disk."""
        if self._writer is not None:
            self._writer.flush()

    def end(self) -> None:
        """Close the file; waits for the disk."""
        if self._writer is not None:
            self._writer.close()
