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
5. A coarse grid of many families may hide the better order, and regions are divided by an estimate that knows
   nothing of the tour: tours with pairs of passes alone instead of sweeps, and with a divided region whole,
   are found as well and kept where they cost less.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from planner.coverage.segments import Neighbourhood
from planner.coverage.sweeps import Side
from planner.errors import Finding, InfeasibleError
from planner.progress import Progress, Stop, never, raise_if, silent
from planner.route import CollectPass, Route
from planner.routing import tour
from planner.routing.joint import kernels
from planner.routing.joint.chain import from_start, layers_of, to_end, true_choice
from planner.routing.joint.hidden import see_hidden
from planner.routing.joint.options import Options, Surroundings, hidden_m
from planner.routing.joint.split import split_passes
from planner.routing.joint.targets import coarse_options
from planner.routing.joint.tours import Choice, Tours
from planner.routing.joint.visible import Visible, surroundings, visible
from planner.routing.large.order import large_order
from planner.routing.legs import Legs
from planner.scenario import Scenario
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.wind import still_air_costs

COARSE_STEP_RAD = math.radians(10.0)
COARSE_ETAS = np.array([0.0, 0.5, 1.0])
#: Beyond this many regions the order is searched locally, over fewer options.
EXACT_ORDER_UP_TO = 9
LARGE_STEP_RAD = math.radians(15.0)
LARGE_ETAS = np.array([0.0, 1.0])
#: Divided regions, from the first, for which the tour with the region whole is found too.
MOST_WHOLE = 3
#: Tours with their legs flown in earnest, those of them to which true costs are fed back, and how often.
TRUE_TOURS = 4
TRUE_SOLVES = 12
#: A tour that costs this much more than was thought is chosen anew.
FALSE_M = 5.0
#: Options with true costs: a little finer and a little wider than the last refinement, angle and offset.
TRUE_STEPS = ((math.radians(5.0), 0.125), (math.radians(1.25), 0.03))


@dataclass(frozen=True, slots=True)
class JointRoute:
    """The chosen route; regions that are not required and cannot be seen; the true cost in metres.

    ``sides`` are the ways to see each region, part of one or visit to one that were chosen from.
    """

    route: Route
    dropped: tuple[Finding, ...]
    cost_m: float
    sides: tuple[tuple[Side, ...], ...]


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
    legs = Legs(scenario, aircraft, stop)
    seen = visible(scenario, around)
    if not seen.regions:
        raise InfeasibleError("swath", "scenario", "no region can be seen", "see the findings", None)
    progress("routing", 0.0)
    cost_m, passes = _route(seen, scenario, around, legs, progress, stop, enough)
    fewer = _fewer(seen)
    if fewer is not seen and not enough():
        cost_m, passes = min(
            (cost_m, passes),
            _route(fewer, scenario, around, legs, silent, stop, enough),
            key=lambda found: found[0],
        )
    whole: frozenset[int] = frozenset()
    for index in seen.divided[:MOST_WHOLE]:
        trial = visible(scenario, around, whole | {index})
        if enough() or index in trial.divided:
            continue
        trial_m, trial_passes = _route(trial, scenario, around, legs, silent, stop, enough)
        if trial_m < cost_m - 1e-6:
            cost_m, passes, seen, whole = trial_m, trial_passes, trial, whole | {index}
    return JointRoute(Route(passes), seen.dropped, cost_m, seen.sides)


def _fewer(seen: Visible) -> Visible:
    """The same with pairs of passes alone where there are sweeps too; ``seen`` where there are none."""
    sides = tuple(
        tuple(side for side in of_region if isinstance(side, Neighbourhood)) or of_region
        for of_region in seen.sides
    )
    return seen if sides == seen.sides else replace(seen, sides=sides)


