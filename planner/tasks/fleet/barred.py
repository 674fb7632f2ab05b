"""What no flight of an aircraft leads to, found where a flight that was assigned cannot be flown."""

from __future__ import annotations

from collections.abc import Sequence

from planner.errors import InfeasibleError
from planner.fleet.assignment import LeftOut as Unassigned
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import in_best_order
from planner.tasks.fleet.jobs import Job
from planner.tasks.task import Controls


class BarredError(Exception):
    """A flight that cannot be flown: whose, its jobs, and why."""

    def __init__(self, crew: int, jobs: Sequence[tuple[Job, int]], why: InfeasibleError) -> None:
        super().__init__(crew, why)
        self.crew, self.jobs, self.why = crew, tuple(jobs), why


def barred(crew: Crew, refused: BarredError, controls: Controls) -> dict[str, InfeasibleError]:
    """Those jobs of a flight that its aircraft cannot do even by themselves, by their names, and why."""
    if len(refused.jobs) == 1:
        return {refused.jobs[0][0].region.name: refused.why}
    found: dict[str, InfeasibleError] = {}
    for job, visit in refused.jobs:
        try:
            in_best_order(crew, refused.crew, [(job, visit)], controls)
        except InfeasibleError as error:
            found[job.region.name] = error
    return found


def infeasible(jobs: Sequence[Job], lacking: Unassigned) -> InfeasibleError:
    """What is said of a required job that was not assigned."""
    job = jobs[lacking.target]
    return InfeasibleError(lacking.limit, job.of, lacking.message, lacking.relaxation)
