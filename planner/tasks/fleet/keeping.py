"""The order that is being flown, kept by a plan made in flight unless another is better by so much."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from planner.errors import InfeasibleError
from planner.fleet.assignment import Assignment
from planner.fleet.kept import kept
from planner.fleet.problem import Problem
from planner.fleet.schedule import worth_of_all
from planner.scenario import Scenario
from planner.tasks.fleet.answer import answer_of
from planner.tasks.fleet.crews import Crew, ways_of
from planner.tasks.fleet.deciding import decided
from planner.tasks.fleet.flights import in_given_order
from planner.tasks.fleet.flown import over
from planner.tasks.fleet.jobs import Job, jobs_of
from planner.tasks.fleet.problem import Lessons, problem_of
from planner.tasks.methods import chosen_methods
from planner.tasks.task import Answer, Controls
from planner.tasks.urban import cut_by_obstacles, lanes_cut
from planner.wishes import GoingOn


def kept_or(
    going_on: GoingOn | None, crews: Sequence[Crew], jobs: Sequence[Job], problem: Problem, free: Assignment
) -> Assignment:
    """The assignment that keeps the order being flown, or the free one where it is better by so much."""
    if going_on is None or not going_on.order:
        return free
    found = kept(problem, _orders(going_on.order, crews, jobs))
    if found is None or _lacks(found) > _lacks(free):
        return free
    worth = worth_of_all(problem)
    better = free.cost + worth < (1.0 - going_on.unless_better) * (found.cost + worth)
    return free if better and _lacks(found) >= _lacks(free) else found


def _lacks(assignment: Assignment) -> int:
    return sum(each.required for each in assignment.left_out)


def _orders(
    order: Mapping[str, Sequence[str]], crews: Sequence[Crew], jobs: Sequence[Job]
) -> dict[int, list[int]]:
    """Numbers of jobs by the number of the crew; parts of a region follow each other with its first."""
    found: dict[int, list[int]] = {}
    taken: set[int] = set()
    for number, crew in enumerate(crews):
        found[number] = []
        for name in order.get(crew.aircraft.name, ()):
            own = [k for k, job in enumerate(jobs) if job.of == name and k not in taken]
            found[number] += own
            taken.update(own)
    return found


def kept_alone(scenario: Scenario, controls: Controls) -> Answer | None:
    """The flight of one aircraft that keeps the order being flown, or the one that is better by so much.

    Both are compared by the ways and times that fleets are assigned by, and flown in the order so found. What
    asks for more than the best pass or sweep over each region in turn, or cannot be seen, is planned freely.
    """
    going_on, aircraft = scenario.going_on, scenario.aircraft[0]
    methods = chosen_methods(scenario.method)
    plain = methods["routing"] == "joint" and methods["coverage"] == "sweeps" and scenario.terrain is None
    if going_on is None or aircraft.name not in going_on.order or not plain:
        return None
    try:
        crew = Crew.of(scenario, aircraft)
        if lanes_cut(crew.asked) or cut_by_obstacles(crew.asked):
            return None
        jobs = jobs_of(scenario.regions, {})
        with controls.stage("routing"):
            ways, _ = ways_of((crew,), jobs)
            if any((job.region.name, 0) not in ways for job in jobs):
                return None
            problem = problem_of((crew,), jobs, ways, scenario.objective, Lessons())
            free = decided(problem, scenario.method, scenario.seed, controls)
            found = kept_or(going_on, (crew,), jobs, problem, free)
        if found.left_out or len(found.trips) != 1:
            return None
        order = [(jobs[visit.target], 0) for visit in found.trips[0].visits]
        flown = in_given_order(crew, 0, order, controls)
    except InfeasibleError:
        # Whatever it is, the free plan says it, or knows better.
        return None
    return None if over(crew, flown) else answer_of(crew, flown)
