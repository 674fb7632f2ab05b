"""Order, approach angle, offset and look side chosen together: the planner's own ``auto``.

Li, Chen, Wang, Li (2018) choose them one after the other; here each region offers its ways to be seen, and
the tour takes one of each at the least whole length, exactly over the order for a dozen regions or fewer.

1. A coarse grid of angles and offsets; Dubins lengths between all options, with what going round threat
   discs adds; dynamic programming over subsets of regions and last options.
2. For the best order with each region last, finer grids round the chosen options, halving the step, with a
   shortest path through the layers of options.

Costs between options are estimates where discs or zones are in the way; the flyable line is found by the
transit stage afterwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.coverage.merge import MergedRegion, merge_regions
from planner.coverage.neighbourhood import check_sensor
from planner.coverage.sweeps import Side
from planner.environment.shapes import DiscShape, hard_shapes, soft_shapes
from planner.errors import Finding, InfeasibleError
from planner.progress import Progress, Stop, never, raise_if, silent
from planner.route import CollectPass, Route
from planner.routing import joint_kernels as kernels
from planner.routing import tour
from planner.routing.options import Options, Surroundings, collect_passes, make_options
from planner.routing.targets import refusal, targets
from planner.scenario import Scenario, Terminal
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.wind import still_air_costs

Floats = NDArray[np.float64]

COARSE_STEP_RAD = math.radians(10.0)
COARSE_ETAS = np.array([0.0, 0.5, 1.0])
#: Each refinement tries this many angles and offsets to either side of the last choice, then halves the step.
REFINE_ANGLES = 5
REFINE_ETAS = 2
REFINEMENTS = 5
#: Beyond this many regions the order comes from a tour of centroids, improved by moves.
EXACT_ORDER_UP_TO = 9
ORDER_EVALUATIONS = 20_000
#: Threat discs are kept this much larger, room for the chords of arcs.
MARGIN_M = 10.0


@dataclass(frozen=True, slots=True)
class JointRoute:
    """The chosen route; regions that are not required and cannot be seen; the estimated length."""

    route: Route
    dropped: tuple[Finding, ...]
    estimated_m: float


@dataclass(frozen=True, slots=True)
class _Choice:
    """One option of each region in visiting order: side, angle and offsets."""

    order: tuple[int, ...]
    side: tuple[int, ...]
    angle_rad: tuple[float, ...]
    eta_first: tuple[float, ...]
    eta_second: tuple[float, ...]
    cost_m: float


def surroundings(scenario: Scenario, aircraft: Aircraft) -> Surroundings:
    """Area, discs and polygons, with the margin transits keep."""
    hard = list(hard_shapes(scenario))
    radius_m = aircraft.planned_turn_radius_m
    area = scenario.area
    return Surroundings(
        area=area,
        room=None if area is None else area.buffer(-radius_m),
        hard=_discs([shape for shape in hard if isinstance(shape, DiscShape)]),
        soft=_discs(list(soft_shapes(scenario))),
        hard_polygons=tuple(shape.area for shape in hard if not isinstance(shape, DiscShape)),
        radius_m=radius_m,
        settle_m=aircraft.settle_m,
        airspeed_m_s=aircraft.airspeed_m_s,
        wind=scenario.wind,
    )


def joint_route(
    scenario: Scenario, aircraft: Aircraft, progress: Progress = silent, stop: Stop = never
) -> JointRoute:
    """Choose the passes of all regions and their order together.

    Raises
    ------
    InfeasibleError
        Where a required region has no pass that keeps the hard constraints.
    CancelledError
        Once ``stop`` says so.
    """
    around = surroundings(scenario, aircraft)
    regions, sides, dropped = _visible(scenario, around)
    if not regions:
        raise InfeasibleError("swath", "scenario", "no region can be seen", "see the findings", None)
    progress("routing", 0.0)
    angles_rad = np.arange(-math.pi, math.pi - 1e-9, COARSE_STEP_RAD, dtype=np.float64)
    coarse = []
    for region, of_region in zip(regions, sides, strict=True):
        raise_if(stop)
        options = make_options(of_region, _allowed(region, angles_rad), COARSE_ETAS, around)
        if options is None:
            options = make_options(of_region, of_region[0].angles_rad, np.linspace(0.0, 1.0, 9), around)
        if options is None:
            raise refusal(region)
        coarse.append(options)
    candidates = _orders(scenario, around, regions, coarse)
    refined = []
    for index, choice in enumerate(candidates):
        raise_if(stop)
        progress("routing", 0.3 + 0.7 * index / len(candidates))
        refined.append(_refine(scenario, around, regions, sides, choice))
    best = min(refined, key=lambda choice: choice.cost_m)
    passes: list[CollectPass] = []
    for position, region_index in enumerate(best.order):
        option = _single(best, position, sides[region_index], around)
        passes.extend(collect_passes(sides[region_index], option, 0))
    return JointRoute(Route(tuple(passes)), dropped, best.cost_m)


def _visible(
    scenario: Scenario, around: Surroundings
) -> tuple[list[MergedRegion], list[tuple[Side, ...]], tuple[Finding, ...]]:
    """Parts of regions with the families of passes that see them.

    Regions that are not required and not to be seen are named and left out. The paper's coverage, asked for
    by name, has two passes at most and divides nothing.
    """
    regions: list[MergedRegion] = []
    sides: list[tuple[Side, ...]] = []
    dropped: list[Finding] = []
    wide = scenario.method.coverage != "li2018"
    by_name = {region.name: region for region in scenario.regions}
    for region in merge_regions(scenario.regions, default_sensor=scenario.sensors[0].name):
        first = by_name[region.names[0]]
        sensor = scenario.sensor_for(first)
        try:
            for name in region.names:
                check_sensor(by_name[name], sensor, scenario.height_m)
            found = targets(region, sensor, scenario.height_m, around, wide=wide)
        except InfeasibleError as error:
            if region.required:
                raise
            dropped.append(
                Finding(
                    error.feature, f"not-seen-{error.constraint}", error.message, error.relaxation, "warning"
                )
            )
            continue
        regions.extend(target.region for target in found)
        sides.extend(target.sides for target in found)
    return regions, sides, tuple(dropped)


def _allowed(region: MergedRegion, angles_rad: Floats) -> Floats:
    return angles_rad if region.approach_rad is None else np.asarray(region.approach_rad, dtype=np.float64)


def _orders(
    scenario: Scenario, around: Surroundings, regions: list[MergedRegion], options: list[Options]
) -> list[_Choice]:
    """Candidate tours over the coarse options, cheapest first."""
    offsets = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in options])]).astype(np.int64)
    first, between, last = _costs(scenario, around, options)
    choices = []
    if len(options) <= EXACT_ORDER_UP_TO:
        costs, tours = kernels.best_orders(first, between, last, offsets)
        for cost, chosen in sorted(zip(costs.tolist(), tours.tolist(), strict=True)):
            if math.isfinite(cost):
                choices.append(_choice(options, offsets, chosen, cost))
        return choices
    centroids = np.array([region.centroid for region in regions])
    order = tour.order(centroids, scenario.start.position, scenario.end.position, "exact", scenario.seed)
    better = kernels.improve_order(
        first, between, last, offsets, np.array(order, dtype=np.int64), ORDER_EVALUATIONS
    )
    cost, picked = kernels.best_options(first, between, last, offsets, better)
    return [_choice(options, offsets, picked.tolist(), cost)]


def _choice(options: list[Options], offsets: NDArray[np.int64], chosen: list[int], cost_m: float) -> _Choice:
    order = [int(np.searchsorted(offsets, option, side="right")) - 1 for option in chosen]
    local = [int(option - offsets[region]) for option, region in zip(chosen, order, strict=True)]
    pairs = [(options[region], index) for region, index in zip(order, local, strict=True)]
    return _Choice(
        tuple(order),
        tuple(int(o.side[i]) for o, i in pairs),
        tuple(float(o.angles_rad[i]) for o, i in pairs),
        tuple(float(o.eta_first[i]) for o, i in pairs),
        tuple(float(o.eta_second[i]) for o, i in pairs),
        cost_m,
    )


def _refine(
    scenario: Scenario,
    around: Surroundings,
    regions: list[MergedRegion],
    sides: list[tuple[Side, ...]],
    choice: _Choice,
) -> _Choice:
    """The same order with finer angles and offsets round the chosen ones."""
    step_rad, step_eta = COARSE_STEP_RAD / 2.0, 0.25
    for _ in range(REFINEMENTS):
        finer = []
        for position, region_index in enumerate(choice.order):
            near_rad = step_rad * np.arange(-REFINE_ANGLES, REFINE_ANGLES + 1, dtype=np.float64)
            angles_rad: Floats = choice.angle_rad[position] + near_rad
            if regions[region_index].approach_rad is not None:
                angles_rad = np.asarray(regions[region_index].approach_rad, dtype=np.float64)
            etas = _near([choice.eta_first[position], choice.eta_second[position]], step_eta)
            side = (sides[region_index][choice.side[position]],)
            options = make_options(side, angles_rad, etas, around)
            if options is None:
                options = _single(choice, position, sides[region_index], around)
            finer.append(options)
        offsets = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in finer])]).astype(np.int64)
        first, between, last = _costs(scenario, around, finer, chain=True)
        order = np.arange(len(finer), dtype=np.int64)
        cost_m, picked = kernels.best_options(first, between, last, offsets, order)
        if cost_m < choice.cost_m:
            found = _choice(finer, offsets, picked.tolist(), cost_m)
            choice = _Choice(
                choice.order, choice.side, found.angle_rad, found.eta_first, found.eta_second, cost_m
            )
        step_rad, step_eta = step_rad / 2.0, step_eta / 2.0
    return choice


def _near(etas: list[float], step: float) -> Floats:
    steps = step * np.arange(-REFINE_ETAS, REFINE_ETAS + 1)
    around = [np.clip(eta + steps, 0.0, 1.0) for eta in etas if not math.isnan(eta)]
    return np.unique(np.concatenate(around))


def _single(choice: _Choice, position: int, sides: tuple[Side, ...], around: Surroundings) -> Options:
    """The chosen option of one region by itself; ``side`` counts within ``sides``."""
    etas = [eta for eta in (choice.eta_first[position], choice.eta_second[position]) if not math.isnan(eta)]
    chosen = (sides[choice.side[position]],)
    options = make_options(chosen, np.array([choice.angle_rad[position]]), np.unique(np.array(etas)), around)
    if options is None:
        raise refusal(chosen[0].region)
    same = (options.eta_first == choice.eta_first[position]) & (
        np.isnan(options.eta_second) | (options.eta_second == choice.eta_second[position])
    )
    kept = {name: getattr(options, name)[same] for name in Options.__slots__}
    kept["side"] = np.full(int(same.sum()), choice.side[position], dtype=np.int64)
    return Options(**kept)


def _costs(
    scenario: Scenario, around: Surroundings, options: list[Options], chain: bool = False
) -> tuple[Floats, Floats, Floats]:
    """Costs from the start, between all options (only neighbours in a ``chain``), and to the end."""
    entries = np.concatenate([o.entries for o in options])
    exits = np.concatenate([o.exits for o in options])
    inner_m = np.concatenate([o.inner_m for o in options])
    discs = np.concatenate([around.hard, around.soft])
    first = _terminal_costs(scenario.start, entries, around, discs)
    first = _in_wind(first, np.array(scenario.start.position), entries, around) + inner_m
    turned = exits + np.array([0.0, 0.0, math.pi])
    last = _terminal_costs(_reversed(scenario.end), turned, around, discs)
    last = _in_wind(last, exits, np.array(scenario.end.position), around)
    if not chain:
        costs = kernels.transit_costs(exits, entries, around.radius_m, discs)
        between = _in_wind(costs, exits[:, None], entries[None], around) + inner_m[None, :]
        return first, between, last
    between = np.full((len(entries), len(entries)), np.inf)
    at = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in options])])
    for k in range(len(options) - 1):
        here, there = slice(at[k], at[k + 1]), slice(at[k + 1], at[k + 2])
        costs = kernels.transit_costs(exits[here], entries[there], around.radius_m, discs)
        costs = _in_wind(costs, exits[here, None], entries[None, there], around)
        between[here, there] = costs + inner_m[None, there]
    return first, between, last


def _terminal_costs(terminal: Terminal, entries: Floats, around: Surroundings, discs: Floats) -> Floats:
    east_m, north_m = terminal.position
    if terminal.angle_rad is None:
        costs: Floats = kernels.point_costs(east_m, north_m, entries, around.radius_m, discs)
        return costs
    pose = np.array([[east_m, north_m, terminal.angle_rad]])
    from_pose: Floats = kernels.transit_costs(pose, entries, around.radius_m, discs)[0]
    return from_pose


def _in_wind(costs_m: Floats, begins: Floats, ends: Floats, around: Surroundings) -> Floats:
    """Costs in metres through the air."""
    return still_air_costs(costs_m, begins, ends, around.airspeed_m_s, around.wind)


def _reversed(terminal: Terminal) -> Terminal:
    """Where a line flown backwards would start."""
    angle = None if terminal.angle_rad is None else terminal.angle_rad + math.pi
    return Terminal(terminal.name, terminal.position, angle)


def _discs(shapes: list[DiscShape]) -> Floats:
    rows = [(*shape.centre, shape.radius_m + MARGIN_M) for shape in shapes]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
