"""All services of one process, opened and closed together."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from functools import partial
from typing import Protocol

import structlog

from app.services.desk import Desk
from app.services.errors import LinkError
from app.services.flights.service import FlightService
from app.services.getting_ready import tell_until_ready
from app.services.limits import Limits
from app.services.links.keeper import Keeper
from app.services.plans import work
from app.services.plans.filing import Filing
from app.services.plans.planning import BoundTask, PlanningService, Task
from app.services.plans.pool import Pool, WorkerPool
from app.services.scenarios.kept import ScenarioService
from app.services.scenarios.validation import Verdict, judge
from app.services.store.audit import AuditStore
from app.services.store.database import Database
from app.services.store.flights import FlightStore
from app.services.store.plans import PlanStore
from app.services.store.scenarios import ScenarioStore
from app.services.store.terrain import TerrainStore
from app.services.terrain.ground import GroundService, terrain_folder
from app.services.terrain.service import TerrainService
from app.services.vehicles.fleet import Fleet
from app.services.vehicles.station import Station
from app.services.vehicles.times import DEFAULT_TIMES, LinkTimes

log = structlog.get_logger(__name__)


class Whereabouts(Protocol):
    """Who knows where vehicles in flight are."""

    async def place_in_flight(self, flight_id: str) -> tuple[float, float, float | None] | None:
        """Longitude, latitude and course in degrees of the vehicle on a flight; None when none is."""


class House:
    """The services, wired.

    Parameters
    ----------
    keeper
        Keeps the process that holds the links to the vehicles; None where they are held here.
    """

    def __init__(
        self,
        limits: Limits,
        *,
        task: Task = work.plan_scenario,
        bound_task: BoundTask = work.bound_plan,
        judge_scenario: Callable[..., Verdict] = judge,
        initialiser: Callable[[], None] = work.initialise,
        pool: Pool | None = None,
        times: LinkTimes = DEFAULT_TIMES,
        keeper: Keeper | None = None,
    ) -> None:
        self.database = Database(limits.database)
        self.pool = pool or WorkerPool(
            limits.workers,
            partial(work.limited, initialiser, limits.plan_memory_bytes),
            preloaded=initialiser is work.initialise,
        )
        request_pool = pool or WorkerPool(
            limits.request_workers,
            partial(work.limited, initialiser, limits.request_memory_bytes),
            preloaded=initialiser is work.initialise,
        )
        self.desk = Desk(request_pool, limits.request_workers, limits.request_time_limit_s)
        folder = terrain_folder(limits.database)
        self.terrain = TerrainService(TerrainStore(self.database), folder, self.desk)
        self.scenarios = ScenarioService(ScenarioStore(self.database), self.desk)
        plans = PlanStore(self.database)
        self.filing = Filing(plans, self.scenarios, self.desk, folder)
        self.planning = PlanningService(
            plans,
            self.pool,
            self.desk,
            workers=limits.workers,
            time_limit_s=limits.plan_time_limit_s,
            max_queued=limits.max_queued_plans,
            task=task,
            bound_task=bound_task,
            judge_scenario=judge_scenario,
            terrain_folder=folder,
        )
        self.audit = AuditStore(self.database)
        self.flights = FlightService(FlightStore(self.database), self.planning, self.desk)
        self.keeper = keeper
        self._telling: asyncio.Task[None] | None = None
        self._station = (
            Station(
                self.database,
                self.planning.library,
                limits.track_interval_s,
                limits.recordings,
                times,
                GroundService(folder, self.desk).heights,
                limits.keys,
            )
            if keeper is None
            else None
        )

    @property
    def station(self) -> Station:
        """The vehicles; raises LinkError where another process holds them."""
        if self._station is None:
            raise LinkError("the links to the vehicles are held by another process")
        return self._station

    @property
    def fleet(self) -> Fleet:
        """The vehicles held here."""
        return self.station.fleet

    @property
    def whereabouts(self) -> Whereabouts:
        """Who knows where vehicles in flight are."""
        return self.station.fleet if self.keeper is None else self.keeper.client

    async def open(self) -> None:
        """Open the database, start the workers, take up waiting plans."""
        await self.database.open()
        if self.keeper is None:
            await self._open_all()
            await self.fleet.open()
            return
        # Before the workers: it takes its time to begin, and the vehicles wait for it.
        links = asyncio.create_task(self.keeper.open())
        try:
            await asyncio.sleep(0)
            await self._open_all()
        finally:
            await links

    async def _open_all(self) -> None:
        self.pool.warm()
        self.desk.pool.warm()
        self._telling = asyncio.create_task(tell_until_ready((self.pool, self.desk.pool)))
        await self.planning.start()

    async def close(self) -> None:
        """Stop everything, in the opposite order."""
        if self._telling is not None:
            self._telling.cancel()
        await self.let_go()
        await self.planning.stop()
        await self.desk.pool.stop()
        await self.pool.stop()
        await self.database.close()

    async def let_go(self) -> None:
        """Let the vehicles go, or whoever holds them; once is enough, again is harmless."""
        if self.keeper is None:
            await self.fleet.close()
        else:
            await self.keeper.close()
