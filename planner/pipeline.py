"""make_plan: the task picked by name, its answer published, bounded, and judged."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from shapely.geometry import LineString, MultiLineString
from shapely.geometry.base import BaseGeometry

from planner.bounds.allowance import Allowance
from planner.check import judge
from planner.check.edge import near_edge
from planner.errors import Finding, InfeasibleError, OutOfBudgetError
from planner.metrics import measure
from planner.pace import LEAST_PART, ROUNDS, slower_for_photos, slower_passes
from planner.photos import too_soon
from planner.plan import LeftOut, Plan, Violation
from planner.profile.items import items_of, too_many
from planner.progress import Clock, Progress, Stop, Until, never, silent
from planner.publish import Chart, assemble, fence, uncovered
from planner.replanned import replanned
from planner.scenario import Scenario
from planner.tasks.methods import chosen_methods
from planner.tasks.registry import task_of
from planner.tasks.task import Answer, Controls
from planner.together import Part, together
from planner.version import __version__

if TYPE_CHECKING:
    from planner.tasks.fleet.answer import FleetAnswer

#: The search for better routes ends after this part of the scenario's time budget.
ROUTING_SHARE = 0.6

#: What planning takes at least, in lines between cells of the bound, a third of a microsecond each: by the
#: paper's stages for a pass or region; by the joint routing for a visit, for one more that shares its pass,
#: for each leg of a corridor beyond its visits, and for other passes beyond visits, up to so many, each and
#: by the square of how many they are.
LINES_BY_PAPER, LINES_VISIT, LINES_SHARED, LINES_LEG = 30_000, 70_000, 50_000, 400_000
LINES_FURTHER, MOST_FURTHER = (40_000, 15_000), 8
#: A search that breaks one of these is refused.
BARRING = ("area", "hard-zone", "clearance")
#: The bound is looked for in this part of the work for plan and bound together at most.
BOUND_SHARE = 0.3


@dataclass(slots=True)
class _Stopwatch:
    """Seconds by stage, on the caller's clock; nothing without one."""

    clock: Clock | None
    seconds: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        began = self.clock() if self.clock else 0.0
        yield
        if self.clock:
            self.seconds[name] = round(self.seconds.get(name, 0.0) + self.clock() - began, 6)


def make_plan(
    scenario: Scenario,
    progress: Progress = silent,
    stop: Stop = never,
    clock: Clock | None = None,
) -> Plan:
    """Plan a scenario.

    Parameters
    ----------
    scenario
        From ``planner.geojson.read_scenario``.
    progress
        Takes the stage at work and the fraction done.
    stop
        Asked between steps; planning ends with CancelledError once it says True.
    clock
        Seconds, for ``metrics.planning_time_s`` and the scenario's time budget; without a budget the same
        scenario gives the same plan whatever it says.

    Raises
    ------
    InfeasibleError
        With the constraint, the feature and the nearest relaxation.
    """
    watch = _Stopwatch(clock)
    enough = _budget(clock, scenario.time_budget_s)
    controls = Controls(progress, stop, enough, watch.stage)
    if scenario.task in ("collect", "search") and scenario.is_fleet:
        return _fleet_plan(scenario, controls, watch)
    answer = _kept(scenario, controls) or task_of(scenario.task).answer(scenario, controls)
    scenario, answer = _paced(scenario, answer, controls)
    setting = answer.setting
    aircraft = setting.model.aircraft
    count, why = items_of(answer.composed.flight, len(answer.passes), aircraft), ""
    # A paper's order, asked for by name, stays one flight: it is held against others' for its length.
    if scenario.task == "collect" and count > aircraft.most_items and answer.methods["routing"] == "joint":
        from planner.tasks.fleet.held import why_one
        from planner.tasks.fleet.splitting import in_sorties

        several = in_sorties(scenario, answer, count, controls)
        if several is not None:
            return _of_several(scenario, several, controls, watch)
        why = why_one(scenario.aircraft[0])
    if count > aircraft.most_items:
        told = too_many(aircraft.name, count, aircraft.most_items, why)
        answer = replace(answer, dropped=(*answer.dropped, told))
    chart = Chart(scenario.frame, setting.level)
    with watch.stage("publish"):
        draft = _draft(scenario, chart, answer)
    return _judged(scenario, draft, chart, answer.dropped, answer.left_out, controls, watch)


def _paced(scenario: Scenario, answer: Answer, controls: Controls) -> tuple[Scenario, Answer]:
    """Flown so slowly that no photo comes too soon; as it was, where that is not to be had."""
    passes_alone = slower_passes(answer)
    if passes_alone is not None:
        return scenario, passes_alone
    tried, found = scenario, answer
    for _ in range(ROUNDS):
        slower = slower_for_photos(tried, found)
        if slower is None or slower.aircraft[0].airspeed_m_s < LEAST_PART * scenario.aircraft[0].airspeed_m_s:
            break
        try:
            found = _kept(slower, controls) or task_of(slower.task).answer(slower, controls)
        except (InfeasibleError, OutOfBudgetError):
            break
        tried = slower
        if not too_soon(found.setting.suite, found.composed, found.passes):
            return tried, found
    return scenario, answer


