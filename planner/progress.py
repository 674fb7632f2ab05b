"""Reporting progress and being stopped, as parameters."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeVar

from planner.errors import CancelledError

T = TypeVar("T")

Clock = Callable[[], float]


class Progress(Protocol):
    """Receives the stage at work and the fraction done of the whole plan."""

    def __call__(self, stage: str, fraction: float) -> None:
        """Take one report; ``fraction`` runs from 0 to 1 and never falls."""


class Stop(Protocol):
    """Says whether to stop; asked between steps. Any clock lives with the caller."""

    def __call__(self) -> bool:
        """True to stop."""


def silent(stage: str, fraction: float) -> None:
    """Drop the report."""


def never() -> bool:
    """Go on."""
    return False


def raise_if(stop: Stop) -> None:
    """Raise CancelledError once ``stop`` says so."""
    if stop():
        raise CancelledError("planning was cancelled")


@dataclass(frozen=True, slots=True)
class Until:
    """Whether the search for anything better has had its time; never without a clock.

    Parameters
    ----------
    end_s
        On the clock.
    """

    clock: Clock | None = None
    end_s: float = math.inf

    def __call__(self) -> bool:
        """True once it has."""
        return self.clock is not None and self.clock() > self.end_s

    @property
    def comes(self) -> bool:
        """Whether there is such a time."""
        return self.clock is not None and math.isfinite(self.end_s)

    @property
    def left_s(self) -> float:
        """How long until then; inf without such a time."""
        if self.clock is None or not self.comes:
            return math.inf
        return max(self.end_s - self.clock(), 0.0)

    def part(self, share: float) -> Until:
        """The same for a part of the time that is left."""
        if self.clock is None or not self.comes:
            return self
        now_s = self.clock()
        return Until(self.clock, now_s + share * max(self.end_s - now_s, 0.0))


#: No search for anything better.
AT_ONCE = Until(lambda: 1.0, 0.0)


def in_time(make: Callable[[Stop], T], stop: Stop, enough: Stop) -> T | None:
    """What may turn out better than what is at hand; None where time ends it before it is done.

    Parameters
    ----------
    make
        Makes it, asking the stop that it is given between steps.
    stop, enough
        The one cancels planning; the other ends the search for anything better.
    """
    if enough():
        return None
    try:
        return make(lambda: stop() or enough())
    except CancelledError:
        raise_if(stop)
        return None
