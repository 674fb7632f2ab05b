"""Searches planned from their strips alone: those of all flights moved together, flown, and moved again."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from planner.errors import InfeasibleError
from planner.route import Look
from planner.scenario import Scenario
from planner.search.choose import NOTHING, REFINED, Search
from planner.search.moving.together import Flier, Floats, Strips, Together
from planner.search.programme import Programme
from planner.search.shifted import strip_of
from planner.tasks.budget import MOST, Flight, limits_of, part_used, per_m_of
from planner.tasks.sought import Sought, as_long_as_can_be, flier_of
from planner.tasks.task import Controls
from planner.tasks.worth import scores_at
from planner.vehicle.limits import Use, exceeded

#: What flights truly take is learnt each time that they are flown, then strips are moved anew by so many
#: steps, from these heats by all worth: of each of the best, and of the best of all.
STEPS, FEW, MANY = 20_000, (3e-4, 3e-4), (3e-4, 1e-3, 3e-4, 1e-4)
#: One flight alone is begun so often, from this heat by so many steps; the best so many of what is flown then
#: are moved anew from the next heat by so many, and the best so many of those as above.
BEGUN, FIRST, WARM = 16, 12_000, 4e-3
AGAIN, SECOND, COOL, LAST = 4, 40_000, 2e-3, 2
#: So many seconds of a processor are all of the work, about.
WORK_S = 5.0
#: At first so much of what level flight takes all there is for; or of what is thought to be left.
LEVEL, THOUGHT = 0.8, 1.3


@dataclass(frozen=True, slots=True, eq=False)
class _Tried:
    """Strips flown: what they find, and what each flight may take by estimates as it has told."""

    worth: float
    moving: _Moving
    flights: list[Flight]
    strips: Strips
    learnt_m: list[float]


class _Moving:
    """Strips of searches over the same ground, each looking to one side, moved and flown."""

    def __init__(
        self,
        scenario: Scenario,
        ones: Sequence[Sought],
        looks: Sequence[Look],
        controls: Controls,
        part: float,
    ) -> None:
        self.ones, self._looks = ones, looks
        asked = ones[0].asked
        self._together = Together(
            asked.ground,
            lambda places, cell_m: scores_at(scenario, places, cell_m),
            asked.detection,
            [
                Flier(one.asked.looking, look, one.asked.room, one.asked.pricing)
                for one, look in zip(ones, looks, strict=True)
            ],
        )
        self._flies = [flier_of(one, controls) for one in ones]
        self._controls, self._part, self._seed = controls, part, 1_000 * scenario.seed
        self._number = 0

    def found(self) -> list[Strips]:
        """Strips that find much, from nothing, those that find most first."""
        budgets_m = [_first_m(one) for one in self.ones]
        stop, enough = self._controls.stop, self._controls.enough
        return self._together.found(budgets_m, self._part, self._seed, stop, enough)

    def begun(self, count: int) -> Iterator[Strips]:
        """Strips from nothing, so often."""
        empty = [np.zeros((0, 2, 2)) for _ in self.ones]
        budgets_m = [_first_m(one) for one in self.ones]
        for _ in range(count):
            yield self._moved(empty, budgets_m, FIRST, WARM)

    def _moved(self, strips: Strips, budgets_m: Sequence[float], steps: int, heat: float) -> Strips:
        self._number += 1
        seed, stop, enough = self._seed + 200 + self._number, self._controls.stop, self._controls.enough
        return self._together.moved(strips, budgets_m, int(self._part * steps), seed, heat, stop, enough)[1]

    def known(self, flights: Sequence[Flight]) -> _Tried:
        """Flights that were flown otherwise, their passes as strips."""
        strips = self._together.placed([_strips_of(flight.programme) for flight in flights])
        learnt_m = [
            _learnt_m(cost_m, part_used(one.setting.model.aircraft, flight.use))
            for one, cost_m, flight in zip(self.ones, self._together.costs_m(strips), flights, strict=True)
        ]
        return _Tried(self.worth(flights), self, list(flights), strips, learnt_m)

    def tried(self, strips: Strips) -> _Tried | None:
        """Strips flown; None where that cannot be."""
        costs_m = self._together.costs_m(strips)
        flown = _flown(self.ones, self._together.lines(strips), self._looks, costs_m, self._flies)
        if flown is None:
            return None
        flights, learnt_m = flown
        return _Tried(self.worth(flights), self, flights, strips, learnt_m)

    def better(self, one: _Tried, heats: Sequence[float], steps: int = STEPS) -> _Tried:
        """The best of strips that were flown moved anew, by what their flights have told, from each heat."""
        for heat in heats:
            if self._controls.enough():
                break
            found = self.tried(self._moved(one.strips, one.learnt_m, steps, heat))
            if found is not None and found.worth > one.worth:
                one = found
        return one

    def finds(self, worth: float) -> bool:
        """Whether that is anything of what is looked for."""
        return worth > NOTHING * self._together.total

    def worth(self, flights: Sequence[Flight]) -> float:
        """What flights find together."""
        return self._together.told([sweep for flight in flights for sweep in flight.programme.sweeps])


def moved_together(scenario: Scenario, ones: Sequence[Sought], controls: Controls) -> list[Flight] | None:
    """The flights of searches over the same ground whose strips were moved together, from nothing.

    Returns
    -------
    list
        In their order; None where none of it can be flown by all.
    """
    part = min(1.0, controls.enough.left_s / (WORK_S * max(1.0, len(ones) / 2)))
    moving = _Moving(scenario, ones, [one.asked.looking.looks[0] for one in ones], controls, part)
    with controls.stage("search"):
        begun = moving.found()
    best: _Tried | None = None
    with controls.stage("transit"):
        for strips in begun:
            found = moving.tried(strips)
            if found is not None:
                found = moving.better(found, FEW)
                best = found if best is None or found.worth > best.worth else best
        if best is None or not moving.finds(best.worth):
            return None
        return moving.better(best, MANY).flights


def moved_alone(scenario: Scenario, one: Sought, flown: Flight, controls: Controls) -> Flight:
    """The flight of one search whose strips were moved, from nothing and from those of one that was flown.

    Of a sensor that looks to either side each is tried. The flight that was flown where nothing finds more.
    """
    looks = one.asked.looking.looks
    part = min(1.0, controls.enough.left_s / WORK_S)
    every = {look: _Moving(scenario, [one], [look], controls, part) for look in looks}
    tried: list[_Tried] = []
    with controls.stage("search"):
        for moving in every.values():
            for strips in moving.begun(max(1, BEGUN // len(looks))):
                if controls.enough() and tried:
                    break
                found = moving.tried(strips)
                tried += [] if found is None else [found]
    with controls.stage("transit"):
        best = [*_best_of(tried, AGAIN), every[flown.programme.look].known([flown])]
        best = _best_of([each.moving.better(each, (COOL,), SECOND) for each in best], LAST)
        (last,) = _best_of([each.moving.better(each, FEW) for each in best], 1)
        return last.moving.better(last, MANY).flights[0]


def _best_of(tried: Sequence[_Tried], count: int) -> list[_Tried]:
    """Those that find most."""
    return sorted(tried, key=lambda each: -each.worth)[:count]


def _strips_of(programme: Programme) -> Floats:
    return np.array([strip_of(sweep) for sweep in programme.sweeps])


def _learnt_m(cost_m: float, part: float) -> float:
    """What a flight may take by estimates, as one of so many metres tells that takes a part of a limit."""
    return cost_m * MOST / part if part > 0.0 else math.inf


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
            learnt_m.append(_learnt_m(cost_m, part))
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