def _kept(scenario: Scenario, controls: Controls) -> Answer | None:
    """The order that is being flown, where it is to be kept."""
    if scenario.task != "collect" or scenario.going_on is None or not scenario.going_on.order:
        return None
    from planner.tasks.fleet.keeping import kept_alone

    return kept_alone(scenario, controls)


def _draft(scenario: Scenario, chart: Chart, answer: Answer) -> Plan:
    """The plan of one flight, not yet judged."""
    setting = answer.setting
    start, end = setting.ends
    direct_m = math.dist(start.position, end.position)
    return assemble(
        scenario.name,
        chart,
        setting.model,
        setting.airspace,
        setting.suite,
        setting.ends,
        answer.composed,
        answer.legs,
        answer.passes,
        metrics=measure(
            answer.composed.flight,
            answer.passes,
            setting.model,
            setting.airspace,
            setting.level,
            direct_m,
        ),
        methods=answer.methods,
        planner_version=__version__,
        scenario_hash=scenario.scenario_hash,
        seed=scenario.seed,
        warnings=tuple(str(f) for f in (*scenario.warnings, *answer.dropped)) + answer.notes,
    )


def _judged(
    scenario: Scenario,
    draft: Plan,
    chart: Chart,
    dropped: Sequence[Finding],
    left_out: tuple[LeftOut, ...],
    controls: Controls,
    watch: _Stopwatch,
) -> Plan:
    """A draft with its verdict."""
    controls.progress("check", 0.95)
    with watch.stage("check"):
        verdict = judge(scenario, draft)
        near = tuple(str(finding) for finding in near_edge(scenario, draft))
    if scenario.task == "search":
        _refuse_barred(scenario, verdict.violations)
        # Here: collecting needs nothing of searches.
        from planner.tasks.most import most

        with watch.stage("bound"):
            found = most(scenario)
        if found is not None:
            area_m2, worth = found
            total = verdict.importance_total
            importance = None if total is None else min(worth, total)
            draft = replace(
                draft,
                metrics=replace(draft.metrics, area_seen_bound_m2=area_m2, importance_bound=importance),
            )
    reasons = {name: f.message for f in dropped for name in f.feature.split("+")}
    near += tuple(str(finding) for finding in untold(scenario, verdict.unseen, reasons))
    controls.progress("done", 1.0)
    return replace(
        draft,
        metrics=replace(
            draft.metrics,
            coverage=verdict.coverage,
            surveys=verdict.surveys,
            area_seen_m2=verdict.area_seen_m2,
            importance_collected=verdict.importance_collected,
            importance_total=verdict.importance_total,
            planning_time_s=dict(watch.seconds),
            left_out=left_out,
            replan=None if scenario.going_on is None else replanned(scenario.going_on, draft),
        ),
        warnings=draft.warnings + near,
        violations=verdict.violations,
        uncovered=uncovered(chart, verdict.unseen, reasons),
    )


def untold(
    scenario: Scenario, unseen: Mapping[str, BaseGeometry], told: Collection[str]
) -> Iterator[Finding]:
    """A warning for each region that need not be seen and is not, wholly, where no stage has said why."""
    if scenario.task != "collect":
        return
    for region in scenario.regions:
        if region.required or region.name in told or region.name not in unseen:
            continue
        left_m2 = unseen[region.name].area
        yield Finding(
            region.name,
            "not-all-seen",
            f"{left_m2:.0f} m² of it are seen by no pass, {100.0 * left_m2 / region.area.area:.2g} % of it: "
            "it need not be seen (required: false)",
            "Set required: true, and the plan is refused with what stands in the way.",
            "warning",
        )


def _refuse_barred(scenario: Scenario, violations: Sequence[Violation]) -> None:
    """Refuse a search that leads through what may never be entered, or out of the area: it need not be flown.

    One in the air has to come down somewhere: its plan tells what it breaks.

    Raises
    ------
    InfeasibleError
        With the zone, the place, and what would help.
    """
    if any(aircraft.aloft is not None for aircraft in scenario.aircraft):
        return
    for each in violations:
        if each.hard and each.constraint in BARRING:
            place = None if each.where is None else scenario.frame.to_local(each.where[:2])
            raise InfeasibleError(
                each.constraint,
                each.feature,
                f"no flight to the ground and home was found that keeps out of it: {each.message}, in climb, "
                "landing or on the way",
                "Start and end where there is room to climb and to come down, fly lower, or move it.",
                None if place is None else (float(place[0]), float(place[1])),
            )


def _fleet_plan(scenario: Scenario, controls: Controls, watch: _Stopwatch) -> Plan:
    """The plan of several flights."""
    # Here: one flight needs no search for routes of many.
    from planner.tasks.fleet.search import search_together
    from planner.tasks.fleet.task import fleet

    found = (search_together if scenario.task == "search" else fleet)(scenario, controls)
    return _of_several(scenario, found, controls, watch)


