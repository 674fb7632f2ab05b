"""The task ``search``: see as much ground, or importance, as the energy allows, and end at the end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from planner.errors import InfeasibleError
from planner.scenario import Scenario
from planner.search.choose import PUBLISHED, REFINED, Search
from planner.search.programme import Programme
from planner.tasks.budget import MOST, Flight, part_used
from planner.tasks.leftover import filled
from planner.tasks.sought import Sought, as_long_as_can_be, flier_of, unranked
from planner.tasks.spare import cut_off, out_of_reach, refuse_worthless
from planner.tasks.strips import moved_alone
from planner.tasks.task import Answer, Controls, Task
from planner.vehicle.aircraft import Aircraft

#: So many of the best programmes are flown.
FLOWN = 6
#: The best flight is improved so often, for so much more at least.
MOST_IMPROVED, LEAST_BETTER = 3, 1e-3
#: So many flights that cannot be flown are tried before the search is refused for them.
MOST_REFUSED = 24
#: Where strips are moved then, patterns are laid in this part of the time that there is.
PATTERNS = 0.3
#: All that there is to be found, but for this.
ALL = 1e-6


def search(scenario: Scenario, controls: Controls) -> Answer:
    """The flight that sees most, and ends at the end with its reserve."""
    moved = scenario.method.search in ("auto", REFINED) and scenario.importance.drift is None
    if not moved:
        return answer_to(sought(scenario, controls), controls)
    one = sought(scenario, replace(controls, enough=controls.enough.part(PATTERNS)), refined=False)
    with controls.stage("transit"):
        best = _best(one, flier_of(one, controls), controls)
    if best.programme.worth < (1.0 - ALL) * one.asked.total:
        best = moved_alone(scenario, one, best, controls)
    return answer_with(one, _filled(one, best, controls))


def sought(
    scenario: Scenario, controls: Controls, *, as_before: bool = False, refined: bool = True
) -> Sought:
    """What one aircraft may fly, that which sees most first.

    Parameters
    ----------
    as_before
        Leaves it what it was still to fly alone.
    refined
        Whether the best of it are refined, too.

    Raises
    ------
    InfeasibleError
        Where it can see nothing, or not come to its end.
    """
    one = unranked(scenario, controls)
    with controls.stage("search"):
        controls.progress("search", 0.0)
        ranked = one.asked.going_on() if as_before else one.asked.ranked(one.spare.metres, refined=refined)
    return replace(one, ranked=tuple(ranked))


def answer_to(one: Sought, controls: Controls, *, improved: bool = True) -> Answer:
    """The best of what was ranked, flown as long as the limits allow, and improved then.

    Raises
    ------
    InfeasibleError
        Where none of it can be flown.
    """
    asked, fly = one.asked, flier_of(one, controls)
    with controls.stage("transit"):
        best = _best(one, fly, controls)
        if improved and asked.family in (None, REFINED) and best.programme.family not in PUBLISHED:
            best = _improved(best, asked, fly, one.setting.model.aircraft, controls)
            best = _filled(one, best, controls)
    return answer_with(one, best)


def _filled(one: Sought, best: Flight, controls: Controls) -> Flight:
    """With passes over what is left unseen."""
    return filled(best, one.asked, flier_of(one, controls), one.setting.model.aircraft, controls.enough)


def answer_with(one: Sought, best: Flight) -> Answer:
    """The answer that a flight is."""
    methods = one.transits.methods | {"search": best.programme.family}
    notes = (*best.notes, *cut_off(one.asked, one.setting.ends[0].name))
    return Answer(one.setting, best.composed, best.legs, best.passes, methods, (), notes)


def _best(one: Sought, fly: Callable[[Programme], Flight], controls: Controls) -> Flight:
    """The best programmes flown, each as long as the limits allow; the one that sees most."""
    best: Flight | None = None
    refused: InfeasibleError | None = None
    flown = barred = 0
    aircraft = one.setting.model.aircraft
    # Of flights that hardly reach the ground more is thought than they take: some are flown all the same.
    for lay in (lambda: one.ranked, one.asked.nearest):
        for programme in lay():
            if flown >= FLOWN or (best is not None and controls.enough()):
                break
            controls.progress("transit", flown / FLOWN)
            try:
                found = as_long_as_can_be(programme, one.asked, one.spare.metres, fly, aircraft)
            except InfeasibleError as error:
                refused, barred = error, barred + 1
                if barred >= MOST_REFUSED:
                    break
                continue
            flown += 1
            if found is None or not one.asked.finds(found.programme.worth):
                continue
            if best is None or found.programme.worth > best.programme.worth:
                best = found
        if best is not None:
            return best
        flown = barred = 0
    if refused is not None:
        raise refused
    refuse_worthless(one.asked, one.setting.ends[0].name)
    raise out_of_reach(one.transits, one.asked, one.spare, controls.stop)


def _improved(
    best: Flight,
    asked: Search,
    fly: Callable[[Programme], Flight],
    aircraft: Aircraft,
    controls: Controls,
) -> Flight:
    """The best flight's strips moved each by itself for as long as what is then flown sees more."""
    for _ in range(MOST_IMPROVED):
        if controls.enough():
            break
        # What was left over is given to the passes.
        budget_m = best.programme.cost_m * max(1.0, MOST / max(part_used(aircraft, best.use), 1e-9))
        better = asked.shifted(best.programme, budget_m)
        if better.worth <= best.programme.worth * (1.0 + LEAST_BETTER):
            break
        try:
            found = as_long_as_can_be(better, asked, budget_m, fly, aircraft)
        except InfeasibleError:
            break
        if found is None or found.programme.worth <= best.programme.worth:
            break
        best = found
    return best


SEARCH = Task(search, None)
