"""All services of one process, opened and closed together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import structlog

from app.services.desk import Desk
from app.services.flights.service import FlightService
from app.services.plans import work
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
from app.services.terrain.service import TerrainService
from app.services.vehicles.recordings import Recordings
from app.services.vehicles.station import Station
from app.services.vehicles.times import DEFAULT_TIMES, LinkTimes

log = structlog.get_logger(__name__)


@dataclass(frozen=True, slots=True)
class Limits:
    """How much the services take on."""

    database: Path
    workers: int
    plan_time_limit_s: float
    max_queued_plans: int
    track_interval_s: float
    plan_memory_bytes: int = 8_000_000_000
    request_workers: int = 3
    request_time_limit_s: float = 30.0
    request_memory_bytes: int = 2_000_000_000
    recordings: Recordings | None = None


def terrain_folder(database: Path) -> Path:
    """Where the posts of uploaded rasters lie: beside the database, each raster in a file of its own."""
    return database.resolve().with_name(database.stem + "-terrain")


class House:
    """The services, wired."""

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
    ) -> None:
        self.database = Database(limits.database)
        self.pool = pool or WorkerPool(
            limits.workers, partial(work.limited, initialiser, limits.plan_memory_bytes)
        )
        request_pool = pool or WorkerPool(
            limits.request_workers, partial(work.limited, initialiser, limits.request_memory_bytes)
        )
        self.desk = Desk(request_pool, limits.request_workers, limits.request_time_limit_s)
        folder = terrain_folder(limits.database)
        self.terrain = TerrainService(TerrainStore(self.database), folder, self.desk)
        self.scenarios = ScenarioService(ScenarioStore(self.database), self.desk)
        self.planning = PlanningService(
            PlanStore(self.database),
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
        station = Station(
            self.database, self.planning.library, limits.track_interval_s, limits.recordings, times
        )
        self.checks, self.transfers, self.fleet = station.checks, station.transfers, station.fleet

    async def open(self) -> None:
        """Open the database, start the workers, take up waiting plans."""
        await self.database.open()
        self.pool.warm()
        self.desk.pool.warm()
        await self.planning.start()
        await self.fleet.open()

    async def close(self) -> None:
        """Stop everything, in the opposite order."""
        await self.fleet.close()
        await self.planning.stop()
        await self.desk.pool.stop()
        await self.pool.stop()
        await self.database.close()
