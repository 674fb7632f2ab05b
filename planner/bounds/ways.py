"""The lower bound of a plan: over every way its regions may be taken by any method.

Regions close together are merged, by every method; ``auto`` may then divide what was merged, the paper's
methods see it whole, or by its parts where that cannot be. One pass may see a region from where one method
finds room and another none. A bound holds for all of them where it is the least over these ways. Where more
regions are divided than are told apart, of the others one place each has to be seen, as it is by every way.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Sequence
from dataclasses import replace

from planner.bounds.lower import GAPS, lower_bound_m
from planner.bounds.nodes import PLACE_M
from planner.coverage.alternatives import families
from planner.coverage.merge import MergedRegion, merge_regions
from planner.coverage.segments import Neighbourhood
from planner.coverage.sweeps import Side
from planner.errors import InfeasibleError
from planner.progress import Stop, never
from planner.routing.joint.options import Surroundings
from planner.routing.joint.targets import targets
from planner.routing.joint.visible import sides_of, surroundings
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor
from planner.sensors.view import sensing
from planner.vehicle.aircraft import Aircraft
from planner.wishes import Method

#: Regions taken in several ways that are told apart.
MOST_APART = 3
#: How far a division may reach beyond a region.
BEYOND_M = 0.01

Sides = tuple[Side, ...]


def plan_bound_m(
    scenario: Scenario,
    aircraft: Aircraft,
    sides: Sequence[Sides] | None,
    length_m: float,
    left_out: Collection[str] = (),
    stop: Stop = never,
) -> float:
    """No plan over these regions is shorter, whatever its method.

    Parameters
    ----------
    sides
        The ways to see each region, part of one or visit to one that ``auto`` chose from; None where it is
        not asked.
    length_m
        Of a plan.
    left_out
        Names of regions that the plan leaves out.
    """
    straight_m = math.dist(scenario.start.position, scenario.end.position)
    least_m = length_m
    every = list(itertools.product(*_ways(scenario, aircraft, sides, left_out)))
    for taken in every:
        together = [each for of_region in taken for each in of_region]
        # Of the next way no more is worth proving than of the worst so far.
        worth_m = min(least_m / (1.0 - GAPS[0]), length_m)
        proved_m = 0.0
        if together:
            proved_m = lower_bound_m(scenario, aircraft, together, worth_m, part=1.0 / len(every), stop=stop)
        least_m = min(least_m, proved_m)
    return min(max(least_m, straight_m), length_m)


def _ways(
    scenario: Scenario, aircraft: Aircraft, sides: Sequence[Sides] | None, left_out: Collection[str]
) -> list[list[list[Sides]]]:
    """Of each region the ways it may be taken, of each of these its parts and visits by their sides."""
    if sides is None:
        try:
            sides = sides_of(replace(scenario, method=Method()), aircraft)
        except InfeasibleError:
            sides = ()
    found = [
        (region, _ways_of(scenario, aircraft, region, sides))
        for region in merge_regions(scenario.regions, default_sensor=scenario.sensors[0].name)
        if not set(region.names) & set(left_out)
    ]
    apart = sorted(
        (k for k, (_, ways) in enumerate(found) if len(ways) > 1), key=lambda k: -found[k][0].area.area
    )
    return [
        [_place(scenario, region)] if k in apart[MOST_APART:] else ways
        for k, (region, ways) in enumerate(found)
        if ways
    ]


def _ways_of(
    scenario: Scenario, aircraft: Aircraft, region: MergedRegion, sides: Sequence[Sides]
) -> list[list[Sides]]:
    reach = region.area.buffer(BEYOND_M)
    parts = [of_part for of_part in sides if reach.covers(of_part[0].region.area)]
    if parts and all(of_part[0].region.area.equals(region.area) for of_part in parts):
        return [[_with_one_pass(scenario, region, of_visit) for of_visit in parts]]
    around = surroundings(scenario, aircraft)
    for pieces in ((region,), region.split()):
        try:
            found = [
                target.sides
                for piece in pieces
                for target in targets(piece, *_sensing(scenario, piece), around, wide=False)
            ]
        except InfeasibleError:
            continue
        if pieces == (region,):
            found = _with_sweeps(scenario, region, around, found)
        return [parts, found] if parts else [found]
    return [parts] if parts else []


def _with_sweeps(
    scenario: Scenario, region: MergedRegion, around: Surroundings, of_visits: list[Sides]
) -> list[Sides]:
    """What ``auto`` may fly over a region that it could have divided and left whole, beside the paper's."""
    swept = targets(region, *_sensing(scenario, region), around, whole=True)
    if len(swept) != len(of_visits):
        return of_visits
    return [(*sides, *target.sides) for sides, target in zip(of_visits, swept, strict=True)]


def _with_one_pass(scenario: Scenario, region: MergedRegion, sides: Sides) -> Sides:
    """Where several passes are flown for want of room, another method may find it for one."""
    if any(isinstance(side, Neighbourhood) and side.turns == 0 for side in sides):
        return sides
    try:
        least = next(families(region, *_sensing(scenario, region), wide=False))
    except InfeasibleError:
        return sides
    return (*sides, *(side for side in least if isinstance(side, Neighbourhood) and side.turns == 0))


def _place(scenario: Scenario, region: MergedRegion) -> list[Sides]:
    """One place of a region, as often as it is to be visited."""
    place = region.area.representative_point().buffer(PLACE_M, quad_segs=1)
    there = replace(region, area=place, originals=(place,) * len(region.names), owners=region.names)
    least = next(families(there, *_sensing(scenario, there), wide=False))
    return [least for _ in range(region.revisits)]


def _sensing(scenario: Scenario, region: MergedRegion) -> tuple[SarSensor, float]:
    asked = next((s for s in scenario.sensors if s.name == region.sensor), scenario.sensors[0])
    return sensing(scenario, asked, region.area)
