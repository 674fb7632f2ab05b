"""Serial ports: pyserial blocks, so one thread reads and one writes."""

from __future__ import annotations

import asyncio
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Final

import serial

from mavlink.errors import LinkError
from mavlink.links.inbox import Inbox

_READ_TIMEOUT_S: Final = 0.1
_WRITE_TIMEOUT_S: Final = 1.0


class SerialLink:
    """A serial port. Opened by ``open_serial``."""

    def __init__(self, device: str, baud: int, port: Any) -> None:
        self._device = device
        self._baud = baud
        self._port = port
        self._inbox = Inbox()
        self._loop = asyncio.get_running_loop()
        self._stop = threading.Event()
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="serial-writer")
        self._reader = threading.Thread(target=self._read, name="serial-reader", daemon=True)
        self._reader.start()

    @property
    def url(self) -> str:
        """The address."""
        return f"serial:{self._device}:{self._baud}"

    def _read(self) -> None:
        while not self._stop.is_set():
            try:
                data = self._port.read(max(1, self._port.in_waiting))
            except (OSError, TypeError) as error:  # pyserial raises TypeError when closed under a reader
                if not self._stop.is_set():
                    self._loop.call_soon_threadsafe(self._inbox.fail, f"{self.url} failed: {error}")
                return
            if data:
                self._loop.call_soon_threadsafe(self._inbox.put, data)

    async def send(self, data: bytes) -> None:
        """Write in the writer's thread."""
        if self._stop.is_set():
            raise LinkError("link closed")
        try:
            await self._loop.run_in_executor(self._writer, self._port.write, data)
        except OSError as error:
            raise LinkError(f"{self.url} failed: {error}") from error

    async def receive(self) -> bytes:
        """Wait for bytes."""
        return await self._inbox.get()

    async def close(self) -> None:
        """Stop both threads and close the port."""
        if self._stop.is_set():
            return
        self._stop.set()
        await asyncio.to_thread(self._reader.join)
        await asyncio.to_thread(self._writer.shutdown)
        self._port.close()
        self._inbox.fail("link closed")


async def open_serial(device: str, baud: int) -> SerialLink:
    """Open the port.

    Raises
    ------
    LinkError
        The device does not exist, is in use, or does not take this baud rate.
    """

    def opened() -> Any:
        return serial.Serial(
            device, baud, timeout=_READ_TIMEOUT_S, write_timeout=_WRITE_TIMEOUT_S, exclusive=True
        )

    try:
        port = await asyncio.to_thread(opened)
    except (OSError, ValueError) as error:  # serial.SerialException is an OSError
        raise LinkError(f"'serial:{device}:{baud}' cannot be opened: {error}") from error
    return SerialLink(device, baud, port)
