"""The lower bound of a plan: over every way its regions may be seen by any method.

Three bounds are looked for, and the best one counts.

- Of the ground to be seen, as much as a swath sees, and the ways to it: known at once.
- Of units (``units``) none of which is near another: each is seen by passes of its own, in one pass, strip by
  strip, or as ``auto`` divides it; where both occur the bound is the least over both. Units near these are
  left out: seeing them as well is no shorter. Near a wide one their ground counts, as much as a swath sees.
- Of all units, where passes may be shared: a pass for each, and for places far from each other in wide ones,
  or parts of one longer pass wherever they lie on one line; of the furthest and longest first.

A unit near others that no single pass sees together with them may be seen in two parts by passes over
several of them: of such a one a single place counts.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.bounds.allowance import Allowance
from planner.bounds.lower import EXACT_UP_TO, GAPS, lower_bound_m
from planner.bounds.nodes import nodes, terminal
from planner.bounds.partitions import alike, partitions_bound_m
from planner.bounds.search import exact_bound_m
from planner.bounds.sweeps import sweeps_bound_m
from planner.bounds.units import Sides, Unit, apart, groups, hull_of, near, pieces, seen_at_once, units
from planner.coverage import decompose
from planner.coverage.merge import GRID_M, MergedRegion
from planner.coverage.strips.targets import targets
from planner.coverage.visible import Seeing
from planner.errors import InfeasibleError
from planner.progress import Stop, never
from planner.route import Terminal
from planner.sensors.sar import SarSensor

Flags = NDArray[np.bool_]

#: The ways to see what is asked for, and the ground of all that passes there may see besides.
Asked = tuple[Sides, BaseGeometry | None]

#: Units taken in several ways that are told apart, and dividing one takes as long as so many lines.
MOST_APART, LINES_DIVIDED = 3, 200_000
#: Units and places asked for, where passes are shared, and lines between cells to evaluate of them: at first
#: and then, no more than a part of what is left. More are asked for until so many say less.
COUNTS = {1: 0.05, 2: 0.1, 3: 0.15, 5: 0.4, 8: 0.5, EXACT_UP_TO: 0.5}
EFFORTS_SHARED, PART_THEN, FALLS = (300_000, 2_500_000), 0.6, 2
#: Most is wide that takes so many times what the rest is long.
MUCH = 2.0
#: Of what is allowed, the first of two bounds takes no more, where most is wide, and the first of the two for
#: shared passes.
PART_FIRST, PART_FIRST_WIDE, PART_FIRST_SHARED = 0.7, 0.9, 0.5


def plan_bound_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    length_m: float,
    left_out: Collection[str] = (),
    stop: Stop = never,
    allowance: Allowance | None = None,
) -> float:
    """No plan over these regions is shorter, whatever its method.

    Parameters
    ----------
    seeing, ends
        What is to be seen by whom, from where to where.
    length_m
        Of a plan.
    left_out
        Names of regions that the plan leaves out.
    stop, allowance
        The one cancels; the other is for the search for a better bound.
    """
    allowance = allowance or Allowance()
    best_m = math.dist(ends[0].position, ends[1].position)
    if not all(isinstance(seeing.suite.of(region), SarSensor) for region in seeing.regions):
        # Nothing is known of how other sensors' passes may lie.
        return min(best_m, length_m)

    def sensing_of(region: MergedRegion) -> tuple[SarSensor, float]:
        return _sensing(seeing, region)

    found = units(seeing.regions, sensing_of, left_out)
    if found:
        if best_m == 0.0:
            # A loop holds a circle (Pestov and Ionin; a corner at its base does not matter).
            best_m = 2.0 * math.pi * seeing.model.turn_radius_m
        linked = near(found, seeing.model.settle_m)
        best_m = max(best_m, _of_ground_m(seeing, ends, found, linked, stop, allowance))
        # Where nothing is shared the first says most, as a rule, and where most is seen strip by strip; else
        # the second.
        ways, part_first = [_of_apart_m, _of_shared_m], PART_FIRST
        if _mostly_wide(found):
            part_first = PART_FIRST_WIDE
        elif linked.any():
            ways = [_of_shared_m, _of_apart_m]
        if not linked.any() and all(unit.whole for unit in found):
            # Nothing can be shared.
            ways = [_of_apart_m]
        for k, bound in enumerate(ways, start=1):
            if best_m < length_m * (1.0 - GAPS[0]) and not allowance.over:
                part = allowance.part(allowance.left * (1.0 if k == len(ways) else part_first))
                best_m = max(best_m, bound(seeing, ends, found, linked, length_m, stop, part))
    return min(best_m, length_m)


def _mostly_wide(found: Sequence[Unit]) -> bool:
    """Whether seeing wide units takes much more than the others are long."""
    wide_m = sum(unit.flown_m for unit in found if not unit.whole)
    others = (unit.region.area for unit in found if unit.whole)
    return wide_m > MUCH * sum(2.0 * float(shapely.minimum_bounding_radius(area)) for area in others)


def _of_ground_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    found: Sequence[Unit],
    linked: Flags,
    stop: Stop,
    allowance: Allowance,
) -> float:
    """Of the ground to be seen alone, and where it lies: known at once."""
    passes = []
    for k, group in enumerate(groups(linked)):
        main = max(group, key=lambda j: found[j].flown_m)
        node = nodes(found[main].sides, seeing.model.settle_m, k, ground=_ground(found, group))[0]
        passes.append(replace(node, seen=replace(node.seen, one_place=True)))
    between = (terminal(ends[0]), terminal(ends[1]))
    return sweeps_bound_m(passes, *between, seeing.model.turn_radius_m, math.inf, stop, allowance)


def _of_shared_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    found: Sequence[Unit],
    linked: Flags,
    length_m: float,
    stop: Stop,
    allowance: Allowance,
) -> float:
    """Of all units, or places of them, whichever passes see them together."""
    parts, targets_m = _in_parts(found, linked), tuple(length_m * (1.0 - gap) for gap in GAPS)
    model = seeing.model

    def by_sets_m(within: Allowance) -> float:
        return partitions_bound_m(found, parts, ends, model, targets_m, stop, within)

    def in_line_m(within: Allowance) -> float:
        return _in_line_m(seeing, ends, found, parts, targets_m, stop, within)

    ways = [by_sets_m, in_line_m]
    if not alike(found):
        ways = [in_line_m]
    elif any(unit.leg for unit in found):
        # Of chains of legs few are seen together, and their order says most.
        ways = [in_line_m, by_sets_m]
    best_m = 0.0
    for k, bound in enumerate(ways, start=1):
        if best_m < targets_m[0] and not allowance.over:
            part = 1.0 if k == len(ways) else PART_FIRST_SHARED
            best_m = max(best_m, bound(allowance.part(part * allowance.left)))
    return best_m


def _in_line_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    found: Sequence[Unit],
    in_parts: Collection[int],
    targets_m: tuple[float, ...],
    stop: Stop,
    allowance: Allowance,
) -> float:
    """Of as many as the order can be searched for: passes over them may lie on one line."""
    asked = pieces(found, in_parts, EXACT_UP_TO)
    ends_ = (terminal(ends[0]), terminal(ends[1]))

    def bound_of_m(most: int, effort: int, part: float) -> float:
        if allowance.over:
            return 0.0
        some = asked[:most]
        of = [k for k, _ in some]
        passes = [node for k, (_, each) in enumerate(some) for node in nodes(each, seeing.model.settle_m, k)]
        # Of one wide unit two places may be seen by one pass; two visits are two passes.
        shared = np.array([[a != b or not found[a].whole for b in of] for a in of])
        np.fill_diagonal(shared, False)
        within = allowance.part(part * allowance.left)
        return exact_bound_m(
            passes, *ends_, seeing.model.turn_radius_m, targets_m, effort, stop, within, shared
        )

    # A little of each at first: of few the bound is soon close.
    counts = sorted({min(n, len(asked)) for n in COUNTS})
    bounds_m: list[float] = []
    for most in counts:
        part = next(part for count, part in COUNTS.items() if most <= count)
        bounds_m.append(bound_of_m(most, EFFORTS_SHARED[0], part))
        best = int(np.argmax(bounds_m))
        if bounds_m[best] >= targets_m[0] or len(bounds_m) - 1 - best == FALLS:
            break
    best_m = bounds_m[best]
    for most in counts[best : best + 1 + FALLS]:
        if best_m < targets_m[0]:
            best_m = max(best_m, bound_of_m(most, EFFORTS_SHARED[1], PART_THEN))
    return best_m


def _in_parts(found: Sequence[Unit], linked: Flags) -> set[int]:
    """Units that passes over several may see in parts: near each other, and too wide for a single pass."""
    parts: set[int] = set()
    for group in groups(linked):
        if len(group) == 1:
            continue
        first = found[group[0]]
        whole = MergedRegion((), hull_of([found[k].region.area for k in group]), (), ())
        if not seen_at_once(whole, first.sensor, first.height_m):
            parts.update(k for k in group if not found[k].leg)
    return parts


def _of_apart_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    found: Sequence[Unit],
    linked: Flags,
    length_m: float,
    stop: Stop,
    allowance: Allowance,
) -> float:
    """Of units none of which is near another."""
    parts = _in_parts(found, linked)
    ways: list[list[list[Asked]]] = []
    divided = 0
    for group in groups(linked):
        main = max(group, key=lambda k: found[k].flown_m)
        if len(group) > 1 and not found[main].whole:
            ways.append([[(found[main].swept, _ground(found, group))] * found[main].visits])
            if not decompose.is_plain(found[main].region.area):
                # Divided it is seen along several headings; those near it are left out then.
                ways[-1] += _divided(seeing, found[main])
                allowance.spend(LINES_DIVIDED)
            continue
        for k in [group[j] for j in apart([found[k] for k in group], linked[np.ix_(group, group)])]:
            unit = found[k]
            if unit.whole:
                ways.append([[(unit.place if k in parts else unit.sides, None)] * unit.visits])
            elif decompose.is_plain(unit.region.area):
                ways.append([[(unit.swept, None)] * unit.visits])
            elif divided == MOST_APART:
                ways.append([[(unit.place, None)] * unit.visits])
            else:
                ways.append([[(unit.swept, None)] * unit.visits, *_divided(seeing, unit)])
                allowance.spend(LINES_DIVIDED)
                divided += len(ways[-1]) > 1
    every = list(itertools.product(*ways))
    least_m = length_m
    for number, taken in enumerate(every):
        if allowance.told:
            return 0.0
        sides, grounds = zip(*(each for of_unit in taken for each in of_unit), strict=True)
        # Of the next way no more is worth proving than of the worst so far.
        worth_m = min(least_m / (1.0 - GAPS[0]), length_m)
        part = allowance.part(allowance.left / (len(every) - number))
        proved_m = lower_bound_m(
            ends, seeing.model, sides, worth_m, None, 1.0 / len(every), stop, part, grounds=grounds
        )
        least_m = min(least_m, proved_m)
    return least_m


def _ground(found: Sequence[Unit], group: Sequence[int]) -> BaseGeometry:
    """What all passes over units near each other see together."""
    return shapely.union_all([found[k].region.area for k in group], grid_size=GRID_M)


def _divided(seeing: Seeing, unit: Unit) -> list[list[Asked]]:
    """The unit as ``auto`` divides it, where it does."""
    around = seeing.surroundings()
    try:
        found = targets(unit.region, unit.sensor, unit.height_m, around)
    except InfeasibleError:
        return []
    return [[(target.sides, None) for target in found]] if len(found) > unit.visits else []


def _sensing(seeing: Seeing, region: MergedRegion) -> tuple[SarSensor, float]:
    sensor, height_m = seeing.suite.over(region.sensor, region.area, seeing.airspace, seeing.level.of(region))
    assert isinstance(sensor, SarSensor)
    return sensor, height_m
