"""Keeps the process at the door: started on the listening socket, started again when it has died."""

from __future__ import annotations

import asyncio
import socket
import subprocess
import sys
from typing import Final

import structlog

from app.services.links.place import Place

log = structlog.get_logger(__name__)

_LOOK_S: Final = 0.2
_AGAIN_S: Final = 1.0
_END_S: Final = 5.0


class DoorProcess:
    """The door on a listening socket that this process holds, too: it is open to the next door.

    It ends when this process does, however that is: then its standard input ends.
    """

    def __init__(self, listener: socket.socket, place: Place) -> None:
        self._listener = listener
        self._place = place
        self._process: subprocess.Popen[bytes] | None = None

    async def open(self) -> None:
        """Start it; return once it answers."""
        await asyncio.to_thread(self._start)

    def _start(self) -> None:
        descriptor = self._listener.fileno()
        command = [sys.executable, "-m", "app.door", str(descriptor)]
        command += [str(self._place.web), str(self._place.links)]
        self._process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            pass_fds=[descriptor],
            start_new_session=True,
        )
        assert self._process.stdout is not None
        self._process.stdout.readline()

    async def watch(self) -> None:
        """Start it again whenever it has ended."""
        while True:
            await asyncio.sleep(_LOOK_S)
            if self._process is not None and self._process.poll() is not None:
                log.error("the door has ended; it is opened again", code=self._process.returncode)
                self._forget()
                await asyncio.sleep(_AGAIN_S)
                await self.open()

    def close(self) -> None:
        """End it."""
        if self._process is None:
            return
        self._process.terminate()
        try:
            self._process.wait(_END_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._forget()

    def _forget(self) -> None:
        process, self._process = self._process, None
        if process is not None and process.stdin is not None and process.stdout is not None:
            process.stdin.close()
            process.stdout.close()