def _of_several(scenario: Scenario, found: FleetAnswer, controls: Controls, watch: _Stopwatch) -> Plan:
    """The plan of several flights that were found."""
    from planner.tasks.fleet.answer import answer_of

    # What lies above the passes, but not above what is flown between them, belongs to the fence, too.
    level = scenario.level
    ranges_m = [each.flown.composed.flight.heights.range_m for each in found.sorties]
    low_m, top_m = min(low_m for low_m, _ in ranges_m), max(top_m for _, top_m in ranges_m)
    whole = Chart(scenario.frame, level.at(top_m) if top_m > level.altitude_m else level)
    with watch.stage("publish"):
        parts = []
        for sortie in found.sorties:
            crew = found.crews[sortie.flown.crew]
            chart = Chart(scenario.frame, crew.setting.level)
            parts.append(
                Part(_draft(scenario, chart, answer_of(crew, sortie.flown)), sortie.start_s, sortie.number)
            )
        flown = MultiLineString(
            [LineString(s.flown.composed.flight.path.sample(10.0)[:, :2]) for s in found.sorties]
        )
        draft = together(
            parts,
            fence(whole, scenario.airspace, flown, low_m),
            level.altitude_m,
            {region.name: region.priority for region in scenario.regions},
        )
        home, end = whole.lonlats([scenario.start.position, scenario.end.position])
        if len(draft.vehicles) == 1:
            # What is read as the plan of one flight is flown from where that begins to where it ends.
            home, end = draft.vehicles[0].home or home, draft.vehicles[0].end or end
        warnings = tuple(str(finding) for finding in found.dropped) + draft.warnings
        draft = replace(draft, home=home, end=end, methods=found.methods, warnings=warnings)
        draft = replace(draft, metrics=replace(draft.metrics, assignment=found.assigned))
    return _judged(scenario, draft, whole, found.dropped, found.left_out, controls, watch)


def with_bound(
    scenario: Scenario,
    plan: Plan,
    stop: Stop = never,
    enough: Stop = never,
    clock: Clock | None = None,
    share: bool = False,
) -> Plan:
    """The same plan with what no plan over the regions it sees is shorter than, and how far it is above that.

    That of several flights is given back as it is: nothing is proven of those.
    Nor is anything said of a search, which is not to be short.

    Parameters
    ----------
    scenario
        What ``plan`` was made of.
    stop, enough
        The one cancels; the other ends the search for a better bound.
    clock
        Seconds, for ``metrics.planning_time_s``.
    share
        Whether the search ends after its share of the work, counted so that the same scenario and plan have
        the same bound on any machine; to its end otherwise.
    """
    bound_m = task_of(scenario.task).bound_m
    if bound_m is None or plan.is_fleet or scenario.is_fleet:
        return plan
    watch = _Stopwatch(clock)
    route_m = plan.metrics.route_length_m or plan.metrics.length_m
    allowance = Allowance(lines_for_bound(scenario, plan) if share else math.inf, enough)
    with watch.stage("bound"):
        proved_m = bound_m(scenario, plan, stop, allowance)
    # What of the route is no mission, the runs of take-off and landing, is as long in every plan.
    runs_m = max(route_m - plan.metrics.length_m, 0.0)
    lower_bound_m = max(proved_m - runs_m, 0.0)
    return replace(
        plan,
        metrics=replace(
            plan.metrics,
            lower_bound_m=lower_bound_m,
            gap=1.0 - lower_bound_m / plan.metrics.length_m,
            planning_time_s=plan.metrics.planning_time_s | watch.seconds,
        ),
    )


def lines_for_bound(scenario: Scenario, plan: Plan) -> float:
    """Lines between cells that the bound may look at, so that it takes no more than its share."""
    passes, visits = len(plan.collects), sum(region.revisits for region in scenario.regions)
    planned = LINES_BY_PAPER * max(passes, visits)
    if chosen_methods(scenario.method)["routing"] == "joint":
        corridors = {region.name: region.revisits for region in scenario.regions if region.axis is not None}
        legs = sum(corridors.keys() >= set(collect.regions) for collect in plan.collects)
        further_legs = min(max(legs - sum(corridors.values()), 0), MOST_FURTHER)
        further = min(max(passes - visits - further_legs, 0), MOST_FURTHER)
        planned = LINES_VISIT * min(visits, passes) + LINES_SHARED * max(visits - passes, 0)
        planned += LINES_LEG * further_legs
        planned += LINES_FURTHER[0] * further + LINES_FURTHER[1] * further**2
    return BOUND_SHARE / (1.0 - BOUND_SHARE) * planned


def time_for_bound_s(planned_s: float, budget_s: float | None) -> float:
    """What a time budget leaves for the bound after planning that took so long; no end of it without one."""
    return math.inf if budget_s is None else max(budget_s - planned_s, 0.0)


def _budget(clock: Clock | None, budget_s: float | None) -> Until:
    """Until when better routes are searched for; for ever without clock or budget."""
    if clock is None or budget_s is None:
        return Until()
    return Until(clock, clock() + ROUTING_SHARE * budget_s)
