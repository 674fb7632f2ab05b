"""Plans: submitted, queued, run in the worker pool, watched, cancelled."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import AsyncGenerator, Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import structlog

from app.services.desk import Desk
from app.services.documents import write_json
from app.services.errors import (
    ConflictError,
    NotFoundError,
    OverloadedError,
    RefusedError,
    StorageError,
)
from app.services.hub import Hub
from app.services.metrics import PLANNING_SECONDS, PLANS_ENDED, PLANS_RUNNING
from app.services.plans import work
from app.services.plans.attempt import attempted, failure
from app.services.plans.bounder import Bounder
from app.services.plans.library import PlanLibrary
from app.services.plans.pool import Pool
from app.services.plans.progress_pipe import progress_pipe
from app.services.records import PlanRecord
from app.services.scenarios.received import Received, judged
from app.services.scenarios.validation import Verdict, judge
from app.services.store.plans import PlanStore

log = structlog.get_logger(__name__)

#: How often the end of a plan that could not be written is tried again, seconds.
SETTLE_S = 1.0
#: Members of a scenario that name an uploaded raster.
RASTERS = ("terrain", "importance_raster")

Task = Callable[..., work.WorkResult]
BoundTask = Callable[..., work.WorkResult | None]


class PlanningService:
    """The plans of one service.

    Parameters
    ----------
    store
        Where they are kept.
    pool
        Where they are made.
    desk
        Where scenarios are judged before.
    workers
        How many are made at once.
    time_limit_s
        The longest one may take.
    max_queued
        More waiting than this are refused.
    task
        The function run in a worker: scenario text and progress pipe in, WorkResult out. For a scenario
        that names a terrain the folder of the rasters is a third argument, and the judge's second.
    bound_task
        The same for the bound of a done plan: scenario text, plan text and the path of a file that is there
        while the bound is wanted.
    terrain_folder
        Where uploaded rasters are.
    """

    def __init__(
        self,
        store: PlanStore,
        pool: Pool,
        desk: Desk,
        *,
        workers: int,
        time_limit_s: float,
        max_queued: int,
        task: Task = work.plan_scenario,
        bound_task: BoundTask = work.bound_plan,
        judge_scenario: Callable[..., Verdict] = judge,
        terrain_folder: Path | None = None,
    ) -> None:
        self._store = store
        self._pool = pool
        self._desk = desk
        self._workers = workers
        self._time_limit_s = time_limit_s
        self._max_queued = max_queued
        self._task = task
        self._bound_task = bound_task
        self._judge = judge_scenario
        self._terrain_folder = terrain_folder
        self.library = PlanLibrary(store, desk)
        self._queue: asyncio.Queue[str] = asyncio.Queue()
        self._running: dict[str, asyncio.Task[None]] = {}
        self._live: dict[str, tuple[str | None, float]] = {}
        self._consumers: list[asyncio.Task[None]] = []
        self._hub: Hub[PlanRecord] = Hub()
        self._bounder = Bounder(self._bound, self._bounded, self._room)
        self._stopping = False

    async def start(self) -> None:
        """Take up what an earlier service left, and begin to plan."""
        reason = failure(
            "service-restarted",
            "The service was restarted while it planned",
            "the service ended while this plan was being made; post the scenario again",
        )
        for plan_id in await self._store.recover(reason):
            self._queue.put_nowait(plan_id)
        self._consumers = [asyncio.create_task(self._consume()) for _ in range(self._workers)]
        self._consumers.append(asyncio.create_task(self._bounder.serve()))
        self._consumers.append(asyncio.create_task(self._settle()))

    async def stop(self) -> None:
        """Stop planning; plans being made go back into the queue of the next service."""
        self._stopping = True
        for task in (*self._consumers, *self._running.values()):
            task.cancel()
        await asyncio.gather(*self._consumers, *self._running.values(), return_exceptions=True)

    async def validate(self, body: bytes) -> Verdict:
        """Judge a scenario, as JSON, without planning it."""
        return (await self._judged(body))[1]

    async def _judged(self, body: bytes) -> tuple[Received, Verdict]:
        folder = None if self._terrain_folder is None else str(self._terrain_folder)
        return await self._desk.run("scenario", judged, body, self._judge, folder)

    @property
    def terrain_folder(self) -> Path | None:
        """Where uploaded rasters are."""
        return self._terrain_folder

    def _terrain_of(self, document: Mapping[str, Any]) -> tuple[str, ...]:
        """The folder of the rasters, for a scenario that names one."""
        if all(document.get(name) is None for name in RASTERS) or self._terrain_folder is None:
            return ()
        return (str(self._terrain_folder),)

    async def submit(
        self, scenario: Mapping[str, Any] | bytes, key: str | None = None, scenario_id: str | None = None
    ) -> PlanRecord:
        """Queue a scenario, as JSON or read already.

        Parameters
        ----------
        key
            Idempotency key: the same key with the same scenario answers with the plan made the first time.
        scenario_id
            The kept scenario it is made of; the plan is stale once that one is another.

        Raises
        ------
        RefusedError
            The scenario is wrong.
        ConflictError
            The key stands for another scenario.
        OverloadedError
            Too many plans are waiting.
        """
        known = None if key is None else await self._store.by_key(key)
        if known is None and await self._store.count("queued") >= self._max_queued:
            # Before it is judged, which costs more than to be told so.
            raise OverloadedError("too many plans are waiting; try again later", retry_after_s=10)
        body = scenario if isinstance(scenario, bytes) else write_json(scenario).encode()
        asked, verdict = await self._judged(body)
        if known is not None:
            record, digest = known
            if digest != asked.digest:
                raise ConflictError(f"the idempotency key {key} stands for another scenario")
            return self._with_progress(record)
        if verdict.errors:
            count, first = len(verdict.errors), verdict.errors[0]
            detail = f"{first.feature}: {first.message}" if count == 1 else f"{count} rules are broken"
            raise RefusedError(f"the scenario is refused: {detail}", verdict.errors)
        warnings = [work.finding_json(finding) for finding in verdict.warnings]
        record = await self._store.add(
            asked.name,
            asked.text,
            asked.digest,
            warnings,
            key,
            scenario_id,
            asked.scenario_hash,
            self._max_queued,
        )
        self._queue.put_nowait(record.id)
        self._bounder.look()
        return record

    async def get(self, plan_id: str) -> PlanRecord:
        """One plan, with its live progress."""
        return self._with_progress(await self._store.get(plan_id))

    async def newest(self, limit: int, offset: int, state: str | None) -> tuple[PlanRecord, ...]:
        """Plans, newest first."""
        return tuple(self._with_progress(record) for record in await self._store.newest(limit, offset, state))

    async def count(self, state: str | None = None) -> int:
        """How many plans there are."""
        return await self._store.count(state)

    async def scenario_text(self, plan_id: str) -> str:
        """The scenario as it was sent."""
        return await self.library.scenario_text(plan_id)

    async def plan_text(self, plan_id: str) -> str:
        """The plan as GeoJSON text; raises ConflictError while there is none."""
        return await self.library.plan_text(plan_id)

    async def events(self, plan_id: str) -> AsyncGenerator[tuple[str, PlanRecord], None]:
        """The plan as it is now, then at every change, to its end and, of a done one, its bound.

        Each with its name: ``progress``, the end state, ``bound``.
        """
        async with self._hub.listen(plan_id) as queue:
            record = await self.get(plan_id)
            yield _event_of(record), record
            while not record.ended:
                record = await queue.get()
                yield _event_of(record), record
            while plan_id in self._bounder:
                record = await queue.get()
                if record.bounded:
                    yield "bound", record

    async def wait(self, plan_id: str, timeout_s: float) -> PlanRecord:
        """The plan when it has ended, or as it is when the time is over."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(timeout_s):
                async with contextlib.aclosing(self.events(plan_id)) as records:
                    async for _, record in records:
                        if record.ended:
                            return record
        return await self.get(plan_id)

    async def remove(self, plan_id: str) -> PlanRecord | None:
        """Cancel a queued or running plan and answer with it; delete an ended one and answer None."""
        record = await self._store.get(plan_id)
        if await self._store.delete(plan_id):
            self._bounder.drop(plan_id)
            # Who waits for its bound waits for nothing.
            self._hub.publish(plan_id, record)
            return None
        if await self._store.cancel(plan_id):
            if (task := self._running.get(plan_id)) is not None:
                task.cancel()
            PLANS_ENDED.labels(state="cancelled").inc()
            cancelled = await self._announce(plan_id)
            log.info("plan cancelled", plan_id=plan_id)
            return cancelled
        # It ended between the two looks.
        return await self.remove(plan_id)

    def _with_progress(self, record: PlanRecord) -> PlanRecord:
        live = self._live.get(record.id)
        if live is None or record.state != "running":
            return record
        return replace(record, stage=live[0], progress=live[1])

    async def _announce(self, plan_id: str) -> PlanRecord | None:
        try:
            record = await self.get(plan_id)
        except (NotFoundError, StorageError):
            # Of one that cannot be read now its end is told once it is written.
            return None
        self._hub.publish(plan_id, record)
        return record

    async def _settle(self) -> None:
        """Write, as soon as the database takes it, how plans ended that could not be written then."""
        while True:
            await asyncio.sleep(SETTLE_S)
            if self._store.unsettled:
                for plan_id in await self._store.settle():
                    log.warning("plan's end is written now", plan_id=plan_id)
                    await self._announce(plan_id)

    async def _consume(self) -> None:
        while True:
            plan_id = await self._queue.get()
            task = asyncio.create_task(self._run(plan_id))
            self._running[plan_id] = task
            try:
                await asyncio.wait((task,))
                if not task.cancelled() and (error := task.exception()) is not None:
                    await self._give_up(plan_id, error)
            finally:
                self._live.pop(plan_id, None)
                self._running.pop(plan_id, None)
                self._bounder.look()

    async def _give_up(self, plan_id: str, error: BaseException) -> None:
        """A plan that could not be read or written has failed."""
        if isinstance(error, StorageError):
            reason = failure("storage", "The plan could not be kept", str(error))
        else:
            log.error("plan could not be run", plan_id=plan_id, exc_info=error)
            detail = "it could not be run for a reason nobody foresaw; the service's log has the details"
            reason = failure("internal", "Internal error", detail)
        self._live.setdefault(plan_id, (None, 0.0))
        await self._end(plan_id, work.WorkResult(error=reason))

    async def _run(self, plan_id: str) -> None:
        if not await self._store.start(plan_id):
            return
        self._live[plan_id] = (None, 0.0)
        record = await self._announce(plan_id)
        if record is None:
            return
        scenario, _ = await self._store.documents(plan_id)

        def report(stage: str, fraction: float) -> None:
            self._live[plan_id] = (stage, max(fraction, self._live[plan_id][1]))
            self._hub.publish(plan_id, self._with_progress(record))

        started_s = asyncio.get_running_loop().time()
        PLANS_RUNNING.inc()
        try:
            async with progress_pipe(report) as pipe:
                result = await self._attempt(scenario, pipe)
            await self._end(plan_id, result)
        except asyncio.CancelledError:
            if self._stopping:
                await asyncio.shield(self._store.requeue(plan_id))
            raise
        finally:
            PLANS_RUNNING.dec()
            PLANNING_SECONDS.observe(asyncio.get_running_loop().time() - started_s)

    async def _attempt(self, scenario: str, pipe: str) -> work.WorkResult:
        document = _with_rasters(scenario)
        arguments = (scenario, pipe, *self._terrain_of(document))
        return await attempted(self._pool, self._task, arguments, self._time_limit_s)

    async def _end(self, plan_id: str, result: work.WorkResult) -> None:
        if result.plan is not None:
            moved = await self._store.done(plan_id, result.plan, result.summary or {})
            state = "done"
            if moved:
                self._bounder.add(plan_id)
        else:
            stage, progress = self._live[plan_id]
            moved = await self._store.fail(plan_id, result.error or {}, stage, progress)
            state = "failed"
        if moved:
            PLANS_ENDED.labels(state=state).inc()
            log.info("plan ended", plan_id=plan_id, state=state, reason=(result.error or {}).get("detail"))
            await self._announce(plan_id)

    def _room(self) -> bool:
        """Whether a worker is free that no plan waits for."""
        return not self._stopping and len(self._running) + self._queue.qsize() < self._workers

    async def _bound(self, plan_id: str, wanted_path: str) -> bool:
        try:
            scenario, plan = await self._store.documents(plan_id)
        except NotFoundError:
            return True
        document = _with_rasters(scenario)
        arguments = (scenario, plan, wanted_path, *self._terrain_of(document))
        result = await self._pool.run(self._bound_task, arguments, self._time_limit_s)
        if result is not None:
            await self._store.bounded(plan_id, result.plan, result.summary)
        return result is not None

    async def _bounded(self, plan_id: str) -> None:
        await self._announce(plan_id)


def _with_rasters(scenario: str) -> dict[str, Any]:
    """A scenario's document where it may name a raster; a text without the word needs no second parsing."""
    return dict(json.loads(scenario)) if any(f'"{name}"' in scenario for name in RASTERS) else {}


def _event_of(record: PlanRecord) -> str:
    return record.state if record.ended else "progress"
