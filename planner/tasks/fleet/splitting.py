"""A mission with more items than its autopilot holds, flown in several flights instead of one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.scenario import Scenario
from planner.tasks.fleet.answer import FleetAnswer
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flights import Flown, by_passes, items_in
from planner.tasks.fleet.placing import Sortie
from planner.tasks.task import Answer, Controls
from planner.vehicle.limits import Use, exceeded

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
        if exceeded(aircraft, _together(flown)):
            return None
        if all(items_in(crew, each) <= aircraft.most_items for each in flown):
            return FleetAnswer(
                (crew,), _in_turn(flown), answer.methods, answer.dropped, answer.left_out, scenario.kept_apart
            )
    return None


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


def _together(flown: Sequence[Flown]) -> Use:
    """What flights use, all of them."""
    energies = [each.use.energy_wh for each in flown if each.use.energy_wh is not None]
    return Use(
        math.fsum(each.use.length_m for each in flown),
        math.fsum(each.use.duration_s for each in flown),
        math.fsum(energies) if energies else None,
    )
