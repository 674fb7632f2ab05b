"""The services of the process that holds the links, opened and closed together."""

from __future__ import annotations

import asyncio
import time
from functools import partial
from importlib import import_module
from typing import Final

from app.services.desk import Desk
from app.services.limits import Limits
from app.services.plans import work
from app.services.plans.library import PlanLibrary
from app.services.plans.pool import WorkerPool
from app.services.store.database import Database
from app.services.store.plans import PlanStore
from app.services.terrain.ground import GroundService, terrain_folder
from app.services.vehicles.station import Station
from app.services.vehicles.times import DEFAULT_TIMES

#: What an upload, a check before flight and heights of the ground need; the process with the links does not.
_FOR_ORDERS: Final = (
    "app.services.plans.filed_mission",
    "app.services.terrain.sampling",
    "app.services.vehicles.brief",
    "mavlink.formats",
    "planner.geojson",
)


class LinksHouse:
    """The vehicles, and one worker that reads and encodes plans for them.

    Attributes
    ----------
    needed_s
        When somebody last asked, by the monotonic clock.
    """

    def __init__(self, limits: Limits) -> None:
        # The service that started this process has brought its tables up to date, and holds its lock.
        self._database = Database(limits.database, alone=False)
        ready = partial(work.limited, ready_for_orders, limits.request_memory_bytes, behind=False)
        pool = WorkerPool(1, ready)
        self._desk = Desk(pool, 1, limits.request_time_limit_s)
        library = PlanLibrary(PlanStore(self._database), self._desk)
        self.station = Station(
            self._database,
            library,
            limits.track_interval_s,
            limits.recordings,
            DEFAULT_TIMES,
            GroundService(terrain_folder(limits.database), self._desk).heights,
            limits.keys,
        )
        self.fleet = self.station.fleet
        self.needed_s = time.monotonic()
        self._greetings: set[asyncio.Task[None]] = set()

    def begin(self, greeting: asyncio.Task[None]) -> None:
        """Go on with a task until it, or this house, ends."""
        self._greetings.add(greeting)
        greeting.add_done_callback(self._greetings.discard)

    async def open(self) -> None:
        """Connect the vehicles known from before."""
        await self._database.open()
        self._desk.pool.warm()
        await self.fleet.open()

    async def close(self) -> None:
        """Let every vehicle go."""
        for greeting in self._greetings:
            greeting.cancel()
        await asyncio.gather(*self._greetings, return_exceptions=True)
        await self.fleet.close()
        await self._desk.pool.stop()
        await self._database.close()


def ready_for_orders() -> None:
    """Load what reads and encodes plans, in the worker.

    An order's time is for the order: a worker ended at its limit would begin the next one with nothing loaded
    again, and on a busy machine none would ever be carried out.
    """
    for module in _FOR_ORDERS:
        import_module(module)
