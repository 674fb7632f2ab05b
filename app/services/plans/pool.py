"""Killable planning processes: pebble's pool, rebuilt when it breaks."""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Protocol

import structlog
from pebble import ProcessExpired, ProcessPool

from app.services.plans import work

log = structlog.get_logger(__name__)


class WorkerDiedError(RuntimeError):
    """The process ended in the middle of its work."""


class Pool(Protocol):
    """Where plans are made."""

    def warm(self) -> None:
        """Get ready, without waiting for it."""

    @property
    def ready(self) -> bool:
        """Whether plans can be made at once."""

    async def mend(self) -> None:
        """Begin anew where it is broken."""

    async def run(self, function: Callable[..., Any], args: tuple[Any, ...], timeout_s: float) -> Any:
        """The result of a function; TimeoutError after a time, WorkerDiedError when its process ended."""

    async def stop(self) -> None:
        """End what runs."""


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
        self._warm: Future[int] | None = None
        self._stopped = False

    def _build(self) -> ProcessPool:
        # spawn: a forked child would inherit the service's sockets, threads and locks
        return ProcessPool(
            max_workers=self._workers,
            initializer=self._initialiser,
            context=multiprocessing.get_context("spawn"),
        )

    def warm(self) -> None:
        """Start the processes, which compile their kernels; see ``ready``."""
        self._warm = self._pool.schedule(work.ping)

    @property
    def ready(self) -> bool:
        """Whether a process has answered since the pool was built, and the pool still stands."""
        answered = self._warm is not None and self._warm.done() and self._warm.exception() is None
        return answered and bool(self._pool.active)

    async def mend(self) -> None:
        """Build the pool anew where a process that was killed while idle has broken it."""
        if self._warm is not None and not self._pool.active and not self._stopped:
            await self._replace(self._pool, "a process ended while it had nothing to do")

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
            pool = self._pool
            try:
                return await asyncio.wrap_future(pool.schedule(function, args=args, timeout=timeout_s))
            except ProcessExpired as error:
                raise WorkerDiedError(f"the planning process ended with {_exit(error.exitcode)}") from error
            except (BrokenProcessPool, RuntimeError) as error:
                # A worker killed while idle leaves pebble's pool broken for good.
                broken = isinstance(error, BrokenProcessPool) or not pool.active
                if not broken or self._stopped:
                    raise
                await self._replace(pool, str(error))
                if attempt == 2:
                    raise WorkerDiedError("no planning process could be started") from error
        raise AssertionError("unreachable")

    async def _replace(self, broken: ProcessPool, reason: str) -> None:
        # several runs learn of the same broken pool; the first replaces it
        if self._pool is broken:
            log.warning("worker pool rebuilt", reason=reason)
            try:
                self._pool = self._build()
                self.warm()
            except OSError as error:
                # No descriptors, no shared memory: the next run tries again.
                raise WorkerDiedError(f"no planning process could be started: {error.strerror}") from error
            await asyncio.to_thread(_end, broken)

    async def stop(self) -> None:
        """Kill every worker and wait for the end."""
        self._stopped = True
        await asyncio.to_thread(_end, self._pool)


def _end(pool: ProcessPool) -> None:
    pool.stop()  # type: ignore[no-untyped-call]  # pebble annotates this one method by halves
    pool.join()


def _exit(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"
