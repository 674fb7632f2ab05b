"""Which process a request is for, and how many of its kind go there at once.

The process that holds the links answers a few reads at a time, however many are sent: an order to a vehicle
waits behind none of them.
"""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import Final

from app.door.heads import RequestHead

_VEHICLES: Final = b"/api/v1/vehicles"
#: So long a request waits for its turn.
PATIENCE_S: Final = 30.0


class CrowdedError(Exception):
    """Too many requests of a kind are under way."""


@dataclass(frozen=True, slots=True)
class LaneKind:
    """Requests of a kind.

    Parameters
    ----------
    links
        Whether they are for the process that holds the links.
    most
        How many go on at once.
    waits
        Whether more wait for their turn, or are told to come again.
    """

    name: str
    links: bool
    most: int
    waits: bool


ORDERS: Final = LaneKind("orders", True, 64, False)
READS: Final = LaneKind("reads", True, 2, True)
#: Telemetry and recordings last as long as somebody listens.
STREAMS: Final = LaneKind("streams", True, 64, False)
#: Connections, uploads and the like wait for a vehicle most of the time.
CHANGES: Final = LaneKind("changes", True, 16, True)
#: Events of plans are listened to as long as the plan is made, or longer.
EVENTS: Final = LaneKind("events", False, 150, False)
OTHERS: Final = LaneKind("others", False, 400, False)


def lane_of(request: RequestHead) -> LaneKind:
    """The kind of a request."""
    path = request.path
    if path != _VEHICLES and not path.startswith(_VEHICLES + b"/"):
        return EVENTS if path.endswith(b"/events") else OTHERS
    if request.method == b"POST" and path.endswith(b"/commands"):
        return ORDERS
    if request.method in (b"GET", b"HEAD"):
        long = (
            path.endswith(b"/telemetry") or b"/logs/" in path or path.endswith((b"/parameters", b"/mission"))
        )
        return STREAMS if long else READS
    return CHANGES


class Lanes:
    """Requests of every kind that are under way."""

    def __init__(self) -> None:
        self._lanes = {
            lane: asyncio.Semaphore(lane.most) for lane in (ORDERS, READS, STREAMS, CHANGES, EVENTS, OTHERS)
        }

    @asynccontextmanager
    async def turn(self, lane: LaneKind) -> AsyncIterator[None]:
        """One request under way; raises CrowdedError when its turn does not come."""
        free = self._lanes[lane]
        if free.locked() and not lane.waits:
            raise CrowdedError(f"{lane.most} requests of this kind are under way")
        try:
            async with asyncio.timeout(PATIENCE_S):
                await free.acquire()
        except TimeoutError:
            raise CrowdedError("requests before this one take too long") from None
        try:
            yield
        finally:
            free.release()