def _route(
    seen: Visible,
    scenario: Scenario,
    around: Surroundings,
    legs: Legs,
    progress: Progress,
    stop: Stop,
    enough: Stop,
) -> tuple[float, tuple[CollectPass, ...]]:
    """The passes of all regions, so divided, and what they cost in truth."""
    exact = len(seen.regions) <= EXACT_ORDER_UP_TO
    step_rad, etas = (COARSE_STEP_RAD, COARSE_ETAS) if exact else (LARGE_STEP_RAD, LARGE_ETAS)
    angles_rad = np.arange(-math.pi, math.pi - 1e-9, step_rad, dtype=np.float64)
    coarse = []
    for region, of_region in zip(seen.regions, seen.sides, strict=True):
        raise_if(stop)
        coarse.append(coarse_options(region, of_region, angles_rad, etas, around))
    tours = Tours(scenario, around, seen.regions, seen.sides)
    candidates = _orders(tours, coarse, progress, stop, enough)
    refined = []
    for index, choice in enumerate(candidates):
        raise_if(stop)
        progress("routing", 0.4 + 0.3 * index / len(candidates))
        refined.append(tours.refined(choice))
    cost_m, passes = _truest(tours, refined, legs, progress, stop, enough)
    cost_m, passes = split_passes(cost_m, passes, legs, stop)
    if scenario.terrain is not None and scenario.method.coverage != "li2018":
        more = see_hidden(scenario, around, passes, legs, stop)
        if more is not passes:
            passes, cost_m = more, legs.tour_m(more)
    return cost_m, passes


def _truest(
    tours: Tours, choices: list[Choice], legs: Legs, progress: Progress, stop: Stop, enough: Stop
) -> tuple[float, tuple[CollectPass, ...]]:
    """The tour that truly costs least, and its passes.

    Where flying a tour costs more than was thought, options round its own are tried with true costs. Ground
    left in shadow counts as in the options, but not in the cost given back.
    """
    best_m, best = math.inf, tours.passes(choices[0])
    choices = sorted(choices, key=lambda choice: choice.cost_m)[:TRUE_TOURS]
    for index, choice in enumerate(choices):
        raise_if(stop)
        progress("routing", 0.7 + 0.3 * index / len(choices))
        passes = tours.passes(choice)
        true_m = legs.tour_m(passes) + tours.shadow_m(choice)
        if true_m < best_m:
            best_m, best = true_m, passes
        if true_m - choice.cost_m <= FALSE_M or choice.cost_m >= best_m or enough():
            continue
        for step_rad, step_eta in TRUE_STEPS:
            layers, of_places = tours.layers(choice, step_rad, step_eta)
            besides = partial(_besides, of_places, tours.around)
            found_m, picked = true_choice(layers, of_places, legs, TRUE_SOLVES, stop, besides)
            if not found_m < true_m - 1e-6:
                continue
            true_m = found_m
            choice = choice.picked(layers.options, picked, found_m)
            passes = tours.passes(choice)
            if true_m < best_m:
                best_m, best = true_m, passes
    return legs.tour_m(best), best


def _besides(
    of_places: list[tuple[Side, ...]], around: Surroundings, place: int, passes: Sequence[CollectPass]
) -> float:
    return hidden_m(of_places[place][0], passes, around)


def _orders(
    tours: Tours, options: list[Options], progress: Progress, stop: Stop, enough: Stop
) -> list[Choice]:
    """Candidate tours over the coarse options, cheapest first."""
    scenario, around = tours.scenario, tours.around
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
        totals, orders = kernels.best_orders(first, between, last, offsets)
        return [
            _choice(options, offsets, chosen, cost)
            for cost, chosen in sorted(zip(totals.tolist(), orders.tolist(), strict=True))
            if math.isfinite(cost)
        ]
    centroids = np.array([region.centroid for region in tours.regions])
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


def _choice(options: list[Options], offsets: NDArray[np.int64], chosen: list[int], cost_m: float) -> Choice:
    """The tour of options counted over all regions."""
    order = [int(np.searchsorted(offsets, option, side="right")) - 1 for option in chosen]
    picked = [int(option - offsets[region]) for option, region in zip(chosen, order, strict=True)]
    return Choice.of(order, [options[region] for region in order], picked, cost_m)
