"""Work of requests in processes of their own: results, refusals, limits of time and memory."""

from __future__ import annotations

import asyncio
import math
from collections.abc import AsyncIterator
from functools import partial

import pytest

from app.services.desk import Desk
from app.services.errors import NotFoundError, RefusedError
from app.services.plans import work
from app.services.plans.pool import WorkerPool
from tests.app import fakes

MEMORY_BYTES = 300_000_000


@pytest.fixture
async def desk() -> AsyncIterator[Desk]:
    """One worker, with little time and memory."""
    pool = WorkerPool(1, partial(work.limited, fakes.no_warm_up, MEMORY_BYTES))
    yield Desk(pool, time_limit_s=3.0)
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
