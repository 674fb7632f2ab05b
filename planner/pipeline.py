"""make_plan: the stages in turn, each chosen by name, and the judge at the end."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

from planner.airspace.zones import KeepOut, keep_out
from planner.bounds.ways import plan_bound_m
from planner.check import judge
from planner.dubins.path import Path, Segment, join
from planner.errors import Finding, InfeasibleError
from planner.metrics import measure, used
from planner.plan import LeftOut, Plan
from planner.progress import Progress, Stop, never, raise_if, silent
from planner.publish import Leg, assemble, uncovered, whole_path
from planner.route import Anchor, CollectPass, Route
from planner.routing.greedy.route import greedy
from planner.routing.joint.hidden import hidden_findings
from planner.routing.joint.route import joint_route
from planner.routing.legs import TRANSIT_MARGIN_M as TRANSIT_MARGIN_M
from planner.scenario import Scenario
from planner.tasks.limits import Dropped, within_limits
from planner.tasks.wind import in_wind
from planner.transit import ssas_connector
from planner.transit.refine import Risk, connect_by_cost
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.limits import Use
from planner.version import __version__
from planner.wishes import Method

Clock = Callable[[], float]

#: The search for better routes ends after this part of the scenario's time budget.
ROUTING_SHARE = 0.6

#: The bound takes no more than this part of the time for plan and bound together.
BOUND_SHARE = 1.0 / 3.0

#: What the rules of findings about regions left out begin with.
NOT_SEEN = "not-seen-"

#: What ``auto`` stands for.
AUTO = {
    "coverage": "sweeps",
    "routing": "joint",
    "transit": "tangent",
    "smoothing": "fillet",
    "search": "none",
}


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


@dataclass(frozen=True, slots=True)
class _Flight:
    """A route with the legs that join its passes, and what the whole uses."""

    route: Route
    dropped: tuple[Finding, ...]
    legs: tuple[Leg, ...]
    notes: tuple[str, ...]
    use: Use

    @property
    def passes(self) -> tuple[CollectPass, ...]:
        """In flight order."""
        return self.route.passes


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
    scenario = in_wind(scenario)
    aircraft = scenario.aircraft[0]
    methods = chosen_methods(scenario.method)
    watch = _Stopwatch(clock)
    enough = _budget(clock, scenario.time_budget_s)

    def fly(asked: Scenario, report: Progress) -> _Flight:
        with watch.stage("routing"):
            route, dropped = _route(asked, aircraft, methods, _part(report, 0.0, 0.5), stop, enough)
        with watch.stage("transit"):
            legs, notes = _connect(asked, aircraft, methods, route, _part(report, 0.5, 0.9), stop)
        use = used(asked, aircraft, whole_path(legs, route.passes))
        return _Flight(route, dropped, legs, notes, use)

    flight, left = within_limits(
        fly(scenario, progress),
        lambda names: fly(_without(scenario, names), silent),
        {region.name: region.priority for region in scenario.regions if not region.required},
        aircraft,
        (scenario.start.position, scenario.end.position),
    )
    route, legs, notes = flight.route, flight.legs, flight.notes
    dropped = flight.dropped + tuple(_over(each) for each in left)
    dropped += hidden_findings(scenario, route.passes, by_paper=methods["coverage"] == "li2018")
    with watch.stage("publish"):
        path = whole_path(legs, route.passes)
        draft = assemble(
            scenario,
            aircraft,
            legs,
            route.passes,
            metrics=measure(scenario, aircraft, path, route.passes, {}, {}),
            methods=methods,
            planner_version=__version__,
            warnings=tuple(str(f) for f in (*scenario.warnings, *dropped)) + notes,
        )
    progress("check", 0.95)
    with watch.stage("check"):
        verdict = judge(scenario, draft)
    reasons = {name: f.message for f in dropped for name in f.feature.split("+")}
    progress("done", 1.0)
    return replace(
        draft,
        metrics=replace(
            draft.metrics,
            coverage=verdict.coverage,
            planning_time_s=dict(watch.seconds),
            left_out=_left_out(dropped, left),
        ),
        violations=verdict.violations,
        uncovered=uncovered(scenario, verdict.unseen, reasons),
    )


def with_bound(
    scenario: Scenario, plan: Plan, stop: Stop = never, enough: Stop = never, clock: Clock | None = None
) -> Plan:
    """The same plan with what no plan over the regions it sees is shorter than, and how far it is above that.

    Parameters
    ----------
    scenario
        What ``plan`` was made of.
    stop, enough
        The one cancels; the other ends the search for a better bound.
    clock
        Seconds, for ``metrics.planning_time_s``.
    """
    scenario = in_wind(scenario)
    watch = _Stopwatch(clock)
    length_m = plan.metrics.length_m
    left_out = {r.name for r in scenario.regions} - {name for c in plan.collects for name in c.regions}
    with watch.stage("bound"):
        bound_m = plan_bound_m(scenario, scenario.aircraft[0], length_m, left_out, stop, enough)
    return replace(
        plan,
        metrics=replace(
            plan.metrics,
            lower_bound_m=bound_m,
            gap=1.0 - bound_m / length_m,
            planning_time_s=plan.metrics.planning_time_s | watch.seconds,
        ),
    )


def time_for_bound_s(planned_s: float, budget_s: float | None) -> float:
    """How long the bound may be looked for after planning that took so long: a third of the whole."""
    spare_s = math.inf if budget_s is None else max(budget_s - planned_s, 0.0)
    return min(BOUND_SHARE / (1.0 - BOUND_SHARE) * planned_s, spare_s)


def chosen_methods(method: Method) -> dict[str, str]:
    """The algorithm of each stage, ``auto`` resolved."""
    asked = {name: getattr(method, name) for name in Method.__slots__}
    chosen = {name: AUTO[name] if value == "auto" else value for name, value in asked.items()}
    if method.routing == "auto" and method.coverage == "li2018":
        # Asking for the paper's neighbourhoods by name means the paper's choice among them.
        chosen["routing"] = "li2018"
    if chosen["routing"] != "joint":
        # The paper's choices are among the paper's neighbourhoods.
        chosen["coverage"] = "li2018"
    return chosen


def _budget(clock: Clock | None, budget_s: float | None) -> Stop:
    """Whether the search for better routes has had its share of the time; never without clock or budget."""
    if clock is None or budget_s is None:
        return never
    end_s = clock() + ROUTING_SHARE * budget_s
    return lambda: clock() > end_s


def _route(
    scenario: Scenario,
    aircraft: Aircraft,
    methods: dict[str, str],
    progress: Progress,
    stop: Stop,
    enough: Stop,
) -> tuple[Route, tuple[Finding, ...]]:
    """The route and what was left out."""
    if methods["routing"] != "joint":
        aware = methods["routing"] == "li2018-threat-aware"
        chosen = greedy(scenario, progress, stop, threat_aware=aware, aircraft=aircraft)
        if not chosen.route.passes:
            why = "; ".join(error.message for error in chosen.dropped)
            raise InfeasibleError("swath", "scenario", f"no region can be seen: {why}", "see the findings")
        return chosen.route, tuple(_dropped(error) for error in chosen.dropped)
    joint = joint_route(scenario, aircraft, progress, stop, enough)
    return joint.route, joint.dropped


def _dropped(error: InfeasibleError) -> Finding:
    rule = f"{NOT_SEEN}{error.constraint}"
    return Finding(error.feature, rule, error.message, error.relaxation, "warning")


def _without(scenario: Scenario, names: frozenset[str]) -> Scenario:
    """The scenario without some regions."""
    return replace(scenario, regions=tuple(r for r in scenario.regions if r.name not in names))


def _over(dropped: Dropped) -> Finding:
    excess = dropped.excess
    return Finding(
        dropped.name,
        f"{NOT_SEEN}{excess.constraint}",
        f"is left out: with it the flight takes {excess.used:.0f} {excess.unit}, there are "
        f"{excess.limit:.0f} {excess.unit}",
        "Raise the limit, its priority, or plan it as a flight of its own.",
        "warning",
    )


def _left_out(dropped: tuple[Finding, ...], left: tuple[Dropped, ...]) -> tuple[LeftOut, ...]:
    """What is not seen at all, and why, for the metrics."""
    margins = {each.name: each.excess.margin for each in left}
    return tuple(
        LeftOut(name, finding.rule.removeprefix(NOT_SEEN), margins.get(name))
        for finding in dropped
        if finding.rule.startswith(NOT_SEEN)
        for name in finding.feature.split("+")
    )


def _connect(
    scenario: Scenario,
    aircraft: Aircraft,
    methods: dict[str, str],
    route: Route,
    progress: Progress,
    stop: Stop,
) -> tuple[tuple[Leg, ...], tuple[str, ...]]:
    """A flyable leg from the start through all collects to the end."""
    zones = keep_out(scenario.airspace, scenario.level, TRANSIT_MARGIN_M)
    risk = Risk.of(scenario.threats, scenario.objective, scenario.height_m)
    starts = [Anchor(*scenario.start.position, scenario.start.angle_rad)] + [
        Anchor(*p.end, p.angle_rad) for p in route.passes
    ]
    settling = [p.settling(aircraft.settle_m) for p in route.passes]
    goals = [Anchor(*pose.position, pose.angle_rad) for pose in settling] + [
        Anchor(*scenario.end.position, scenario.end.angle_rad)
    ]
    names = [scenario.start.name, *("+".join(p.regions) for p in route.passes), scenario.end.name]
    legs: list[Leg] = []
    notes: list[str] = []
    for k, (start, goal) in enumerate(zip(starts, goals, strict=True)):
        raise_if(stop)
        progress("transit", k / len(starts))
        path, method = _leg(
            scenario, aircraft, methods, zones, risk, start, goal, stop, notes, names[k : k + 2]
        )
        if k < len(route.passes) and aircraft.settle_m > 0.0:
            path = _extended(path, route.passes[k])
        legs.append(Leg(names[k], names[k + 1], path, method))
    return tuple(legs), tuple(notes)


def _leg(
    scenario: Scenario,
    aircraft: Aircraft,
    methods: dict[str, str],
    zones: KeepOut,
    risk: Risk,
    start: Anchor,
    goal: Anchor,
    stop: Stop,
    notes: list[str],
    names: list[str],
) -> tuple[Path, str]:
    """One connection; where SSAS finds none, or one through threats that cost more than the tangent
    connector's line, that is taken, and the plan says so.
    """
    radius_m = aircraft.planned_turn_radius_m
    if methods["transit"] != "ssas":
        return connect_by_cost(start, goal, zones, radius_m, risk, stop), "tangent"
    try:
        path, _ = ssas_connector.connect(
            start,
            goal,
            scenario=scenario,
            keep_out=zones,
            radius_m=radius_m,
            smoothing="shortcut" if methods["smoothing"] == "shortcut" else "fillet",
            stop=stop,
        )
    except InfeasibleError as error:
        notes.append(f"SSAS connects {names[0]} and {names[1]} in no way ({error.message}): tangent used")
        return connect_by_cost(start, goal, zones, radius_m, risk, stop), "tangent"
    if not ssas_connector.avoidable(start, goal, scenario, zones).clear(path):
        other = connect_by_cost(start, goal, zones, radius_m, risk, stop)
        if risk.cost_m(other) < risk.cost_m(path):
            notes.append(f"SSAS connects {names[0]} and {names[1]} through threats only: tangent used")
            return other, "tangent"
    return path, "ssas"


def _extended(path: Path, collect: CollectPass) -> Path:
    """A leg with its settling run: straight on to where the collect begins."""
    gap_m = math.dist(path.end.position, collect.start)
    return join(path, Path((Segment("straight", path.end, gap_m),)))


def _part(progress: Progress, low: float, high: float) -> Progress:
    """Progress of one stage as a part of the whole."""

    def report(stage: str, fraction: float) -> None:
        progress(stage, low + (high - low) * min(max(fraction, 0.0), 1.0))

    return report
