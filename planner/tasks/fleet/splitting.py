"""A mission with more items than its autopilot holds, flown in several flights instead of one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from planner.errors import InfeasibleError
from planner.fleet.assignment import Trip
from planner.profile.items import TOO_MANY
from planner.route import CollectPass
from planner.scenario import Scenario
from planner.tasks.fleet.answer import FleetAnswer
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import by_passes
from planner.tasks.fleet.flown import Flown, items_in
from planner.tasks.fleet.held import over_together, together, too_many_items
from planner.tasks.fleet.placing import Errand, LateError, Sortie, placed
from planner.tasks.task import Answer, Controls
from planner.vehicle.limits import exceeded

#: Start and end no further apart than this are one place.
ONE_PLACE_M = 1.0
#: From a landing to the next take-off, at least: the next mission goes up meanwhile.
PAUSE_S = 5.0


def in_sorties(scenario: Scenario, answer: Answer, count: int, controls: Controls) -> FleetAnswer | None:
    """A flight in several, each with no more items than are held; None where there are none.

    The passes stay, and their order; about as many go to each flight. What one battery has is for all of them
    together. Each flight ends where the whole is to end, and the next one starts there. Flights are not split
    that begin in the air, or end circling.

    Parameters
    ----------
    count
        Items of the one flight.
    """
    aircraft = scenario.aircraft[0]
    if aircraft.aloft is not None or aircraft.finish not in ("auto", "land"):
        return None
    several = replace(aircraft, batteries=len(answer.passes))
    crew = Crew.of(replace(scenario, aircraft=(several,)), several)
    behind = crew
    if math.dist(scenario.start.position, scenario.end.position) > ONE_PLACE_M:
        behind = crew.between((scenario.end, scenario.end))
    for flights in range(math.ceil(count / aircraft.most_items), len(answer.passes) + 1):
        try:
            first, *others = _dealt(answer.passes, flights)
            flown = [by_passes(crew, 0, first, controls)]
            flown += [by_passes(behind, 0, some, controls) for some in others]
        except InfeasibleError:
            return None
        if exceeded(aircraft, together(flown)):
            return None
        if all(items_in(crew, each) <= aircraft.most_items for each in flown):
            return FleetAnswer(
                (crew,), _in_turn(flown), answer.methods, answer.dropped, answer.left_out, scenario.kept_apart
            )
    return None


def with_more_flights(answer: FleetAnswer, controls: Controls, seed: int) -> FleetAnswer:
    """Flights of several aircraft, those with too many items in several, one battery for all of each.

    As ``in_sorties``, and put on one clock anew. What is flown at given times stays one flight, and all stays
    as it is where that is not to be had.
    """
    crews = answer.crews
    errands: list[Errand] = []
    for sortie in answer.sorties:
        flown, start_s = sortie.flown, sortie.start_s
        if _is_timed(flown):
            errands.append(Errand(_trip(flown, start_s), flown.jobs, order=flown.order, ends=flown.ends))
            continue
        parts = _parts(crews[flown.crew], flown, controls)
        for number, each in enumerate(parts):
            errands.append(Errand(_trip(each, start_s + number), each.jobs, each, ends=each.ends))
    if len(errands) == len(answer.sorties):
        return answer
    try:
        with controls.stage("separation"):
            sorties = placed(crews, errands, answer.separation, controls, seed)
    except (InfeasibleError, LateError):
        return answer
    if over_together(crews, sorties):
        return answer
    told = [finding for each in sorties for finding in too_many_items(crews, each.flown)]
    before = [finding for finding in answer.dropped if finding.rule != TOO_MANY]
    return replace(answer, sorties=sorties, dropped=(*before, *told))


def _is_timed(flown: Flown) -> bool:
    """Whether something binds when a flight is flown."""
    return flown.waited_s > 0.0 or any(job.is_timed for job, _ in flown.jobs)


def _parts(crew: Crew, flown: Flown, controls: Controls) -> tuple[Flown, ...]:
    """A flight in several that are held and that its one battery lasts for; as it is where there are none."""
    aircraft = crew.aircraft
    count, free = items_in(crew, flown), crew.aircraft.batteries == 1 and aircraft.aloft is None
    if count <= aircraft.most_items or not free:
        return (flown,)
    first = crew.between(flown.ends or crew.setting.ends)
    end = first.setting.ends[1]
    behind = first.between((end, end))
    for flights in range(math.ceil(count / aircraft.most_items), len(flown.passes) + 1):
        try:
            begun, *others = _dealt(flown.passes, flights)
            parts = [by_passes(first, flown.crew, begun, controls)]
            parts += [by_passes(behind, flown.crew, some, controls) for some in others]
        except InfeasibleError:
            return (flown,)
        if exceeded(aircraft, together(parts)):
            return (flown,)
        if all(items_in(crew, each) <= aircraft.most_items for each in parts):
            return tuple(parts)
    return (flown,)


def _trip(flown: Flown, from_s: float) -> Trip:
    """As it would have been assigned: flights of one aircraft follow each other by when they take off."""
    use = flown.use
    until_s = from_s + flown.duration_s
    return Trip(flown.crew, 0, 0, from_s, until_s, (), use.length_m, use.energy_wh or 0.0, 0.0)


def _dealt(passes: Sequence[CollectPass], flights: int) -> list[tuple[CollectPass, ...]]:
    """Passes in so many runs of about as many each."""
    ends = [round(len(passes) * number / flights) for number in range(flights + 1)]
    return [tuple(passes[ends[number] : ends[number + 1]]) for number in range(flights)]


def _in_turn(flown: Sequence[Flown]) -> tuple[Sortie, ...]:
    """Each once the one before is down."""
    sorties: list[Sortie] = []
    for number, each in enumerate(flown, 1):
        sorties.append(Sortie(each, sorties[-1].end_s + PAUSE_S if sorties else 0.0, number))
    return tuple(sorties)
