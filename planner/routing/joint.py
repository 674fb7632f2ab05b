"""Order, approach angle, offset and look side chosen together: the planner's own ``auto``.

Li, Chen, Wang, Li (2018) choose them one after the other; here each region offers its ways to be seen, and
the tour takes one of each at the least whole length, exactly over the order for a dozen regions or fewer.

1. A coarse grid of angles and offsets; Dubins lengths between all options, with what going round threat
   discs adds; dynamic programming over subsets of regions and last options, or local search (``large``).
2. For the best order with each region last, finer grids round the chosen options, halving the step, with a
   shortest path through the layers of options.
3. Costs between options are estimates where discs or zones are in the way: the legs of the tours found are
   flown in earnest, their true costs fed back (``chain``), and the tours compared by true cost.
4. Passes of one region are parted where others fit between (``split``), and passes added for ground that
   terrain hides from all of them (``hidden``).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.coverage.merge import MergedRegion, merge_regions
from planner.coverage.neighbourhood import check_sensor
from planner.coverage.sweeps import Side
from planner.environment.shapes import DiscShape, hard_shapes
from planner.errors import Finding, InfeasibleError
from planner.progress import Progress, Stop, never, raise_if, silent
from planner.route import CollectPass, Route
from planner.routing import joint_kernels as kernels
from planner.routing import tour
from planner.routing.barriers import polygon_rows
from planner.routing.chain import Layers, from_start, layers_of, to_end, true_choice
from planner.routing.hidden import see_hidden
from planner.routing.large import large_order
from planner.routing.legs import Legs
from planner.routing.options import Options, Surroundings, collect_passes, hidden_m, make_options
from planner.routing.prices import INSIDE_FACTOR, soft_prices
from planner.routing.relaxation import explained
from planner.routing.split import split_passes
from planner.routing.targets import can_be_flown, coarse_options, refusal, targets
from planner.scenario import Scenario
from planner.sensors.view import sensing
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.wind import still_air_costs

Floats = NDArray[np.float64]

COARSE_STEP_RAD = math.radians(10.0)
COARSE_ETAS = np.array([0.0, 0.5, 1.0])
#: Each refinement tries this many angles and offsets to either side of the last choice, then halves the step.
REFINE_ANGLES = 5
REFINE_ETAS = 2
REFINEMENTS = 5
#: Beyond this many regions the order is searched locally, over fewer options.
EXACT_ORDER_UP_TO = 9
LARGE_STEP_RAD = math.radians(15.0)
LARGE_ETAS = np.array([0.0, 1.0])
#: Tours with their legs flown in earnest, those of them to which true costs are fed back, and how often.
TRUE_TOURS = 4
TRUE_SOLVES = 12
#: A tour that costs this much more than was thought is chosen anew.
FALSE_M = 5.0
#: Of one option that is the only one: its side counts within one.
NO_SIDE = np.zeros(1, dtype=np.int64)
#: Zones are kept this much larger, room for the chords of arcs and the margin of transits.
MARGIN_M = 10.0


@dataclass(frozen=True, slots=True)
class JointRoute:
    """The chosen route; regions that are not required and cannot be seen; the true cost in metres.

    ``sides`` are the ways to see each region, part of one or visit to one that were chosen from.
    """

    route: Route
    dropped: tuple[Finding, ...]
    cost_m: float
    sides: tuple[tuple[Side, ...], ...]


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
    priced = soft_prices(scenario)
    soft = priced[:, :3] + np.array([0.0, 0.0, MARGIN_M])
    polygons = tuple(
        shape.area.buffer(MARGIN_M, join_style="mitre") for shape in hard if not isinstance(shape, DiscShape)
    )
    return Surroundings(
        area=area,
        room=None if area is None else area.buffer(-radius_m),
        hard=_discs([shape for shape in hard if isinstance(shape, DiscShape)]),
        soft=soft,
        hard_polygons=polygons,
        radius_m=radius_m,
        settle_m=aircraft.settle_m,
        airspeed_m_s=aircraft.airspeed_m_s,
        wind=scenario.wind,
        ground=scenario.terrain,
        level_m=scenario.altitude_amsl_m,
        prices=priced[:, 3],
        yields=priced[:, 3] < INSIDE_FACTOR,
        barriers=polygon_rows(polygons),
        cramped=shapely.union_all([polygon.buffer(radius_m) for polygon in polygons]) if polygons else None,
    )


def joint_route(
    scenario: Scenario,
    aircraft: Aircraft,
    progress: Progress = silent,
    stop: Stop = never,
    enough: Stop = never,
) -> JointRoute:
    """Choose the passes of all regions and their order together.

    Parameters
    ----------
    stop, enough
        The one cancels; the other ends the search for anything better.

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
    exact = len(regions) <= EXACT_ORDER_UP_TO
    step_rad, etas = (COARSE_STEP_RAD, COARSE_ETAS) if exact else (LARGE_STEP_RAD, LARGE_ETAS)
    angles_rad = np.arange(-math.pi, math.pi - 1e-9, step_rad, dtype=np.float64)
    coarse = []
    for region, of_region in zip(regions, sides, strict=True):
        raise_if(stop)
        coarse.append(coarse_options(region, of_region, angles_rad, etas, around))
    candidates = _orders(scenario, around, regions, coarse, progress, stop, enough)
    refined = []
    for index, choice in enumerate(candidates):
        raise_if(stop)
        progress("routing", 0.4 + 0.3 * index / len(candidates))
        refined.append(_refine(scenario, around, regions, sides, choice))
    legs = Legs(scenario, aircraft, stop)
    cost_m, passes = _truest(scenario, around, regions, sides, refined, legs, progress, stop, enough)
    cost_m, passes = split_passes(cost_m, passes, legs, stop)
    if scenario.terrain is not None and scenario.method.coverage != "li2018":
        more = see_hidden(scenario, around, passes, legs, stop)
        if more is not passes:
            passes, cost_m = more, legs.tour_m(more)
    return JointRoute(Route(passes), dropped, cost_m, tuple(sides))


