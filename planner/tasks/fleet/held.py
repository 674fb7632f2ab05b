"""Flights whose missions are held: which have too many items, and what one battery has for several."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from planner.errors import Finding
from planner.profile.items import EACH_FLIGHT, too_many
from planner.tasks.fleet.crews import Crew
from planner.tasks.fleet.flown import Flown, items_in
from planner.tasks.fleet.placing import Sortie
from planner.tasks.fleet.problem import Lessons, trips_of
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import Excess, Use, exceeded


def together(flown: Sequence[Flown]) -> Use:
    """What flights use, all of them."""
    energies = [each.use.energy_wh for each in flown if each.use.energy_wh is not None]
    return Use(
        math.fsum(each.use.length_m for each in flown),
        math.fsum(each.use.duration_s for each in flown),
        math.fsum(energies) if energies else None,
    )


def over_together(crews: Sequence[Crew], sorties: Sequence[Sortie]) -> dict[int, Excess]:
    """By the number of a crew, the limit that its flights are over together where one battery is for all."""
    own: dict[int, list[Flown]] = {}
    for sortie in sorties:
        own.setdefault(sortie.flown.crew, []).append(sortie.flown)
    found = {}
    for number, flown in own.items():
        aircraft = crews[number].aircraft
        if len(flown) > 1 and aircraft.batteries == 1 and (excess := exceeded(aircraft, together(flown))):
            found[number] = excess[0]
    return found


def held_part(crew: Crew, flown: Flown) -> float:
    """The part of its time that a flight may last for its mission to be held; 1 and more where it is held.

    What it takes to its first job, and home from its last, every flight takes, and has but few items for.
    """
    most, count = crew.aircraft.most_items, items_in(crew, flown)
    spans_s = flown.spans_s or ((0.0, flown.duration_s),)
    work_s = max(end_s for _, end_s in spans_s) - min(begin_s for begin_s, _ in spans_s)
    share = max(most - EACH_FLIGHT, 1) / max(count - EACH_FLIGHT, 1)
    return 1.0 - (1.0 - share) * work_s / flown.duration_s if count > most else 1.0


def shorten(crews: Sequence[Crew], sorties: Sequence[Sortie], lessons: Lessons, part: float) -> bool:
    """Teach that flights are to be shorter which have too many items and can be two; whether any is.

    Parameters
    ----------
    part
        Of what they may last they are to last.
    """
    long = False
    for sortie in sorties:
        crew = crews[sortie.flown.crew]
        held = held_part(crew, sortie.flown)
        if held < 1.0 and trips_of(crew.aircraft) > 1:
            lessons.shorten(sortie.flown.crew, sortie.flown.duration_s, part * held)
            long = True
    return long


def too_many_items(crews: Sequence[Crew], flown: Flown) -> Iterator[Finding]:
    """What is said of a flight whose mission its autopilot does not hold."""
    aircraft = crews[flown.crew].aircraft
    count = items_in(crews[flown.crew], flown)
    if count > aircraft.most_items:
        yield too_many(aircraft.name, count, aircraft.most_items, why_one(aircraft))


def why_one(aircraft: Aircraft) -> str:
    """What stands in the way of several flights instead of one; nothing where that is not known."""
    if aircraft.aloft is not None:
        return "it flies already, and goes on in one flight"
    if aircraft.finish not in ("auto", "land"):
        return f"its finish is {aircraft.finish}, and a next one takes off from where it has landed"
    limits = (
        ("max_range_m", aircraft.max_range_m),
        ("max_flight_time_s", aircraft.max_flight_time_s),
        ("energy_wh", aircraft.energy_wh),
    )
    told = ", ".join(f"{name} {limit:g}" for name, limit in limits if limit is not None)
    if aircraft.batteries > 1 or not told:
        return ""
    return f"its one battery ({told}) is for all of its flights, and none were found that it lasts for"
