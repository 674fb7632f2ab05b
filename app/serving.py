"""A server of an application: what it does once it listens, and before it ends."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

import uvicorn

#: Open event streams are cut this long after the signal to end.
GRACE_S = 5


class Server(uvicorn.Server):
    """Tells when it listens, then greets."""

    def __init__(
        self,
        config: uvicorn.Config,
        listening: Callable[[], Coroutine[Any, Any, None]],
        ending: Callable[[], Coroutine[Any, Any, None]],
    ) -> None:
        super().__init__(config)
        self._listening = listening
        self._ending = ending
        self._greeting: asyncio.Task[None] | None = None

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to listen."""
        await super().startup(sockets)
        if self.started:
            self._greeting = asyncio.create_task(self._listening())

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End in good order."""
        # Before the services close: what is still being connected would outlive them.
        if self._greeting is not None:
            self._greeting.cancel()
            await asyncio.gather(self._greeting, return_exceptions=True)
        # Requests that wait for a vehicle get their answer now; in GRACE_S they would be cut.
        await self._ending()
        await super().shutdown(sockets)


def private_socket(path: Path) -> socket.socket:
    """A listening socket that only this user's processes reach; a dead one's is replaced."""
    path.unlink(missing_ok=True)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    before = os.umask(0o177)
    try:
        listener.bind(str(path))
    finally:
        os.umask(before)
    return listener