def sides_of(scenario: Scenario, aircraft: Aircraft) -> tuple[tuple[Side, ...], ...]:
    """The ways to see each region, part of one or visit to one that is not left out."""
    return tuple(_visible(scenario, surroundings(scenario, aircraft))[1])


def _truest(
    scenario: Scenario,
    around: Surroundings,
    regions: list[MergedRegion],
    sides: list[tuple[Side, ...]],
    choices: list[_Choice],
    legs: Legs,
    progress: Progress,
    stop: Stop,
    enough: Stop,
) -> tuple[float, tuple[CollectPass, ...]]:
    """The tour that truly costs least, and its passes.

    Where flying a tour costs more than was thought, options round its own are tried with true costs. Ground
    left in shadow counts as in the options, but not in the cost given back.
    """
    best_m, best = math.inf, _passes(choices[0], sides, around)
    choices = sorted(choices, key=lambda choice: choice.cost_m)[:TRUE_TOURS]
    for index, choice in enumerate(choices):
        raise_if(stop)
        progress("routing", 0.7 + 0.3 * index / len(choices))
        passes = _passes(choice, sides, around)
        true_m = legs.tour_m(passes) + _shadow_m(choice, sides, around)
        if true_m < best_m:
            best_m, best = true_m, passes
        if true_m - choice.cost_m <= FALSE_M or choice.cost_m >= best_m or enough():
            continue
        # A little finer and a little wider than the last refinement.
        for step_rad, step_eta in ((COARSE_STEP_RAD / 2.0, 0.125), (COARSE_STEP_RAD / 8.0, 0.03)):
            layers, of_places = _layers(scenario, around, regions, sides, choice, step_rad, step_eta)
            found_m, picked = true_choice(
                layers,
                of_places,
                legs,
                TRUE_SOLVES,
                stop,
                partial(_besides, of_places, around),
            )
            if not found_m < true_m - 1e-6:
                continue
            true_m = found_m
            choice = _picked(choice, layers, picked, found_m)
            passes = _passes(choice, sides, around)
            if true_m < best_m:
                best_m, best = true_m, passes
    return legs.tour_m(best), best


def _besides(
    of_places: list[tuple[Side, ...]], around: Surroundings, place: int, passes: Sequence[CollectPass]
) -> float:
    return hidden_m(of_places[place][0], passes, around)


def _shadow_m(choice: _Choice, sides: list[tuple[Side, ...]], around: Surroundings) -> float:
    """What a tour's passes cost for ground that terrain hides from them."""
    if around.ground is None:
        return 0.0
    return math.fsum(
        hidden_m(sides[region][side], collect_passes(sides[region], option, 0), around)
        for position, (region, side) in enumerate(zip(choice.order, choice.side, strict=True))
        for option in [_single(choice, position, sides[region], around)]
    )


def _passes(choice: _Choice, sides: list[tuple[Side, ...]], around: Surroundings) -> tuple[CollectPass, ...]:
    passes: list[CollectPass] = []
    for position, region_index in enumerate(choice.order):
        option = _single(choice, position, sides[region_index], around)
        passes.extend(collect_passes(sides[region_index], option, 0))
    return tuple(passes)


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
            sensor, height_m = sensing(scenario, sensor, region.area)
            for name in region.names:
                check_sensor(by_name[name], sensor, height_m)
            found = targets(region, sensor, height_m, around, wide=wide)
        except InfeasibleError as refused:
            error = refused
            if error.constraint == "area":
                error = explained(scenario, region, refused, partial(_some_pass, region=region, wide=wide))
            if region.required:
                raise error from refused
            dropped.append(
                Finding(
                    error.feature, f"not-seen-{error.constraint}", error.message, error.relaxation, "warning"
                )
            )
            continue
        regions.extend(target.region for target in found)
        sides.extend(target.sides for target in found)
    return regions, sides, tuple(dropped)


