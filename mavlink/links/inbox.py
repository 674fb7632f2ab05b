"""Received bytes waiting for their reader."""

from __future__ import annotations

import asyncio
from typing import Final

from mavlink.errors import LinkError

# A reader this far behind is dead or swamped; the oldest bytes go, as they would on a radio.
_LIMIT_BYTES: Final = 1 << 22


class Inbox:
    """An unbounded-latency, bounded-size queue of bytes with one reader.

    Attributes
    ----------
    dropped_bytes
        Bytes thrown away because the reader did not come for them.
    """

    def __init__(self) -> None:
        self.dropped_bytes = 0
        self._chunks: list[bytes] = []
        self._size = 0
        self._failure: str | None = None
        self._wakeup = asyncio.Event()

    def put(self, data: bytes) -> None:
        """Add bytes and wake the reader."""
        if self._size + len(data) > _LIMIT_BYTES:
            self.dropped_bytes += self._size
            self._chunks.clear()
            self._size = 0
        self._chunks.append(data)
        self._size += len(data)
        self._wakeup.set()

    def fail(self, reason: str) -> None:
        """End the inbox: what has arrived is still handed out, then ``get`` raises LinkError."""
        if self._failure is None:
            self._failure = reason
        self._wakeup.set()

    async def get(self) -> bytes:
        """Wait for bytes and take all there are."""
        while not self._chunks:
            if self._failure is not None:
                raise LinkError(self._failure)
            self._wakeup.clear()
            await self._wakeup.wait()
        data = b"".join(self._chunks)
        self._chunks.clear()
        self._size = 0
        return data
