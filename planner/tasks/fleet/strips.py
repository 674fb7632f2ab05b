"""Searches planned from their strips alone: those of all flights moved together, flown, and moved again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from planner.errors import InfeasibleError
from planner.route import Look
from planner.scenario import Scenario
from planner.search.choose import REFINED, Search
from planner.search.moving.together import Flier, Floats, Strips, Together
from planner.search.programme import Programme
from planner.tasks.budget import MOST, Flight, limits_of, part_used, per_m_of
from planner.tasks.search import Sought, as_long_as_can_be, flier_of
from planner.tasks.task import Controls
from planner.tasks.worth import scores_at
from planner.vehicle.limits import Use, exceeded

#: What flights truly take is learnt each time that they are flown, then strips are moved anew by so many
#: steps, from these heats by all worth: of each of the best, and of the best of all.
STEPS, FEW, MANY = 20_000, (3e-4, 3e-4), (3e-4, 1e-3, 3e-4, 1e-4)
#: So many seconds of a processor are all of the work, about.
WORK_S = 5.0
#: At first so much of what level flight takes all there is for; or of what is thought to be left.
LEVEL, THOUGHT = 0.8, 1.3


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """Strips flown: what they find, and what each flight may take by estimates as it has told."""

    worth: float
    flights: list[Flight]
    strips: Strips
    learnt_m: list[float]


def moved_together(scenario: Scenario, ones: Sequence[Sought], controls: Controls) -> list[Flight] | None:
    """The flights of searches over the same ground whose strips were moved together, from nothing.

    Returns
    -------
    list
        In their order; None where none of it can be flown by all.
    """
    asked, seed = ones[0].asked, scenario.seed
    looks = [one.asked.looking.looks[0] for one in ones]
    together = Together(
        asked.ground,
        lambda places, cell_m: scores_at(scenario, places, cell_m),
        asked.detection,
        [
            Flier(o.asked.looking, look, o.asked.room, o.asked.pricing)
            for o, look in zip(ones, looks, strict=True)
        ],
    )
    part = min(1.0, controls.enough.left_s / (WORK_S * max(1.0, len(ones) / 2)))
    budgets_m = [_first_m(one) for one in ones]
    with controls.stage("search"):
        begun = together.found(budgets_m, part, seed, controls.stop, controls.enough)
    flies = [flier_of(one, controls) for one in ones]
    number = 0

    def tried(strips: Strips) -> _Tried | None:
        costs_m = together.costs_m(strips)
        flown = _flown(ones, together.lines(strips), looks, costs_m, flies)
        if flown is None:
            return None
        flights, learnt_m = flown
        worth = asked.found([sweep.nominal for flight in flights for sweep in flight.programme.sweeps])
        return _Tried(worth, flights, strips, learnt_m)

    def better(one: _Tried, heats: Sequence[float]) -> _Tried:
        nonlocal number
        for heat in heats:
            if controls.enough():
                break
            number += 1
            _, strips = together.moved(
                one.strips, one.learnt_m, int(part * STEPS), 1_000 * seed + 200 + number, heat, controls.stop,
                controls.enough,
            )  # fmt: skip
            found = tried(strips)
            if found is not None and found.worth > one.worth:
                one = found
        return one

    best: _Tried | None = None
    with controls.stage("transit"):
        for strips in begun:
            found = tried(strips)
            if found is not None:
                found = better(found, FEW)
                best = found if best is None or found.worth > best.worth else best
        if best is None or not asked.finds(best.worth):
            return None
        return better(best, MANY).flights


def _first_m(one: Sought) -> float:
    """What a flight may take by estimates before one has been flown."""
    aircraft, level = one.setting.model.aircraft, one.setting.level
    per_m = per_m_of(aircraft, level.amsl_m)
    limits = limits_of(aircraft, Use(0.0, 0.0, 0.0))
    whole_m = [limit / per_m[name] for name, (_, limit, _) in limits.items() if per_m[name] > 0.0]
    level_m = LEVEL * min(whole_m, default=math.inf)
    if not math.isfinite(level_m):
        return one.spare.metres
    # What is thought hangs on how the ground is drawn, and what is flown tells better.
    return level_m if THOUGHT * one.spare.metres > 0.5 * level_m else 0.5 * level_m


def _flown(
    ones: Sequence[Sought],
    lines: Strips,
    looks: Sequence[Look],
    costs_m: Sequence[float],
    flies: Sequence[Callable[[Programme], Flight]],
) -> tuple[list[Flight], list[float]] | None:
    """The flights over strips, cut to what limits allow, and what each may take by estimates, as they tell.

    None where one cannot be flown.
    """
    flights, learnt_m = [], []
    for one, strips, look, cost_m, fly in zip(ones, lines, looks, costs_m, flies, strict=True):
        programme = _over(one.asked, strips, look)
        if programme is None:
            return None
        aircraft = one.setting.model.aircraft
        try:
            flight = fly(programme)
            part = part_used(aircraft, flight.use)
            learnt_m.append(cost_m * MOST / part if part > 0.0 else math.inf)
            if part > MOST or exceeded(aircraft, flight.use):
                cut = as_long_as_can_be(programme, one.asked, programme.cost_m, fly, aircraft)
                if cut is None:
                    return None
                flight = cut
        except InfeasibleError:
            # What can be flown is found otherwise.
            return None
        flights.append(flight)
    return flights, learnt_m


def _over(asked: Search, strips: Floats, look: Look) -> Programme | None:
    """The programme that flies all of some strips; None where nothing of them can be flown."""
    sweeps = tuple(asked.sweeps_over(strips, look)) if len(strips) else ()
    if not sweeps:
        return None
    worth, cost_m = asked.found(sweeps), asked.pricing.cost_m(sweeps)
    return Programme(REFINED, sweeps, worth, cost_m, sweeps, False, strips, look)
