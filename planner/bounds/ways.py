"""The lower bound of a plan: over every way its regions may be seen by any method.

Two bounds are looked for, and the better one counts.

- Of units (``units``) none of which is near another: each is seen by passes of its own, in one pass, strip by
  strip, or as ``auto`` divides it; where both occur the bound is the least over both. Units near these are
  left out: seeing them as well is no shorter.
- Of all units, where passes may be shared: a pass for each, and for places far from each other in wide ones,
  or parts of one longer pass wherever they lie on one line.

A unit near others that no single pass sees together with them may be seen in two parts by passes over
several of them: of such a one a single place counts.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence

import numpy as np
from numpy.typing import NDArray

from planner.bounds.lower import EXACT_UP_TO, GAPS, exact_effort, lower_bound_m
from planner.bounds.nodes import nodes, terminal
from planner.bounds.search import exact_bound_m
from planner.bounds.units import Sides, Unit, apart, groups, hull_of, near, seen_at_once, spread, units
from planner.coverage import decompose
from planner.coverage.merge import MergedRegion
from planner.coverage.strips.targets import targets
from planner.coverage.visible import Seeing
from planner.errors import InfeasibleError
from planner.progress import Stop, never
from planner.route import Terminal
from planner.sensors.sar import SarSensor

Flags = NDArray[np.bool_]

#: Units taken in several ways that are told apart.
MOST_APART = 3
#: Of wide units so many places at most are seen by shared passes, all units together.
MOST_PLACES = 11
#: Lines between cells to evaluate where places stand for what is wide.
EFFORT_PLACES = 1_500_000


def plan_bound_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    length_m: float,
    left_out: Collection[str] = (),
    stop: Stop = never,
    enough: Stop = never,
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
    stop, enough
        The one cancels; the other ends the search for a better bound.
    """
    best_m = math.dist(ends[0].position, ends[1].position)
    if not all(isinstance(seeing.suite.of(region), SarSensor) for region in seeing.regions):
        # Nothing is known of how other sensors' passes may lie.
        return min(best_m, length_m)

    def sensing_of(region: MergedRegion) -> tuple[SarSensor, float]:
        return _sensing(seeing, region)

    found = units(seeing.regions, sensing_of, left_out)
    if found:
        linked = near(found, seeing.model.settle_m)
        # Where nothing is shared the first says most, as a rule, else the second.
        ways = (_of_shared_m, _of_apart_m) if linked.any() else (_of_apart_m, _of_shared_m)
        for bound in ways:
            if best_m < length_m * (1.0 - GAPS[0]) and not enough():
                best_m = max(best_m, bound(seeing, ends, found, linked, length_m, stop, enough))
    return min(best_m, length_m)


def _of_shared_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    found: Sequence[Unit],
    linked: Flags,
    length_m: float,
    stop: Stop,
    enough: Stop,
) -> float:
    """Of all units, or of as many places as the order can be searched for; 0 where nothing can be shared."""
    if not linked.any() and all(unit.whole for unit in found):
        return 0.0
    asked = _pieces(found, _in_parts(found, linked))
    passes = [node for k, (_, sides) in enumerate(asked) for node in nodes(sides, seeing.model.settle_m, k)]
    of = [k for k, _ in asked]
    # Of one unit two places may be seen by one pass; two visits are two passes.
    shared = np.array([[a != b or not found[a].whole for b in of] for a in of])
    np.fill_diagonal(shared, False)
    between = (terminal(ends[0]), terminal(ends[1]))
    targets_m = tuple(length_m * (1.0 - gap) for gap in GAPS)
    radius_m = seeing.model.turn_radius_m
    work = exact_effort(len(passes)) if all(unit.whole for unit in found) else EFFORT_PLACES
    return exact_bound_m(passes, *between, radius_m, targets_m, work, stop, enough, shared)


def _pieces(found: Sequence[Unit], parts: Collection[int]) -> list[tuple[int, Sides]]:
    """What is to be seen of each unit, its index and ways: as much as the order can be searched for."""
    asked: list[tuple[int, Sides]] = []
    for k, unit in enumerate(found):
        if unit.whole:
            asked += [(k, unit.place if k in parts else unit.sides)] * unit.visits
    rest = [k for k, unit in enumerate(found) if not unit.whole]
    if len(asked) > EXACT_UP_TO:
        asked, rest = [], list(range(len(found)))
    elif all(found[k].region.axis is not None for k in rest):
        legs = [(leg_m, k, sides) for k in rest for leg_m, sides in found[k].legs]
        legs.sort(key=lambda leg: -leg[0])
        return asked + [(k, sides) for _, k, sides in legs[: EXACT_UP_TO - len(asked)]]
    most = MOST_PLACES if rest else EXACT_UP_TO
    places = spread([found[k] for k in rest], most - len(asked))
    return asked + [(rest[k], found[rest[k]].seeing(place)) for k, place in places]


def _in_parts(found: Sequence[Unit], linked: Flags) -> set[int]:
    """Units that passes over several may see in parts: near each other, and too wide for a single pass."""
    parts: set[int] = set()
    for group in groups(linked):
        if len(group) == 1:
            continue
        first = found[group[0]]
        together = MergedRegion((), hull_of([found[k].region.area for k in group]), (), ())
        if not seen_at_once(together, first.sensor, first.height_m):
            parts.update(group)
    return parts


def _of_apart_m(
    seeing: Seeing,
    ends: tuple[Terminal, Terminal],
    found: Sequence[Unit],
    linked: Flags,
    length_m: float,
    stop: Stop,
    enough: Stop,
) -> float:
    """Of units none of which is near another."""
    parts = _in_parts(found, linked)
    chosen = apart(found, linked)
    ways: list[list[list[Sides]]] = []
    divided = 0
    for k in chosen:
        unit = found[k]
        if unit.whole:
            ways.append([[unit.place if k in parts else unit.sides] * unit.visits])
        elif decompose.is_plain(unit.region.area):
            ways.append([[unit.swept] * unit.visits])
        elif unit.region.axis is not None or divided == MOST_APART:
            ways.append([[unit.place] * unit.visits])
        else:
            ways.append([[unit.swept] * unit.visits, *_divided(seeing, unit)])
            divided += len(ways[-1]) > 1
    every = list(itertools.product(*ways))
    least_m = length_m
    for taken in every:
        if enough():
            return 0.0
        together = [each for of_unit in taken for each in of_unit]
        # Of the next way no more is worth proving than of the worst so far.
        worth_m = min(least_m / (1.0 - GAPS[0]), length_m)
        part = 1.0 / len(every)
        proved_m = lower_bound_m(ends, seeing.model, together, worth_m, part=part, stop=stop, enough=enough)
        least_m = min(least_m, proved_m)
    return least_m


def _divided(seeing: Seeing, unit: Unit) -> list[list[Sides]]:
    """The unit as ``auto`` divides it, where it does."""
    around = seeing.surroundings()
    try:
        found = targets(unit.region, unit.sensor, unit.height_m, around)
    except InfeasibleError:
        return []
    return [[target.sides for target in found]] if len(found) > unit.visits else []


def _sensing(seeing: Seeing, region: MergedRegion) -> tuple[SarSensor, float]:
    sensor, height_m = seeing.suite.over(region.sensor, region.area, seeing.airspace, seeing.level)
    assert isinstance(sensor, SarSensor)
    return sensor, height_m
