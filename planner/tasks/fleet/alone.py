"""What a job that is thought to fit into no flight takes, flown by itself alone."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from planner.errors import Finding, InfeasibleError
from planner.fleet.assignment import LeftOut, Trip
from planner.scenario import Scenario
from planner.tasks.fleet.barred import BarredError
from planner.tasks.fleet.crews import Crew, not_seen
from planner.tasks.fleet.deciding import decided
from planner.tasks.fleet.flown import over
from planner.tasks.fleet.jobs import Job
from planner.tasks.fleet.placing import Errand
from planner.tasks.fleet.problem import Lessons, problem_of
from planner.tasks.fleet.ways import Ways
from planner.tasks.task import Controls


@dataclass(slots=True)
class Alone:
    """Learns from flights of one job where longer flights have taught too much.

    What a flight over several regions took more than was thought is more than one over one of them will, and
    a part less of the limits besides is twice as careful: what fits would be refused for it, at one limit and
    not at a lower one.

    Parameters
    ----------
    fly
        The flight of a trip over jobs.
    given_up
        What is left out, by region; more is added.
    """

    scenario: Scenario
    controls: Controls
    crews: Sequence[Crew]
    lessons: Lessons
    fly: Callable[[Sequence[Job], Trip], Errand]
    given_up: dict[str, Finding]
    _tried: dict[str, int] = field(default_factory=dict)

    def relearnt(
        self, ways: Mapping[tuple[str, int], Ways], jobs: Sequence[Job], lacking: Sequence[LeftOut]
    ) -> bool:
        """Whether a flight of one that is lacking fits after all: what flights take more is as of that.

        At the second time no less than the limits is planned with, either.
        """
        found = False
        for each in lacking:
            job = jobs[each.target]
            name = job.region.name
            if name in self.lessons.closes_s and self._given_way(jobs, name):
                found = True
                continue
            if self._tried.get(name, 0) == 2 or not (self.lessons.besides_s or self.lessons.spare):
                continue
            again = self._tried[name] = self._tried.get(name, 0) + 1
            problem = problem_of(
                self.crews,
                (job,),
                {key: value for key, value in ways.items() if key[0] == name},
                self.scenario.objective,
                Lessons(closes_s=self.lessons.closes_s, most_s=self.lessons.most_s),
            )
            assigned = decided(problem, self.scenario.method, self.scenario.seed, self.controls)
            if assigned.left_out or len(assigned.trips) != 1:
                continue
            (trip,) = assigned.trips
            try:
                flown = self.fly((job,), trip).flown
            except BarredError:
                continue
            if flown is None or over(self.crews[trip.member], flown):
                continue
            more_s = (
                flown.duration_s - flown.waited_s - (trip.duration_s - sum(v.wait_s for v in trip.visits))
            )
            for number, crew in enumerate(self.crews):
                if crew.kind == self.crews[trip.member].kind:
                    self.lessons.besides_s[number] = min(more_s, self.lessons.besides_s.get(number, more_s))
                    if again == 2:
                        self.lessons.spare.pop(number, None)
            found = True
        return found

    def _given_way(self, jobs: Sequence[Job], name: str) -> bool:
        """Whether another job is left out for one that others make late: the least of those with windows."""
        optional = [job for job in jobs if not job.region.required and job.region.time_window_s is not None]
        if not optional:
            return False
        del self.lessons.closes_s[name]
        least = min(optional, key=lambda job: job.region.priority)
        said = f"leaves no time for {name} within its window, which is to be seen"
        fix = "Let one of the windows close later, add an aircraft, or lower separation"
        self.given_up[least.of] = not_seen(least, InfeasibleError("window", least.of, said, fix))
        return True
