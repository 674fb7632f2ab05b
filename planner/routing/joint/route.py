"""Order, approach angle, offset and look side chosen together: the planner's own ``auto``.

Li, Chen, Wang, Li (2018) choose them one after the other; here each region offers its ways to be seen, and
the tour takes one of each at the least whole length, exactly over the order for a dozen regions or fewer.

1. A coarse grid of angles and offsets; Dubins lengths between all options, with what going round threat
   discs adds; dynamic programming over subsets of regions and last options, or local search (``large``).
2. For the best order with each region last, finer grids round the chosen options, halving the step, with a
   shortest path through the layers of options; the best is fitted to whatever may lie round each (``freed``).
3. Costs between options are estimates where discs or zones are in the way: the legs of the tours found are
   flown in earnest, their true costs fed back (``chain``), and the tours compared by true cost.
4. Passes of one region are parted where others fit between (``split``), and passes added for ground that
   stays unseen (``complete``).
5. A coarse grid of many families may hide the better order, and regions are divided by an estimate that knows
   nothing of the tour: tours with pairs of passes alone instead of sweeps, with a divided region whole, and
   with a corridor leg by leg are found as well and kept where they cost less.
6. Regions that one pass sees share it where that is shorter (``shared``).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.visible import Visible
from planner.coverage.ways import Division, Options, Sharing, Target
from planner.dubins.estimate_kernels import transit_costs
from planner.errors import InfeasibleError, nothing_seen
from planner.orders_kernels import best_orders
from planner.progress import Progress, Stop, in_time, never, raise_if, silent
from planner.route import CollectPass, Route, Terminal
from planner.routing import tour
from planner.routing.joint.chain import from_start, layers_of, to_end, true_choice
from planner.routing.joint.freed import freed
from planner.routing.joint.shared import Exchange
from planner.routing.joint.split import split_passes
from planner.routing.joint.tours import Choice, Tours
from planner.routing.large.order import large_order
from planner.routing.legs import Legs
from planner.vehicle.wind import still_air_costs

COARSE_STEP_RAD = math.radians(10.0)
COARSE_ETAS = np.array([0.0, 0.5, 1.0])
#: Beyond this many regions the order is searched locally, over fewer options.
EXACT_ORDER_UP_TO = 9
LARGE_STEP_RAD = math.radians(15.0)
LARGE_ETAS = np.array([0.0, 1.0])
#: Regions, from the first, for which the tour with the region whole, or leg by leg, is found too.
MOST_WHOLE = 3
#: How regions are seen where nothing else can be flown.
ROOMY: Division = "roomy"
#: Times that passes are shared: at first by as few passes as can be, then in the tour found last.
SHARED_ROUNDS = 4
#: Tours with their legs flown in earnest, those of them to which true costs are fed back, and how often.
TRUE_TOURS = 8
TRUE_SOLVES = 12
#: Tours whose passes are put in the order that is best for the tour, so many; of those with a heading so far
#: from the others'.
FITTED_TOURS, UNLIKE_RAD = 5, math.radians(2.0)
#: Tours made of what the others have chosen of each target, and fitted again.
CROSSED_TOURS = 2
#: Tours of so many regions at most are freed so often, over options at this step and these offsets.
MOST_FREED, FREED_ROUNDS = 30, 4
FREED_STEP_RAD, FREED_ETAS = math.radians(5.0), np.linspace(0.0, 1.0, 5)
#: Tours refined to costs this close are one.
SAME_M = 1e-3
#: A tour that costs this much more than was thought is chosen anew.
FALSE_M = 5.0
#: Options with true costs: a little finer and a little wider than the last refinement, angle and offset.
TRUE_STEPS = ((math.radians(5.0), 0.125), (math.radians(1.25), 0.03))


#: The targets with some merged regions, by their numbers, divided in certain ways.
Divided = Callable[[Mapping[int, Division]], Visible]
#: Which of some targets may be seen in one pass.
Share = Callable[[Sequence[Target]], Sharing]
#: A tour's passes with others besides, for ground it leaves unseen; the same where nothing is to be added.
Complete = Callable[[tuple[CollectPass, ...], Legs], tuple[CollectPass, ...]]


@dataclass(frozen=True, slots=True)
class JointRoute:
    """The chosen route, the true cost in metres, and the targets it was chosen among."""

    route: Route
    cost_m: float
    seen: Visible


@dataclass(frozen=True, slots=True)
class Search:
    """What one search for a tour goes by.

    Parameters
    ----------
    ends
        Where the tour starts and ends.
    complete
        Adds passes to the tours found.
    stop, enough
        The one cancels; the other ends the search for anything better.
    """

    ends: tuple[Terminal, Terminal]
    around: Surroundings
    legs: Legs
    seed: int
    complete: Complete
    progress: Progress = silent
    stop: Stop = never
    enough: Stop = never


def joint_route(search: Search, seen: Visible, divided: Divided, share: Share) -> JointRoute:
    """Choose the passes of all targets and their order together.

    Raises
    ------
    InfeasibleError
        Where a target has no option that keeps the hard constraints.
    CancelledError
        Once ``stop`` says so.
    """
    if not seen.targets:
        raise nothing_seen(seen.dropped)
    search.progress("routing", 0.0)
    cost_m, passes = _route(seen, search)
    plain = tuple(target.plain() for target in seen.targets)
    if any(one is not other for one, other in zip(plain, seen.targets, strict=True)) and not search.enough():
        fewer = _tried(replace(seen, targets=plain), search)
        cost_m, passes = min((cost_m, passes), fewer, key=lambda found: found[0])
    kept: dict[int, Division] = {}
    if math.isinf(cost_m):
        # No leg leads to passes without room for a turn: more passes may have it.
        roomy = dict.fromkeys(range(len(seen.targets) + len(seen.dropped)), ROOMY)
        trial = divided(roomy)
        trial_m, trial_passes = _tried(trial, search)
        if trial_m < cost_m:
            cost_m, passes, seen, kept = trial_m, trial_passes, trial, dict(roomy)
    others: list[tuple[int, Division]] = [(index, "whole") for index in seen.divided[:MOST_WHOLE]]
    others += [(index, "legs") for index in seen.bent[:MOST_WHOLE]]
    for index, division in others:
        if search.enough():
            break
        try:
            trial = divided(kept | {index: division})
        except InfeasibleError:
            # So divided it cannot be seen; otherwise it can.
            continue
        if (division == "whole" and index in trial.divided) or _alike(trial, seen):
            continue
        trial_m, trial_passes = _tried(trial, search)
        if trial_m < cost_m - 1e-6:
            cost_m, passes, seen, kept = trial_m, trial_passes, trial, kept | {index: division}
    sharing = None
    for number in range(SHARED_ROUNDS):
        if search.enough():
            break
        sharing = sharing or share(seen.targets)
        exchange = Exchange(seen.targets, sharing, search.ends, search.around, search.legs)
        shared = exchange.shared(passes, search.stop, search.enough) if number else exchange.fewest()
        if shared is not None:
            trial = replace(seen, targets=shared)
            trial_m, trial_passes = _tried(trial, search)
            if trial_m < cost_m - 1e-6:
                cost_m, passes, seen, sharing = trial_m, trial_passes, trial, None
                continue
        if number:
            break
    return JointRoute(Route(passes), cost_m, seen)


def _tried(seen: Visible, search: Search) -> tuple[float, tuple[CollectPass, ...]]:
    """The passes of targets that may be had for less otherwise; none, at any price, where time ends that, or
    where one of them has none that may be flown: zones and area are not looked at before.
    """

    def route(stop: Stop) -> tuple[float, tuple[CollectPass, ...]]:
        try:
            return _route(seen, replace(search, progress=silent, stop=stop))
        except InfeasibleError:
            return math.inf, ()

    return in_time(route, search.stop, search.enough) or (math.inf, ())


def _alike(one: Visible, other: Visible) -> bool:
    """Whether both have the same targets."""
    return [target.region.area for target in one.targets] == [target.region.area for target in other.targets]


def _route(seen: Visible, search: Search) -> tuple[float, tuple[CollectPass, ...]]:
    """The passes of all targets, and what they cost in truth."""
    exact = len(seen.targets) <= EXACT_ORDER_UP_TO
    step_rad, etas = (COARSE_STEP_RAD, COARSE_ETAS) if exact else (LARGE_STEP_RAD, LARGE_ETAS)
    coarse = []
    for target in seen.targets:
        raise_if(search.stop)
        coarse.append(target.coarse(step_rad, etas))
    tours = Tours(search.ends, search.around, seen.targets)
    candidates = _orders(tours, coarse, search)
    if exact:
        candidates += tours.alternatives(candidates[0], coarse)
    refined: list[Choice] = []
    for index, choice in enumerate(candidates):
        raise_if(search.stop)
        if refined and search.enough():
            break
        search.progress("routing", 0.4 + 0.3 * index / len(candidates))
        refined.append(tours.refined(choice))
    likely = _unlike(sorted(refined, key=lambda choice: choice.cost_m))
    fitted = [tours.fitted(choice) for choice in likely[:FITTED_TOURS] if not search.enough()]
    if len(seen.targets) > 1:
        crossed = sorted(tours.crossed(refined + fitted), key=lambda choice: choice.cost_m)
        fitted += [tours.fitted(choice) for choice in crossed[:CROSSED_TOURS] if not search.enough()]
    if len(seen.targets) <= MOST_FREED and not search.enough():
        fitted += _freed(tours, refined + fitted, search)
    cost_m, passes = _truest(tours, refined + fitted, search)
    cost_m, passes = split_passes(cost_m, passes, search.legs, search.stop, search.enough)
    more = search.complete(passes, search.legs)
    return (cost_m, passes) if more is passes else (search.legs.tour_m(more), more)


def _freed(tours: Tours, choices: list[Choice], search: Search) -> list[Choice]:
    """What the cheapest tour becomes where each place is fitted to all that may lie round it."""
    choice = min(choices, key=lambda choice: choice.cost_m)
    wide = {}
    for number in choice.order:
        raise_if(search.stop)
        wide[number] = tours.targets[number].coarse(FREED_STEP_RAD, FREED_ETAS)
    found: list[Choice] = []
    for _ in range(FREED_ROUNDS):
        free = freed(tours, choice, wide)
        if search.enough() or not free.cost_m < choice.cost_m - SAME_M:
            break
        choice = tours.fitted(free)
        found.append(choice)
    return found


def _truest(tours: Tours, choices: list[Choice], search: Search) -> tuple[float, tuple[CollectPass, ...]]:
    """The tour that truly costs least, and its passes.

    Where flying a tour costs more than was thought, options round its own are tried with true costs. Ground
    left in shadow counts as in the options, but not in the cost given back.
    """
    legs, stop = search.legs, search.stop
    best_m, best = math.inf, tours.passes(choices[0])
    choices = _apart(sorted(choices, key=lambda choice: choice.cost_m))[:TRUE_TOURS]
    for index, choice in enumerate(choices):
        raise_if(stop)
        if index and search.enough():
            break
        search.progress("routing", 0.7 + 0.3 * index / len(choices))
        passes = tours.passes(choice)
        true_m = legs.tour_m(passes) + tours.shadow_m(choice)
        if true_m < best_m:
            best_m, best = true_m, passes
        if true_m - choice.cost_m <= FALSE_M or choice.cost_m >= best_m or search.enough():
            continue
        for step_rad, step_eta in TRUE_STEPS:
            layers, targets = tours.layers(choice, step_rad, step_eta), tours.visited(choice)
            besides = partial(_besides, targets)
            found_m, picked = true_choice(layers, targets, legs, TRUE_SOLVES, stop, besides)
            if not found_m < true_m - 1e-6:
                continue
            true_m = found_m
            choice = Choice.of(choice.order, layers.options, picked, found_m)
            passes = tours.passes(choice)
            if true_m < best_m:
                best_m, best = true_m, passes
    return legs.tour_m(best), best


def _apart(choices: list[Choice]) -> list[Choice]:
    """Of choices by cost, those that cost as much as the one before left out: they have come to the same."""
    before = [-math.inf, *(choice.cost_m for choice in choices)]
    return [
        choice for choice, last_m in zip(choices, before, strict=False) if choice.cost_m > last_m + SAME_M
    ]


def _unlike(choices: list[Choice]) -> list[Choice]:
    """Of choices by cost, those left out that have about the headings of a cheaper one in the same order."""
    kept: list[Choice] = []
    for choice in choices:
        if all(other.order != choice.order or other.turned_rad(choice) > UNLIKE_RAD for other in kept):
            kept.append(choice)
    return kept


def _besides(targets: Sequence[Target], place: int, passes: Sequence[CollectPass]) -> float:
    return targets[place].hidden_m(passes)


def _orders(tours: Tours, options: list[Options], search: Search) -> list[Choice]:
    """Candidate tours over the coarse options, cheapest first."""
    (start, end), around = tours.ends, tours.around
    offsets = np.concatenate([[0], np.cumsum([len(o.inner_m) for o in options])]).astype(np.int64)
    entries, exits, inner_m = (
        np.concatenate([getattr(o, name) for o in options]) for name in ("entries", "exits", "inner_m")
    )
    first = from_start(start, around, entries, around.discs) + inner_m
    last = to_end(end, around, exits, around.discs)
    if len(options) <= EXACT_ORDER_UP_TO:
        costs = transit_costs(exits, entries, around.radius_m, around.discs)
        wind = (around.airspeed_m_s, around.wind)
        between = still_air_costs(costs, exits[:, None], entries[None], *wind) + inner_m[None, :]
        totals, orders = best_orders(first, between, last, offsets)
        return [
            _choice(options, offsets, chosen, cost)
            for cost, chosen in sorted(zip(totals.tolist(), orders.tolist(), strict=True))
            if math.isfinite(cost)
        ]
    centroids = np.array([target.region.centroid for target in tours.targets])
    order = np.array(
        tour.order(centroids, start.position, end.position, "exact", search.seed),
        dtype=np.int64,
    )
    ends = (first, last, around, around.discs)
    controls = (search.seed, search.progress, search.stop, search.enough)
    _, better = large_order([order, order[::-1].copy()], centroids, options, *ends, *controls)
    layers = layers_of(tours.ends, around, [options[c] for c in better], around.discs)
    cost, picked = layers.best()
    chosen = [int(offsets[c]) + option for c, option in zip(better, picked, strict=True)]
    return [_choice(options, offsets, chosen, cost)]


def _choice(options: list[Options], offsets: NDArray[np.int64], chosen: list[int], cost_m: float) -> Choice:
    """The tour of options counted over all regions."""
    order = [int(np.searchsorted(offsets, option, side="right")) - 1 for option in chosen]
    picked = [int(option - offsets[region]) for option, region in zip(chosen, order, strict=True)]
    return Choice.of(order, [options[region] for region in order], picked, cost_m)
