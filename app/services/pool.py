"""Killable planning processes: pebble's pool, rebuilt when it breaks."""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any

import structlog
from pebble import ProcessExpired, ProcessPool

from app.services import work

log = structlog.get_logger(__name__)


class WorkerDiedError(RuntimeError):
    """The process ended in the middle of its work."""


class WorkerPool:
    """Runs functions in processes that can be killed without harm to the service.

    Parameters
    ----------
    workers
        How many.
    initialiser
        Called once in each new process.
    """

    def __init__(self, workers: int, initialiser: Callable[[], None] = work.initialise) -> None:
        self._workers = workers
        self._initialiser = initialiser
        self._pool = self._build()

    def _build(self) -> ProcessPool:
        # spawn: a forked child would inherit the service's sockets, threads and locks
        return ProcessPool(
            max_workers=self._workers,
            initializer=self._initialiser,
            context=multiprocessing.get_context("spawn"),
        )

    def warm(self) -> Future[int]:
        """Start the processes; done when the first has its kernels compiled."""
        future: Future[int] = self._pool.schedule(work.ping)
        return future

    async def run(self, function: Callable[..., Any], args: tuple[Any, ...], timeout_s: float) -> Any:
        """Run a function in a worker; cancelling this kills the worker.

        Raises
        ------
        TimeoutError
            The limit passed; the worker has been killed.
        WorkerDiedError
            The worker ended by itself, with the exit code in the text.
        """
        for attempt in (1, 2):
            try:
                return await asyncio.wrap_future(self._pool.schedule(function, args=args, timeout=timeout_s))
            except ProcessExpired as error:
                raise WorkerDiedError(f"the planning process ended with {_exit(error.exitcode)}") from error
            except (BrokenProcessPool, RuntimeError) as error:
                # A worker killed while idle leaves pebble's pool broken for good.
                if attempt == 2 or not self._broken(error):
                    raise
                log.warning("worker pool rebuilt", reason=str(error))
                await self._rebuild()
        raise AssertionError("unreachable")

    def _broken(self, error: BaseException) -> bool:
        return isinstance(error, BrokenProcessPool) or not self._pool.active

    async def _rebuild(self) -> None:
        broken, self._pool = self._pool, self._build()
        await asyncio.to_thread(_end, broken)

    async def stop(self) -> None:
        """Kill every worker and wait for the end."""
        await asyncio.to_thread(_end, self._pool)


def _end(pool: ProcessPool) -> None:
    pool.stop()  # type: ignore[no-untyped-call]  # pebble annotates this one method by halves
    pool.join()


def _exit(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"
