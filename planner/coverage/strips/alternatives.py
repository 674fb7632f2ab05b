"""What one region becomes on its way to the tour: parts, each with its families of passes, and visits."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage import decompose
from planner.coverage.merge import MergedRegion, polygons_of
from planner.coverage.strips.headings import first_visit_rad
from planner.coverage.strips.neighbourhood import neighbourhoods
from planner.coverage.strips.straight import Estimate, straight_parts
from planner.coverage.strips.sweeps import Side, Sweep, sweeps
from planner.errors import InfeasibleError
from planner.progress import Stop, never
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]

#: A division has to save this much of the estimated cost.
LEAST_SAVING = 0.01
#: Beyond this many parts a region is not divided further.
MOST_PARTS = 6
#: Corridors with more legs than this are flown leg by leg without trying to join them.
MOST_LEGS_TO_JOIN = 12
#: Corridors with more legs than this are not tried leg by leg beside their straight pieces.
MOST_LEGS = 24
#: Of the circle's share that each visit has to itself, this part is used: headings of two visits differ.
SHARE_USED = 0.8


def families(
    region: MergedRegion, sensor: SarSensor, height_m: float, *, wide: bool = True
) -> Iterator[tuple[Side, ...]]:
    """Families of passes that see a region, those with the fewest passes first.

    Parameters
    ----------
    wide
        Whether more than two swaths, and sweeps for two, are allowed; without, the paper's neighbourhoods.

    Raises
    ------
    InfeasibleError
        Where there is none.
    """
    anchored = wide
    # A spot is no strip: nothing longer than it is seen lane by lane.
    wide = wide and sensor.mode != "spotlight"
    try:
        least = neighbourhoods(region, sensor, height_m, anchored=anchored)
    except InfeasibleError:
        if not wide:
            raise
    else:
        yield (*least, *sweeps(region, sensor, height_m)) if wide and least[0].turns == 1 else least
        if least[0].turns == 0:
            try:
                two = neighbourhoods(region, sensor, height_m, turns=1, anchored=anchored)
            except InfeasibleError:
                two = ()
            more = sweeps(region, sensor, height_m) if wide else ()
            if two or more:
                yield (*two, *more)
    if wide:
        yield sweeps(region, sensor, height_m)
        yield sweeps(region, sensor, height_m, extra=1)


def parts_of(
    region: MergedRegion,
    estimate: Estimate,
    sensor: SarSensor,
    height_m: float,
    around: Surroundings,
    enough: Stop = never,
) -> tuple[MergedRegion, ...]:
    """The region whole, or the division of it that costs less.

    A corridor is cut into straight pieces, or at its bends and its legs joined again where one sweep of both
    is cheaper; merged regions are tried apart; other shapes are cut at reflex corners and beside holes, one
    cut after the other, as long as that saves and until it is enough: then the best so far is taken, if there
    is one.
    """
    best: tuple[MergedRegion, ...] = (region,)
    cost_m = estimate(best)

    def over() -> bool:
        return math.isfinite(cost_m) and enough()

    if over():
        return best
    alone = region.split() if len(region.originals) > 1 else (region,)
    along = tuple(part for each in alone for part in _along(each, estimate, sensor, height_m, around, over))
    for start in dict.fromkeys((alone, along)):
        if over():
            return best
        trial_m = estimate(start)
        if _saves(trial_m, cost_m):
            best, cost_m = start, trial_m
    straight = [part for part in along if all(part is not each for each in alone)]
    while len(best) < MOST_PARTS:
        trials = [
            (*best[:index], *(part.piece(piece) for piece in pieces), *best[index + 1 :])
            for index, part in enumerate(best)
            if all(part is not each for each in straight) and not decompose.is_plain(_ground(part))
            for pieces in decompose.cuts(_ground(part))
        ]
        costs = [estimate(trial) for trial in itertools.takewhile(lambda _: not over(), trials)]
        if not costs or not _saves(min(costs), cost_m):
            return best
        cost_m = min(costs)
        best = trials[costs.index(cost_m)]
    return best


def legs_of(region: MergedRegion) -> tuple[MergedRegion, ...] | None:
    """The region with its corridors cut at each bend; None where there is no bend, or too many of them."""
    found: list[MergedRegion] = []
    for each in region.split() if len(region.originals) > 1 else (region,):
        legs = None if each.axis is None else decompose.legs(each.originals[0], each.axis)
        found += [each] if legs is None else [each.piece(leg) for leg in legs]
    return tuple(found) if 1 < len(found) <= MOST_LEGS else None


def visits(region: MergedRegion) -> tuple[MergedRegion, ...]:
    """The region once for each visit asked for, each to be made from directions of its own."""
    if region.revisits == 1:
        return (region,)
    return tuple(replace(region, visit=(k, region.revisits)) for k in range(region.revisits))


def of_visit(region: MergedRegion, angles_rad: Floats, etas: Floats) -> tuple[Floats, Floats]:
    """Of headings and offsets, those meant for this visit.

    Each visit has its share of the circle, where fewer headings are allowed than visits asked for its share
    of the offsets instead, so that no line is flown twice the same way.
    """
    if region.visit is None:
        return angles_rad, etas
    k, count = region.visit
    if region.approach_rad is None:
        share_rad = math.tau / count
        off_rad = (
            np.mod(angles_rad - first_visit_rad(region.area) - k * share_rad + math.pi, math.tau) - math.pi
        )
        return angles_rad[np.abs(off_rad) <= SHARE_USED * share_rad / 2.0], etas
    allowed = np.unique(np.round(np.mod(np.asarray(region.approach_rad), math.tau), 9))
    if len(allowed) >= count:
        apart = np.abs(np.mod(angles_rad[:, None] - allowed[k::count] + math.pi, math.tau) - math.pi)
        return angles_rad[(apart < 1e-6).any(axis=1)], etas
    last = 1.0 + 1e-9 if k == count - 1 else (k + 1) / count - 1e-9
    return angles_rad, etas[(etas >= k / count) & (etas < last)]


def least_lanes(region: MergedRegion, sensor: SarSensor, height_m: float) -> int:
    """How many passes the region takes at its best heading."""
    sweep = Sweep(region, sensor, height_m)
    return int(sweep.lanes(sweep.angles_rad).min())


def _along(
    region: MergedRegion,
    estimate: Estimate,
    sensor: SarSensor,
    height_m: float,
    around: Surroundings,
    enough: Stop,
) -> tuple[MergedRegion, ...]:
    """A corridor in the straight pieces or legs that cost least; whole where that does, or it is none."""
    if region.axis is None:
        return (region,)
    found: list[tuple[MergedRegion, ...]] = [(region,)]
    straight = straight_parts(region, region.axis, estimate, sensor, height_m, around, enough)
    if straight is not None:
        found.append(straight)
    legs = decompose.legs(region.originals[0], region.axis)
    if legs is not None and (len(legs) <= MOST_LEGS_TO_JOIN or straight is None):
        found.append(_joined(tuple(region.piece(leg) for leg in legs), estimate, enough))
    costs_m = [estimate(parts) for parts in found]
    return found[costs_m.index(min(costs_m))]


def _joined(parts: tuple[MergedRegion, ...], estimate: Estimate, enough: Stop) -> tuple[MergedRegion, ...]:
    """Neighbouring legs of a corridor as one where that costs less."""
    cost_m = estimate(parts)
    while 1 < len(parts) <= MOST_LEGS_TO_JOIN and not enough():
        trials = []
        for k in range(len(parts) - 1):
            both = decompose.merged((parts[k].area, parts[k + 1].area))
            if both is not None:
                trials.append((*parts[:k], parts[k].piece(both), *parts[k + 2 :]))
        costs = [estimate(trial) for trial in itertools.takewhile(lambda _: not enough(), trials)]
        if not costs or min(costs) >= cost_m:
            return parts
        cost_m = min(costs)
        parts = trials[costs.index(cost_m)]
    return parts


def _saves(trial_m: float, cost_m: float) -> bool:
    return trial_m < (1.0 - LEAST_SAVING) * cost_m if math.isfinite(cost_m) else math.isfinite(trial_m)


def _ground(region: MergedRegion) -> shapely.Polygon:
    """What really has to be seen where that is one piece: the closing of outlines is the paper's."""
    pieces = polygons_of(shapely.union_all(list(region.originals), grid_size=1e-6))
    return pieces[0] if len(pieces) == 1 else region.area
