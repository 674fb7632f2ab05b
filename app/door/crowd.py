"""How many connections a door keeps open, and which of them makes room for another."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager

#: Descriptors kept for what is no connection, and how many a connection takes: its own, and one behind.
_SPARE, _EACH = 64, 2


def most_connections(wanted: int, descriptors: int) -> int:
    """So many connections as are wanted, or as there are descriptors for."""
    return max(8, min(wanted, (descriptors - _SPARE) // _EACH))


class Crowd:
    """Connections that are open; of those whose client is waited for, the one that waits longest gives way.

    However many connections somebody opens and leaves idle or half said, who asks something is served.

    Attributes
    ----------
    open
        How many there are.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self.open = 0
        self._waiting: dict[asyncio.Task[None], None] = {}

    @contextmanager
    def connected(self) -> Iterator[bool]:
        """Within it a connection is open; whether there is room for it. Its task is cancelled to give way."""
        self.open += 1
        try:
            yield self.open <= self._most or self._make_room()
        finally:
            self.open -= 1

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Within it the client of this connection is waited for."""
        task = asyncio.current_task()
        assert task is not None
        self._waiting[task] = None
        try:
            yield
        finally:
            self._waiting.pop(task, None)

    def _make_room(self) -> bool:
        task = next(iter(self._waiting), None)
        if task is None:
            return False
        del self._waiting[task]
        task.cancel()
        return True
