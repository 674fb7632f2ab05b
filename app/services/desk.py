"""What requests compute, beside planning: in processes of their own, with limits of time and memory.

The service's own process holds the links to the vehicles; nothing a request sends may keep it from them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NoReturn, TypeVar

from app.services.errors import RefusedError, ServiceError
from app.services.plans.pool import Pool, WorkerDiedError
from planner.errors import Finding

Made = TypeVar("Made")


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
    time_limit_s
        The longest one request may take.
    """

    def __init__(self, pool: Pool, time_limit_s: float) -> None:
        self.pool = pool
        self._time_limit_s = time_limit_s

    async def run(self, feature: str, function: Callable[..., Made], *arguments: Any) -> Made:
        """The result of a function in a process that can be killed.

        Parameters
        ----------
        feature
            What is worked on, as a refusal names it: ``scenario``, ``file``, ``terrain``, ``flight``.

        Raises
        ------
        ServiceError
            What the function raises.
        RefusedError
            Rules ``time-limit`` and ``memory-limit``: it takes more than a request may.
        """
        try:
            outcome = await self.pool.run(_carried_out, (function, arguments), self._time_limit_s)
        except TimeoutError:
            _refuse(feature, "time-limit", f"it takes longer than {self._time_limit_s:g} s to work on")
        except WorkerDiedError as error:
            _refuse(feature, "memory-limit", f"it takes more memory than a request may have ({error})")
        assert isinstance(outcome, _Outcome)
        if outcome.no_memory:
            _refuse(feature, "memory-limit", "it takes more memory than a request may have")
        if outcome.refusal is not None:
            raise outcome.refusal
        made: Made = outcome.value
        return made


def _refuse(feature: str, rule: str, message: str) -> NoReturn:
    fix = "Send less at once: fewer or simpler shapes, a smaller raster, a shorter flight."
    raise RefusedError(f"the {feature} is refused: {message}", (Finding(feature, rule, message, fix),))
