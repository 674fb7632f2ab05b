"""Planning processes are forked from one that has loaded what they need."""

from __future__ import annotations

import os
import signal
import sys
from concurrent.futures import Future

import pytest

from app.services.plans.pool import WorkerDiedError, WorkerPool
from tests.app import fakes


def begun_with() -> tuple[bool, int, int]:
    """Whether the kernels' loader is there, which process this is, and which it was forked from."""
    return "planner.warm" in sys.modules, os.getpid(), os.getppid()


async def test_who_follows_a_dead_worker_has_its_kernels_at_once() -> None:
    """Neither loads anything; where the process that they are forked from dies, another takes its place."""
    pool = WorkerPool(1, fakes.no_warm_up, preloaded=True)
    try:
        loaded, first, origin = await pool.run(begun_with, (), 60.0)
        assert loaded
        assert origin not in (os.getpid(), first)
        with pytest.raises(WorkerDiedError):
            await pool.run(fakes.dying, (), 60.0)
        loaded, second, same = await pool.run(begun_with, (), 60.0)
        assert (loaded, same) == (True, origin)
        assert second != first
        os.kill(origin, signal.SIGKILL)
        with pytest.raises(WorkerDiedError):
            await pool.run(fakes.dying, (), 60.0)
        loaded, _, other = await pool.run(begun_with, (), 60.0)
        assert loaded
        assert other != origin
    finally:
        await pool.stop()


async def test_what_could_not_be_started_is_started_again() -> None:
    """Nor does asking whether it is ready fail meanwhile."""
    pool = WorkerPool(1, fakes.no_warm_up)
    failed: Future[Future[int]] = Future()
    failed.set_exception(OSError(24, "too many open files"))
    pool._begun = failed
    try:
        assert not pool.ready
        await pool.mend()
        assert pool._begun is not failed
        assert await pool.run(os.getpid, (), 60.0) != os.getpid()
    finally:
        await pool.stop()
