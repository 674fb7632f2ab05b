"""The answer to an assignment problem: trips with their times, what was left out and why."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Status = Literal["optimal", "feasible", "infeasible"]
Limit = Literal[
    "sensor",  # no aircraft can fly any of its alternatives
    "reach",  # no way there, or none home
    "window",
    "shift",
    "flight-time",
    "range",
    "energy",
    "revisit",
    "not-worth",  # nothing binds: it costs more than it is worth
]


@dataclass(frozen=True, slots=True)
class Visit:
    """One target done once.

    Parameters
    ----------
    target, alternative
        Positions in the problem, the latter among the target's.
    number
        Which of the target's visits, from 0 in order of time.
    arrival_s, wait_s, start_s, end_s
        At the entry; waiting there in the air; the service.
    """

    target: int
    alternative: int
    number: int
    arrival_s: float
    wait_s: float
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class Trip:
    """One flight of one aircraft, base to base.

    ``member`` and the bases are positions in the problem; ``length_m``, ``energy_wh`` and ``risk`` are of
    travel, waiting and services together.
    """

    member: int
    start_base: int
    end_base: int
    take_off_s: float
    landing_s: float
    visits: tuple[Visit, ...]
    length_m: float
    energy_wh: float
    risk: float

    @property
    def duration_s(self) -> float:
        """In the air."""
        return self.landing_s - self.take_off_s


@dataclass(frozen=True, slots=True)
class LeftOut:
    """A target, or one visit of it, that is not done.

    Parameters
    ----------
    target
        Position in the problem.
    name, required
        As the problem has them.
    limit
        What binds at the nearest to doing it.
    margin
        By how much that limit would have to give, in ``unit``; infinity where no amount helps.
    unit
        ``s``, ``m``, ``Wh``, or empty.
    aircraft
        Whose limit it is; empty when it is the target's own.
    message, relaxation
        The same in words; the nearest change that would help.
    """

    target: int
    name: str
    required: bool
    limit: Limit
    margin: float
    unit: str
    aircraft: str
    message: str
    relaxation: str


@dataclass(frozen=True, slots=True)
class Assignment:
    """Who does what, when.

    Parameters
    ----------
    trips
        By aircraft, then by time.
    left_out
        What is not done; a required target among them makes the status ``infeasible``.
    status
        ``optimal`` when proved so, ``feasible``, ``infeasible``.
    cost
        The objective's value of these trips.
    bound
        No assignment of the same targets' worth costs less; None when none was asked for.
    """

    trips: tuple[Trip, ...]
    left_out: tuple[LeftOut, ...]
    status: Status
    cost: float
    bound: float | None = None
