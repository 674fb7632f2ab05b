"""The task ``collect``: see every region, as short as can be."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from planner.airspace.airspace import Level
from planner.airspace.threats import acting
from planner.bounds.allowance import Allowance
from planner.bounds.ways import plan_bound_m
from planner.coverage.strips.located import Located, located
from planner.coverage.strips.room import Room
from planner.coverage.urban.methods import SEQUENCES
from planner.coverage.visible import Seeing
from planner.errors import Finding, InfeasibleError, OutOfBudgetError, nothing_seen
from planner.metrics import used
from planner.photos import too_soon
from planner.plan import Plan
from planner.profile.compose import Composed
from planner.profile.ends import with_run
from planner.progress import AT_ONCE, Progress, Stop, Until, in_time, silent
from planner.publish import Leg
from planner.route import CollectPass
from planner.routing.greedy.route import li2018_route
from planner.routing.joint.route import Search, joint_route
from planner.routing.legs import Legs, anchor
from planner.scenario import Scenario
from planner.tasks.cells import by_cells, left_m2
from planner.tasks.dropped import left_out, over, unseen
from planner.tasks.hidden import Sight, hidden_findings, see_hidden
from planner.tasks.limits import short_of_energy, within_limits
from planner.tasks.mended import mended
from planner.tasks.methods import chosen_methods
from planner.tasks.moving import Moving, in_time_for_photos
from planner.tasks.prizes import Offer
from planner.tasks.rejoined import others
from planner.tasks.setting import Setting, seeing
from planner.tasks.task import NOT_SEEN, Answer, Controls, Task
from planner.tasks.transits import Transits
from planner.tasks.urban import (
    cut_by_obstacles,
    lanes_cut,
    leaves_ground,
    left_of,
    refuse_filled,
    refuse_unseen,
    swept,
    unflown,
)
from planner.vehicle.limits import Use

Passes = tuple[CollectPass, ...]
#: Passes, and what is left out.
Found = tuple[Passes, tuple[Finding, ...]]
#: A whole flight, its legs, and what is to be said of them.
_Flown = tuple[Composed, tuple[Leg, ...], tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class _Flight:
    """Passes with the legs that join them, and what the whole uses."""

    passes: Passes
    dropped: tuple[Finding, ...]
    composed: Composed
    legs: tuple[Leg, ...]
    notes: tuple[str, ...]
    use: Use


def collect(scenario: Scenario, controls: Controls) -> Answer:
    """Passes that see every region, and the legs that join them."""
    setting = Setting.of(scenario)
    methods = chosen_methods(scenario.method)
    asked = seeing(scenario, setting)
    transits = Transits.of(setting, asked.objective, methods)
    sight = Sight.of(asked.regions, setting.suite, setting.airspace, setting.level)

    def fly(names: frozenset[str], progress: Progress, enough: Until) -> _Flight:
        """The flight without some regions."""
        regions = tuple(region for region in asked.regions if region.name not in names)
        with controls.stage("routing"):
            found = _found(
                replace(asked, regions=regions),
                setting,
                methods,
                scenario.seed,
                replace(controls, progress=part_of(progress, 0.0, 0.5), enough=enough),
            )
            try:
                refuse_unseen(asked, *found, sight)
            except InfeasibleError as error:
                if controls.enough():
                    raise _out_of_time(error, scenario) from error
                raise
        told = part_of(progress, 0.5, 0.9)
        now = replace(asked, regions=regions)

        def through(passes: Passes) -> _Flown:
            with controls.stage("transit"):
                return transits.through(passes, told, controls.stop)

        try:
            flown = through(found[0])
        except InfeasibleError:
            if methods["coverage"] in SEQUENCES or methods["routing"] != "joint":
                raise
            rejoined = _rejoined(now, setting, found, scenario.seed, controls, through)
            if rejoined is None:
                raise
            found, flown = rejoined
            refuse_unseen(now, *found, sight)
        found, flown = _in_time(now, setting, found, flown, controls, through)
        composed, legs, notes = flown
        return _Flight(*found, composed, legs, notes, used(composed.flight, setting.model, setting.level))

    def in_haste(names: frozenset[str]) -> _Flight:
        try:
            return fly(names, silent, AT_ONCE)
        except InfeasibleError:
            return fly(names, silent, controls.enough)

    flight, left = within_limits(
        fly(frozenset(), controls.progress, controls.enough),
        lambda names: fly(names, silent, controls.enough),
        in_haste,
        {region.name: region.priority for region in asked.regions if not region.required},
        setting.model.aircraft,
        (scenario.start.position, scenario.end.position),
        partial(_offer, asked, setting, scenario.seed) if methods["routing"] == "joint" else None,
    )
    short = short_of_energy(flight, setting.model.aircraft, (scenario.start.position, scenario.end.position))
    if short is not None:
        raise short
    dropped = flight.dropped + tuple(over(each) for each in left)
    if sight is not None:
        dropped += hidden_findings(sight, flight.passes, by_paper=methods["coverage"] == "li2018")
    return Answer(
        setting,
        flight.composed,
        flight.legs,
        flight.passes,
        methods,
        dropped,
        flight.notes,
        left_out(dropped, left),
    )


def _out_of_time(error: InfeasibleError, scenario: Scenario) -> OutOfBudgetError:
    """What is said where time ended the search for passes that see what sweeps leave."""
    return OutOfBudgetError(
        f"time_budget_s of {scenario.time_budget_s:g} s ended the search for passes that see all of "
        f"{error.feature}; of those found {error.message}. Give it more time, or {error.relaxation}"
    )


def _offer(asked: Seeing, setting: Setting, seed: int) -> Offer | None:
    """What to leave out, where not all regions can be flown to; None where obstacles bar all of its lanes."""
    around = asked.surroundings()
    ends = with_run(setting.ends, setting.level.height_m, setting.model)
    optional = {region.name: region.priority for region in asked.regions if not region.required}
    targets = asked.visible(around).targets
    return Offer.of(targets, around, ends, optional, seed) if targets else None


def bound_m(scenario: Scenario, plan: Plan, stop: Stop, allowance: Allowance) -> float:
    """No plan over the regions that a plan sees is shorter."""
    setting = Setting.of(scenario)
    seen = {name for collect in plan.collects for name in collect.regions}
    left_out = {region.name for region in scenario.regions} - seen
    asked = seeing(scenario, setting)
    route_m = plan.metrics.route_length_m or plan.metrics.length_m
    return plan_bound_m(asked, setting.ends, route_m, left_out, stop, allowance)


def _found(asked: Seeing, setting: Setting, methods: dict[str, str], seed: int, controls: Controls) -> Found:
    """Passes by the routing asked for."""
    if methods["coverage"] in SEQUENCES:
        return swept(asked, setting, methods["coverage"], seed, controls.progress, controls.stop)
    if methods["routing"] != "joint":
        aware = methods["routing"] == "li2018-threat-aware"
        choices = paper_choices(asked, controls.progress, controls.stop, threat_aware=aware)
        return _greedy(choices, asked, setting, seed, controls.progress, controls.stop)
    by_paper = methods["coverage"] == "li2018"
    sight = Sight.of(asked.regions, setting.suite, setting.airspace, setting.level)
    if by_paper or (not lanes_cut(asked) and not cut_by_obstacles(asked)):
        return _joint(asked, setting, seed, None if by_paper else sight, controls)
    if not cut_by_obstacles(asked):
        refuse_filled(asked)
        cells = by_cells(asked, _search(asked, setting, seed, sight, controls), controls.enough)
        if cells and not left_of(asked, cells):
            return cells, ()
        return _joint(asked, setting, seed, sight, controls)
    return _among_obstacles(asked, setting, seed, sight, controls)


def _among_obstacles(
    asked: Seeing, setting: Setting, seed: int, sight: Sight | None, controls: Controls
) -> Found:
    """Lanes over cells of the open ground, or sweeps round what cuts it, whichever tour is shorter.

    Where both leave ground unseen, lanes across all of it if those leave none; else what leaves least.

    Raises
    ------
    InfeasibleError
        Where there are none of these.
    """
    refuse_filled(asked)
    try:
        found: Found | None = swept(asked, setting, "auto", seed, controls.progress, controls.stop)
    except InfeasibleError:
        found = None
    search = _search(asked, setting, seed, None, controls)
    until = (controls.stop, controls.enough)

    def in_lanes(stop: Stop) -> Found:
        known = found is not None or cells is not None
        return _joint(asked, setting, seed, sight, replace(controls, stop=stop), told=not known)

    moving = Moving(asked, search.legs, (anchor(search.ends[0]), anchor(search.ends[1])))

    def whole(passes: Passes) -> Found:
        """With passes for what they leave, where some see it: of those that transits join."""
        if not left_of(asked, passes):
            return passes, ()
        if passes and math.isinf(search.legs.tour_m(passes)):
            passes = moving.joined(passes) or passes
        passes = mended(moving, passes, controls.stop)
        return passes, left_of(asked, passes)

    if found is not None and found[0] and leaves_ground(found[1]):
        passes, left = whole(found[0])
        found = passes, _unseen_regions(found[1], passes) + left
    # What sweeps see is an answer: anything else is to be better in time.
    laid = by_cells(asked, search, controls.enough, needed=found is None)
    cells = whole(laid) if laid else None
    if found is None and cells is None:
        # Passes one by one, for as much of it as they see.
        passes, left = whole(())
        found = (passes, unflown(asked, passes) + left) if passes else None
    if cells is not None and not cells[1]:
        shorter = found is not None and search.legs.tour_m(cells[0]) <= search.legs.tour_m(found[0])
        if found is None or leaves_ground(found[1]) or shorter:
            return cells
    if found is not None and not leaves_ground(found[1]):
        return found
    try:
        lanes = in_lanes(controls.stop) if found is None and cells is None else in_time(in_lanes, *until)
    except InfeasibleError:
        if found is None and cells is None:
            raise
        lanes = None
    if lanes is not None and (found is None or not lanes[1]):
        return lanes
    if cells is not None and (found is None or left_m2(asked, cells[0]) < left_m2(asked, found[0])):
        return cells
    assert found is not None
    return found


def _unseen_regions(findings: tuple[Finding, ...], passes: Passes) -> tuple[Finding, ...]:
    """Of what was said of other passes what is of regions that none of these sees either."""
    over = {name for each in passes for name in each.regions}
    unseen = (each for each in findings if each.rule.startswith(NOT_SEEN))
    return tuple(each for each in unseen if not over.issuperset(each.feature.split("+")))


def _rejoined(
    asked: Seeing,
    setting: Setting,
    found: Found,
    seed: int,
    controls: Controls,
    through: Callable[[Passes], _Flown],
) -> tuple[Found, _Flown] | None:
    """Sweeps that transits join instead of those found, which they do not: those that see most.

    None where there are none.
    """
    with controls.stage("routing"):
        known = sorted(others(asked, setting, found[0], seed, controls), key=lambda each: each[:2])
    for *_, passes in known:
        try:
            flown = through(passes)
        except InfeasibleError:
            continue
        return _refound(asked, found, passes), flown
    return None


def _in_time(
    asked: Seeing,
    setting: Setting,
    found: Found,
    flown: _Flown,
    controls: Controls,
    through: Callable[[Passes], _Flown],
) -> tuple[Found, _Flown]:
    """With passes moved on which photos came too soon, where fewer do then."""
    moved = in_time_for_photos(asked, setting, found[0], flown[0], controls)
    if moved is None:
        return found, flown
    try:
        again = through(moved)
    except InfeasibleError:
        return found, flown
    before, after = (
        too_soon(setting.suite, composed, passes)
        for composed, passes in ((flown[0], found[0]), (again[0], moved))
    )
    return (_refound(asked, found, moved), again) if len(after) < len(before) else (found, flown)


def _refound(asked: Seeing, found: Found, passes: Passes) -> Found:
    """Other passes, with what is to be said of them, and what was said of regions not seen at all."""
    return passes, _unseen_regions(found[1], passes) + left_of(asked, passes)


def _joint(
    asked: Seeing,
    setting: Setting,
    seed: int,
    sight: Sight | None,
    controls: Controls,
    *,
    told: bool = True,
) -> Found:
    search = _search(asked, setting, seed, sight, controls)
    share = partial(asked.sharing, around=search.around)
    visible = partial(asked.visible, search.around, enough=controls.enough, told=told)
    found = joint_route(search, visible(), visible, share)
    return found.route.passes, found.seen.dropped


def _search(asked: Seeing, setting: Setting, seed: int, sight: Sight | None, controls: Controls) -> Search:
    around = asked.surroundings()
    ends = with_run(setting.ends, setting.level.height_m, setting.model)
    legs = Legs(setting.airspace, setting.level, setting.model, asked.objective, ends, controls.stop)

    def complete(passes: Passes, legs: Legs) -> Passes:
        if sight is None:
            return passes
        at = partial(asked.at, around=around)
        return see_hidden(sight, at, ends, passes, legs, controls.stop)

    watched = (controls.progress, controls.stop, controls.enough)
    return Search(ends, around, legs, seed, complete, *watched)


def paper_choices(asked: Seeing, progress: Progress, stop: Stop, *, threat_aware: bool) -> Located:
    """What the paper's choices are among.

    Parameters
    ----------
    threat_aware
        Also leave out, wherever there is another, choices whose line enters a soft threat or that leave no
        room to turn outside of one. The paper leaves threats out here (its section 6, relaxation 4).
    """
    rooms: dict[Level, Room] = {}

    def room_at(level: Level) -> Room:
        if level not in rooms:
            rooms[level] = Room.of(
                asked.airspace, level, asked.model, asked.objective, threat_aware=threat_aware
            )
        return rooms[level]

    where = (asked.airspace, asked.level)
    return located(asked.regions, asked.suite, *where, room_at, part_of(progress, 0.0, 0.8), stop)


def _greedy(
    found: Located, asked: Seeing, setting: Setting, seed: int, progress: Progress, stop: Stop
) -> Found:
    threats = acting(asked.airspace.threats, asked.level.height_m)
    ends, routing = setting.ends, part_of(progress, 0.8, 1.0)
    route, _ = li2018_route(found.choices, threats, asked.objective, ends, seed, routing, stop)
    if not route.passes:
        raise nothing_seen(found.dropped)
    return route.passes, tuple(unseen(error) for error in found.dropped)


def part_of(progress: Progress, low: float, high: float) -> Progress:
    """Progress of one stage as a part of the whole."""

    def report(stage: str, fraction: float) -> None:
        progress(stage, low + (high - low) * min(max(fraction, 0.0), 1.0))

    return report


COLLECT = Task(collect, bound_m)
