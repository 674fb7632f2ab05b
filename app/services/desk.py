"""What requests compute, beside planning: in processes of their own, with limits of time and memory.

The service's own process holds the links to the vehicles; nothing a request sends may keep it from them.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any, Final, NoReturn, TypeVar

from app.services.errors import ClientGoneError, OverloadedError, RefusedError, ServiceError
from app.services.plans.pool import Pool, WorkerDiedError
from app.services.presence import LEFT
from planner.errors import Finding

Made = TypeVar("Made")

#: So many requests wait for each process; more are told to come again, after so long.
WAITING_EACH, RETRY_AFTER_S = 16, 2

#: What helps where a request itself is too large.
LESS: Final = "send less at once: fewer or simpler shapes, a smaller raster, a shorter flight."


@dataclass(frozen=True, slots=True)
class _Outcome:
    """What a worker answers: a value, a refusal, or that there was not memory enough."""

    value: Any = None
    refusal: ServiceError | None = None
    no_memory: bool = False


def _carried_out(function: Callable[..., Any], arguments: tuple[Any, ...]) -> _Outcome:
    """In the worker: the function, its refusals as values."""
    try:
        return _Outcome(function(*arguments))
    except ServiceError as refusal:
        return _Outcome(refusal=refusal)
    except MemoryError:
        return _Outcome(no_memory=True)


class Desk:
    """Work of requests.

    Parameters
    ----------
    pool
        Where it is done.
    workers
        How many processes the pool has. One is kept for what is urgent, where there are several.
    time_limit_s
        The longest one request may take, and the longest it waits for its turn.
    """

    def __init__(self, pool: Pool, workers: int, time_limit_s: float) -> None:
        self.pool = pool
        self._time_limit_s = time_limit_s
        self._turns = asyncio.Semaphore(max(1, workers - 1))
        self._most_waiting = WAITING_EACH * workers
        self._waiting = 0

    async def run(
        self, feature: str, function: Callable[..., Made], *arguments: Any, urgent: bool = False
    ) -> Made:
        """The result of a function in a process that can be killed.

        Parameters
        ----------
        feature
            What is worked on, as a refusal names it: ``scenario``, ``file``, ``terrain``, ``flight``.
        urgent
            Whether an operator's order to a vehicle waits for it: it does not wait behind other requests.

        Raises
        ------
        ServiceError
            What the function raises.
        RefusedError
            Rules ``time-limit`` and ``memory-limit``: it takes more than a request may; ``worker-died``.
        OverloadedError
            Too many wait before it.
        ClientGoneError
            Whoever asked has gone; the process is killed.
        """
        if urgent:
            return await self._done(feature, function, arguments)
        if self._waiting >= self._most_waiting:
            raise OverloadedError("too many requests are being worked on; try again later", RETRY_AFTER_S)
        self._waiting += 1
        try:
            async with asyncio.timeout(self._time_limit_s):
                await _while_wanted(self._turns.acquire())
        except TimeoutError:
            raise OverloadedError("other requests take too long; try again later", RETRY_AFTER_S) from None
        finally:
            self._waiting -= 1
        try:
            return await self._done(feature, function, arguments)
        finally:
            self._turns.release()

    async def _done(self, feature: str, function: Callable[..., Made], arguments: tuple[Any, ...]) -> Made:
        try:
            working = self.pool.run(_carried_out, (function, arguments), self._time_limit_s)
            outcome = await _while_wanted(working)
        except TimeoutError:
            _refuse(
                feature,
                "time-limit",
                f"it takes longer than {self._time_limit_s:g} s to work on",
                "Try again when this computer is less busy, or have more allowed "
                f"(SWATHPLAN_REQUEST_TIME_LIMIT_S), or {LESS}",
            )
        except WorkerDiedError as error:
            message = f"{error} while it was worked on"
            fix = "Send it again; where that ends the same way, send less at once."
            finding = Finding(feature, "worker-died", message, fix)
            raise RefusedError(f"the {feature} was not worked on: {message}", (finding,)) from error
        assert isinstance(outcome, _Outcome)
        if outcome.no_memory:
            _refuse(
                feature, "memory-limit", "it takes more memory than a request may have", LESS.capitalize()
            )
        if outcome.refusal is not None:
            raise outcome.refusal
        made: Made = outcome.value
        return made


async def _while_wanted(working: Coroutine[Any, Any, Made]) -> Made:
    """What a coroutine gives; it is cancelled, and ClientGoneError raised, when the client leaves."""
    left = LEFT.get()
    if left is None:
        return await working
    work, leaving = asyncio.create_task(working), asyncio.create_task(left.wait())
    try:
        await asyncio.wait((work, leaving), return_when=asyncio.FIRST_COMPLETED)
        if work.done():
            return work.result()
        raise ClientGoneError("nobody waits for the answer any more")
    finally:
        for task in (work, leaving):
            task.cancel()
        await asyncio.gather(work, leaving, return_exceptions=True)


def _refuse(feature: str, rule: str, message: str, fix: str) -> NoReturn:
    raise RefusedError(f"the {feature} is refused: {message}", (Finding(feature, rule, message, fix),))
