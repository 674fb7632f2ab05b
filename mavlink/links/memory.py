"""A pair of links inside one process, with the faults of a radio on request."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from random import Random
from typing import Final

from mavlink.errors import LinkError
from mavlink.links.inbox import Inbox

# A chunk held back for reordering goes out at the latest after this time, should no other follow.
_HOLD_S: Final = 0.02


@dataclass(frozen=True, slots=True)
class LinkFaults:
    """Chances, per chunk sent, of the ways a radio misbehaves; delay applies to every chunk."""

    loss: float = 0.0
    duplication: float = 0.0
    reordering: float = 0.0
    delay_s: float = 0.0

    def __post_init__(self) -> None:
        chances = (self.loss, self.duplication, self.reordering)
        if not all(0.0 <= chance <= 1.0 for chance in chances) or not self.delay_s >= 0.0:
            raise ValueError(f"chances lie in 0 to 1 and delays are not negative: {self}")


NO_FAULTS: Final = LinkFaults()


class MemoryLink:
    """One end of a pair made by ``memory_pair``.

    Attributes
    ----------
    connected
        Set False to cut what this end sends, as when its aircraft flies out of range.
    """

    def __init__(self, name: str, faults: LinkFaults, seed: int) -> None:
        self.connected = True
        self._name = name
        self._faults = faults
        self._random = Random(seed)
        self._inbox = Inbox()
        self._other: MemoryLink | None = None
        self._held: list[bytes] = []
        self._closed = False

    @property
    def url(self) -> str:
        """``memory:`` and the end's name."""
        return f"memory:{self._name}"

    def join(self, other: MemoryLink) -> None:
        """Deliver to ``other`` from now on."""
        self._other = other

    async def send(self, data: bytes) -> None:
        """Deliver to the other end, faults permitting."""
        if self._closed:
            raise LinkError("link closed")
        if not self.connected or self._random.random() < self._faults.loss:
            return
        if self._random.random() < self._faults.reordering:
            self._held.append(data)
            asyncio.get_running_loop().call_later(_HOLD_S, self._release)
            return
        copies = 2 if self._random.random() < self._faults.duplication else 1
        for _ in range(copies):
            self._deliver(data)
        self._release()

    def _release(self) -> None:
        held, self._held = self._held, []
        for data in held:
            self._deliver(data)

    def _deliver(self, data: bytes) -> None:
        if self._other is None or self._closed:
            return
        if self._faults.delay_s > 0.0:
            asyncio.get_running_loop().call_later(self._faults.delay_s, self._other.take, data)
        else:
            self._other.take(data)

    def take(self, data: bytes) -> None:
        """Receive a chunk from the other end."""
        if not self._closed:
            self._inbox.put(data)

    async def receive(self) -> bytes:
        """Wait for bytes."""
        return await self._inbox.get()

    async def close(self) -> None:
        """Close this end; the other hears nothing more, as on a radio."""
        self._closed = True
        self._inbox.fail("link closed")


def memory_pair(faults: LinkFaults = NO_FAULTS, seed: int = 0) -> tuple[MemoryLink, MemoryLink]:
    """Two joined links, e.g. a ground station's and an aircraft's; the seed fixes every fault."""
    ground, air = MemoryLink("ground", faults, 2 * seed), MemoryLink("air", faults, 2 * seed + 1)
    ground.join(air)
    air.join(ground)
    return ground, air
