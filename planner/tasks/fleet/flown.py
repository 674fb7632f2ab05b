"""One flight of one aircraft: its jobs and passes, what it uses, and what its mission comes to."""

from __future__ import annotations

from dataclasses import dataclass

from planner.profile.compose import Composed
from planner.profile.items import items_of
from planner.publish import Leg
from planner.route import CollectPass, Terminal
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.jobs import Job
from planner.vehicle.limits import Excess, Use, exceeded


@dataclass(frozen=True, slots=True)
class Order:
    """Passes in a given order of jobs, and which job each is of."""

    passes: tuple[CollectPass, ...]
    of: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Flown:
    """One flight, times from its lift-off.

    Parameters
    ----------
    crew, jobs
        Number of the crew; its jobs in flight order, with the visit that each is.
    composed, legs, passes
        As ``Answer`` has them, by the names that were asked for.
    order
        Its passes by the names of the jobs.
    spans_s
        Of each job, when it begins and ends.
    waited_s
        Of its time in circles.
    ends
        Where it starts and ends; None for its crew's.
    """

    crew: int
    jobs: tuple[tuple[Job, int], ...]
    composed: Composed
    legs: tuple[Leg, ...]
    passes: tuple[CollectPass, ...]
    notes: tuple[str, ...]
    spans_s: tuple[tuple[float, float], ...]
    use: Use
    methods: dict[str, str]
    order: Order
    waited_s: float = 0.0
    ends: tuple[Terminal, Terminal] | None = None

    @property
    def duration_s(self) -> float:
        """Of all phases."""
        return self.composed.flight.duration_s


def over(crew: Crew, flown: Flown) -> tuple[Excess, ...]:
    """The limits that a flight is over."""
    return exceeded(crew.setting.model.aircraft, flown.use)


def items_in(crew: Crew, flown: Flown) -> int:
    """How many items the mission of a flight has at most."""
    return items_of(flown.composed.flight, len(flown.passes), crew.aircraft)
