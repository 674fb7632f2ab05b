"""What the process that holds the links logs, told by the service too: operators look at one place."""

from __future__ import annotations

import asyncio
import sys
from pathlib import Path
from typing import Final

_LOOK_S: Final = 0.25
_MOST_BYTES: Final = 1 << 20
_LAST_BYTES: Final = 2000


class LogRelay:
    """Copies to standard error what is added to a log."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._position = 0
        self._begun = 0

    def skip(self) -> None:
        """Begin with what is added from now on."""
        self._position = self._begun = self._size()

    def _size(self) -> int:
        return self._path.stat().st_size if self._path.exists() else 0

    def copy(self) -> None:
        """Copy what has been added."""
        size = self._size()
        if size < self._position:
            self._position = self._begun = 0  # it was begun anew
        if size == self._position:
            return
        with self._path.open("rb") as file:
            file.seek(self._position)
            added = file.read(_MOST_BYTES)
        self._position += len(added)
        sys.stderr.write(added.decode(errors="replace"))
        sys.stderr.flush()

    async def serve(self) -> None:
        """Copy as it comes."""
        while True:
            self.copy()
            await asyncio.sleep(_LOOK_S)

    def last_words(self) -> str:
        """What was added last, since the relay began."""
        if not self._path.exists():
            return ""
        with self._path.open("rb") as file:
            file.seek(max(self._begun, self._size() - _LAST_BYTES))
            return file.read().decode(errors="replace").strip()
