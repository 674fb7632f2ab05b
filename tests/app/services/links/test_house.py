"""The worker that reads and encodes plans for vehicles."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

from app.services.links.house import ready_for_orders
from app.services.plans import work
from app.services.plans.pool import WorkerPool
from tests.app.services.links.loading import loaded_by_an_upload


async def test_an_order_finds_all_that_it_needs_loaded(plan_file: Path) -> None:
    """A worker ended at its limit begins no order with nothing loaded, and stands behind no other process."""
    pool = WorkerPool(1, partial(work.limited, ready_for_orders, 2_000_000_000, behind=False))
    try:
        loaded, niceness = await pool.run(loaded_by_an_upload, (str(plan_file),), 60.0)
    finally:
        await pool.stop()
    assert loaded == []
    assert niceness <= max(0, os.getpriority(os.PRIO_PROCESS, 0))
