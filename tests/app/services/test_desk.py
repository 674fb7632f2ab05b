"""Work of requests in processes of their own: results, refusals, limits of time and memory."""

from __future__ import annotations

import asyncio
import math
from collections.abc import AsyncIterator
from functools import partial

import pytest

from app.services.desk import WAITING_EACH, Desk
from app.services.errors import ClientGoneError, NotFoundError, OverloadedError, RefusedError
from app.services.plans import work
from app.services.plans.pool import WorkerPool
from app.services.presence import LEFT
from tests.app import fakes
from tests.patience import PATIENCE_S

MEMORY_BYTES = 300_000_000


@pytest.fixture
async def desk() -> AsyncIterator[Desk]:
    """One worker, with little time and memory."""
    pool = WorkerPool(1, partial(work.limited, fakes.no_warm_up, MEMORY_BYTES))
    yield Desk(pool, workers=1, time_limit_s=3.0)
    await pool.stop()


async def test_results_and_refusals_come_back_whole(desk: Desk) -> None:
    """A value is handed on; a refusal is raised here with all it said there."""
    assert await desk.run("figure", math.hypot, 3.0, 4.0) == 5.0
    with pytest.raises(RefusedError, match="no") as refused:
        await desk.run("scenario", fakes.refusing)
    (finding,) = refused.value.findings
    assert (finding.feature, finding.rule, finding.fix) == ("R1", "a-rule", "mend it")
    with pytest.raises(NotFoundError) as missed:
        await desk.run("scenario", fakes.missing)
    assert (missed.value.kind, missed.value.name) == ("terrain", "T")


async def test_what_takes_too_long_is_stopped(desk: Desk) -> None:
    """It is refused by name, meanwhile the service goes on, and the next request is answered."""
    ticks = 0

    async def tick() -> None:
        nonlocal ticks
        while True:
            ticks += 1
            await asyncio.sleep(0.01)

    ticking = asyncio.create_task(tick())
    with pytest.raises(RefusedError) as refused:
        await desk.run("scenario", fakes.endless)
    ticking.cancel()
    assert [finding.rule for finding in refused.value.findings] == ["time-limit"]
    # Held up all the time there would be two or three.
    assert ticks > 20
    assert await desk.run("figure", math.sqrt, 4.0) == 2.0


async def test_what_takes_too_much_memory_is_refused(desk: Desk) -> None:
    """It is refused by name, and less than the limit is not."""
    assert await desk.run("file", fakes.greedy, MEMORY_BYTES // 4) == MEMORY_BYTES // 4
    with pytest.raises(RefusedError) as refused:
        await desk.run("file", fakes.greedy, 4 * MEMORY_BYTES)
    assert [finding.rule for finding in refused.value.findings] == ["memory-limit"]
    assert await desk.run("figure", math.sqrt, 4.0) == 2.0


async def test_what_is_urgent_waits_behind_nobody() -> None:
    """With others' endless work in the pool an order is answered; too many waiting are told to come again."""
    pool = WorkerPool(2, partial(work.limited, fakes.no_warm_up, MEMORY_BYTES))
    desk = Desk(pool, workers=2, time_limit_s=20.0)
    try:
        others = [asyncio.create_task(desk.run("scenario", fakes.endless)) for _ in range(3)]
        assert await desk.run("plan", math.sqrt, 9.0, urgent=True) == 3.0
        assert not any(other.done() for other in others)
        others += [asyncio.create_task(desk.run("scenario", fakes.endless)) for _ in range(2 * WAITING_EACH)]
        await asyncio.sleep(0)
        with pytest.raises(OverloadedError):
            await desk.run("scenario", math.sqrt, 9.0)
        for other in others:
            other.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        # Those who went away hold no turn.
        assert await desk.run("scenario", math.sqrt, 16.0) == 4.0
    finally:
        await pool.stop()


async def test_a_worker_that_dies_is_not_taken_for_a_large_file(desk: Desk) -> None:
    """The refusal names what happened, and the next request is answered."""
    with pytest.raises(RefusedError) as refused:
        await desk.run("file", fakes.dying)
    assert [finding.rule for finding in refused.value.findings] == ["worker-died"]
    assert await desk.run("figure", math.sqrt, 4.0) == 2.0


async def test_a_client_that_leaves_ends_its_work() -> None:
    """The process is killed at once, a wait for a turn ends, and who stays behind gets the turn."""
    pool = WorkerPool(1, fakes.no_warm_up)
    desk = Desk(pool, workers=1, time_limit_s=60.0)
    left = asyncio.Event()
    token = LEFT.set(left)
    endless = asyncio.create_task(desk.run("scenario", fakes.endless))
    waiting = asyncio.create_task(desk.run("scenario", fakes.endless))
    LEFT.reset(token)
    behind = asyncio.create_task(desk.run("figure", math.sqrt, 4.0))
    await asyncio.sleep(0)
    left.set()
    for task in (endless, waiting):
        with pytest.raises(ClientGoneError):
            await task
    async with asyncio.timeout(PATIENCE_S):
        assert await behind == 2.0
    await pool.stop()