def _some_pass(scenario: Scenario, *, region: MergedRegion, wide: bool) -> bool:
    """Whether a region can be seen in a scenario with other zones or at another altitude."""
    around = surroundings(scenario, scenario.aircraft[0])
    asked = next((s for s in scenario.sensors if s.name == region.sensor), scenario.sensors[0])
    try:
        sensor, height_m = sensing(scenario, asked, region.area)
        return can_be_flown(region, sensor, height_m, around, wide=wide)
    except InfeasibleError:
        return False


def _orders(
    scenario: Scenario,
    around: Surroundings,
    regions: list[MergedRegion],
    options: list[Options],
    progress: Progress,
    stop: Stop,
    enough: Stop,
) -> list[_Choice]:
    """Candidate tours over the coarse options, cheapest first."""
    offsets = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in options])]).astype(np.int64)
    entries, exits, inner_m = (
        np.concatenate([getattr(o, name) for o in options]) for name in ("entries", "exits", "inner_m")
    )
    first = from_start(scenario, around, entries, around.discs) + inner_m
    last = to_end(scenario, around, exits, around.discs)
    if len(options) <= EXACT_ORDER_UP_TO:
        costs = kernels.transit_costs(exits, entries, around.radius_m, around.discs)
        wind = (around.airspeed_m_s, around.wind)
        between = still_air_costs(costs, exits[:, None], entries[None], *wind) + inner_m[None, :]
        totals, tours = kernels.best_orders(first, between, last, offsets)
        return [
            _choice(options, offsets, chosen, cost)
            for cost, chosen in sorted(zip(totals.tolist(), tours.tolist(), strict=True))
            if math.isfinite(cost)
        ]
    centroids = np.array([region.centroid for region in regions])
    order = np.array(
        tour.order(centroids, scenario.start.position, scenario.end.position, "exact", scenario.seed),
        dtype=np.int64,
    )
    ends = (first, last, around, around.discs)
    cost, better = large_order(
        [order, order[::-1].copy()], centroids, options, *ends, scenario.seed, progress, stop, enough
    )
    layers = layers_of(scenario, around, [options[c] for c in better], around.discs)
    cost, picked = layers.best()
    chosen = [int(offsets[c]) + option for c, option in zip(better, picked, strict=True)]
    return [_choice(options, offsets, chosen, cost)]


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
        layers, _ = _layers(scenario, around, regions, sides, choice, step_rad, step_eta)
        cost_m, picked = layers.best()
        if cost_m < choice.cost_m:
            choice = _picked(choice, layers, picked, cost_m)
        step_rad, step_eta = step_rad / 2.0, step_eta / 2.0
    return choice


def _layers(
    scenario: Scenario,
    around: Surroundings,
    regions: list[MergedRegion],
    sides: list[tuple[Side, ...]],
    choice: _Choice,
    step_rad: float,
    step_eta: float,
) -> tuple[Layers, list[tuple[Side, ...]]]:
    """Options round the chosen ones, place by place, and the one side each place has them of."""
    finer: list[Options] = []
    of_places: list[tuple[Side, ...]] = []
    for position, region_index in enumerate(choice.order):
        near_rad = step_rad * np.arange(-REFINE_ANGLES, REFINE_ANGLES + 1, dtype=np.float64)
        angles_rad: Floats = choice.angle_rad[position] + near_rad
        if regions[region_index].approach_rad is not None:
            angles_rad = np.asarray(regions[region_index].approach_rad, dtype=np.float64)
        etas = _near([choice.eta_first[position], choice.eta_second[position]], step_eta)
        side = (sides[region_index][choice.side[position]],)
        options = make_options(side, angles_rad, etas, around)
        if options is None:
            options = replace(_single(choice, position, sides[region_index], around), side=NO_SIDE)
        finer.append(options)
        of_places.append(side)
    return layers_of(scenario, around, finer, around.discs), of_places


def _picked(choice: _Choice, layers: Layers, picked: list[int], cost_m: float) -> _Choice:
    """The same order and sides with other options."""
    pairs = list(zip(layers.options, picked, strict=True))
    return replace(
        choice,
        angle_rad=tuple(float(o.angles_rad[i]) for o, i in pairs),
        eta_first=tuple(float(o.eta_first[i]) for o, i in pairs),
        eta_second=tuple(float(o.eta_second[i]) for o, i in pairs),
        cost_m=cost_m,
    )


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
        raise refusal(chosen[0].region, around)
    same = (options.eta_first == choice.eta_first[position]) & (
        np.isnan(options.eta_second) | (options.eta_second == choice.eta_second[position])
    )
    kept = {name: getattr(options, name)[same] for name in Options.__slots__}
    kept["side"] = np.full(int(same.sum()), choice.side[position], dtype=np.int64)
    return Options(**kept)


def _discs(shapes: list[DiscShape]) -> Floats:
    rows = [(*shape.centre, shape.radius_m + MARGIN_M) for shape in shapes]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
