"""Searches planned from their strips alone: those of all flights moved together, flown, and moved again."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from planner.errors import InfeasibleError
from planner.scenario import Scenario
from planner.search.moving.together import COOL, Flier, Strips, Together
from planner.search.programme import Programme
from planner.tasks.budget import MOST, Flight, part_used
from planner.tasks.search import Sought, as_long_as_can_be, flier_of
from planner.tasks.task import Controls
from planner.tasks.worth import scores_at

#: What flights truly take is learnt so often; within so much of what they may take they are long enough.
LEARNT, ENOUGH = 4, 0.985
#: Steps each time.
STEPS = 25_000
#: So many seconds of a processor are all of the work, about.
WORK_S = 6.0


def moved_together(scenario: Scenario, ones: Sequence[Sought], controls: Controls) -> list[Flight] | None:
    """The flights of searches over the same ground whose strips were moved together, from nothing.

    Returns
    -------
    list
        In their order; None where one cannot be flown, or finds nothing.
    """
    asked = ones[0].asked
    fliers = [
        Flier(one.asked.looking, one.asked.looking.looks[0], one.asked.room, one.asked.pricing) for one in ones
    ]
    with controls.stage("search"):
        together = Together(
            asked.ground,
            lambda places, cell_m: scores_at(scenario, places, cell_m),
            asked.detection,
            fliers,
        )
        left_s = controls.enough.left_s
        part = min(1.0, 0.5 * left_s / (WORK_S * max(1, len(ones) / 2)))
        budgets_m = [one.spare.metres for one in ones]
        seed = scenario.seed
        begun = together.found(budgets_m, part, seed, controls.stop, controls.enough)
    flies = [flier_of(one, controls) for one in ones]
    with controls.stage("transit"):
        try:
            for number in range(LEARNT):
                programmes = _programmes(ones, begun, fliers)
                if programmes is None:
                    return None
                budgets_m, parts = _learnt(ones, programmes, flies)
                if all(not math.isfinite(m) or ENOUGH <= p <= MOST for m, p in zip(budgets_m, parts, strict=True)):
                    break
                if number and controls.enough():
                    break
                _, begun = together.moved(
                    begun, budgets_m, int(part * STEPS), seed + 200 + number, COOL, controls.stop,
                    controls.enough,
                )  # fmt: skip
            return _flown(ones, begun, fliers, budgets_m, flies)
        except InfeasibleError:
            # What can be flown is found otherwise.
            return None


def _programmes(ones: Sequence[Sought], begun: Strips, fliers: Sequence[Flier]) -> list[Programme] | None:
    """Programmes that fly strips, all of them; None where there are none."""
    found = []
    for one, strips, flier in zip(ones, begun, fliers, strict=True):
        programme = one.asked.over(strips, flier.look, math.inf) if len(strips) else None
        if programme is None:
            return None
        found.append(programme)
    return found


def _learnt(
    ones: Sequence[Sought], programmes: Sequence[Programme], flies: Sequence[Callable[[Programme], Flight]]
) -> tuple[list[float], list[float]]:
    """What each may take by estimates, as its flight tells, and what part of it its flight takes."""
    budgets_m, parts = [], []
    for one, programme, fly in zip(ones, programmes, flies, strict=True):
        part = part_used(one.setting.model.aircraft, fly(programme).use)
        parts.append(part)
        budgets_m.append(programme.cost_m * MOST / part if part > 0.0 else math.inf)
    return budgets_m, parts


def _flown(
    ones: Sequence[Sought],
    begun: Strips,
    fliers: Sequence[Flier],
    budgets_m: Sequence[float],
    flies: Sequence[Callable[[Programme], Flight]],
) -> list[Flight] | None:
    """The flights over strips, cut to what limits allow."""
    found = []
    for number, one in enumerate(ones):
        programme = one.asked.over(begun[number], fliers[number].look, math.inf)
        if programme is None:
            return None
        budget_m = max(budgets_m[number], programme.cost_m)
        flight = as_long_as_can_be(
            programme, one.asked, budget_m, flies[number], one.setting.model.aircraft
        )
        if flight is None:
            return None
        found.append(flight)
    return found

