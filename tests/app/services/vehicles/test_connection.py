"""Links opened and given up."""

from __future__ import annotations

import asyncio
import gc
from typing import Any

import pytest

from app.services.vehicles.connection import connect
from tests.patience import PATIENCE_S


@pytest.mark.parametrize("times", [1, 2, 3])
async def test_giving_up_while_nothing_is_heard_leaves_nothing_behind(times: int) -> None:
    """However often it is cancelled, also while it closes: no task stays, no failure goes unheard."""
    said: list[dict[str, Any]] = []
    asyncio.get_running_loop().set_exception_handler(lambda _, context: said.append(context))
    before = asyncio.all_tasks()
    opening = asyncio.create_task(connect("udpin:127.0.0.1:0", None, 600.0))
    # The link's driver, who waits for a heartbeat, and who waits for another aircraft's.
    async with asyncio.timeout(PATIENCE_S):
        while len(asyncio.all_tasks() - before) < 4:
            await asyncio.sleep(0.001)
    for _ in range(times):
        opening.cancel()
        await asyncio.sleep(0)
    with pytest.raises(asyncio.CancelledError):
        await opening
    async with asyncio.timeout(PATIENCE_S):
        while left := asyncio.all_tasks() - before:
            await asyncio.wait(left)
    del opening
    gc.collect()
    await asyncio.sleep(0)
    assert said == []
