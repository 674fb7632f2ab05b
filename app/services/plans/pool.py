"""Killable planning processes: pebble's pool, rebuilt when it breaks."""

from __future__ import annotations

import asyncio
import multiprocessing
from collections.abc import Callable
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from multiprocessing.context import BaseContext
from typing import Any, Protocol

import structlog
from pebble import ProcessExpired, ProcessPool, concurrent

from app.services.plans import work

log = structlog.get_logger(__name__)

PRELOADED = "app.services.plans.preloaded"


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
    preloaded
        Whether they are forked from a process that has loaded the kernels (``preloaded.py``) and does nothing
        else; all such pools of a service share it.
    """

    def __init__(
        self, workers: int, initialiser: Callable[[], None] = work.initialise, *, preloaded: bool = False
    ) -> None:
        self._workers = workers
        self._initialiser = initialiser
        # Never forked from the service itself: a child would inherit its sockets, threads and locks.
        self._context: BaseContext = multiprocessing.get_context("forkserver" if preloaded else "spawn")
        if preloaded:
            self._context.set_forkserver_preload([PRELOADED])
        self._pool = self._build()
        self._begun: Future[Future[int]] | None = None
        self._stopped = False

    def _build(self) -> ProcessPool:
        return ProcessPool(max_workers=self._workers, initializer=self._initialiser, context=self._context)

    def _begin(self) -> Future[Future[int]]:
        """Start the processes where nobody has: in a thread, for they wait for what is preloaded."""
        if self._begun is None:
            self._begun = _started(self._pool)
        return self._begun

    def warm(self) -> None:
        """Start the processes, which load their kernels; see ``ready``."""
        self._begin()

    @property
    def ready(self) -> bool:
        """Whether a process has answered since the pool was built, and the pool still stands."""
        if not self._has_begun or self._begun is None or self._begun.exception() is not None:
            return False
        ping = self._begun.result()
        return ping.done() and ping.exception() is None and bool(self._pool.active)

    @property
    def _has_begun(self) -> bool:
        """Whether the processes have been started; until then pebble keeps whoever asks it for anything."""
        return self._begun is not None and self._begun.done()

    async def mend(self) -> None:
        """Start again what could not be started; build anew what a process killed while idle has broken."""
        if not self._has_begun or self._begun is None or self._stopped:
            return
        if self._begun.exception() is not None:
            self._begun = None
            self.warm()
        elif not self._pool.active:
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
                await self._started()
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

    async def _started(self) -> None:
        try:
            await asyncio.shield(asyncio.wrap_future(self._begin()))
        except (OSError, EOFError) as error:
            self._begun = None
            raise _unstarted(error) from error

    async def _replace(self, broken: ProcessPool, reason: str) -> None:
        # several runs learn of the same broken pool; the first replaces it
        if self._pool is broken:
            log.warning("worker pool rebuilt", reason=reason)
            try:
                self._pool = self._build()
            except OSError as error:
                raise _unstarted(error) from error
            self._begun = None
            self.warm()
            await asyncio.to_thread(_end, broken)

    async def stop(self) -> None:
        """Kill every worker and wait for the end."""
        self._stopped = True
        await asyncio.to_thread(_end, self._pool)


@concurrent.thread
def _started(pool: ProcessPool) -> Future[int]:
    return pool.schedule(work.ping)


def _unstarted(error: Exception) -> WorkerDiedError:
    """No descriptors, no shared memory, nothing to fork from: the next run tries again."""
    reason = getattr(error, "strerror", None) or "what they are forked from has ended"
    return WorkerDiedError(f"no planning process could be started: {reason}")


def _end(pool: ProcessPool) -> None:
    pool.stop()  # type: ignore[no-untyped-call]  # pebble annotates this one method by halves
    pool.join()


def _exit(code: int) -> str:
    return f"signal {-code}" if code < 0 else f"exit code {code}"
