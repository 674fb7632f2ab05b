"""What a search sees, for the judge: from its published line and its sensor alone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.check.coverage import GRID_M
from planner.check.footprints import footprint
from planner.plan import Collect, Plan
from planner.scenario import Scenario
from planner.wishes import Drift, Importance, ImportancePatch, ImportancePoint, ImportanceRaster, Seen

Floats = NDArray[np.float64]

#: Ground that is worth the same is judged by this many places to its longer side, a point's to each spread.
SIDE, TO_SPREAD = 400, 25
#: Beyond so many standard deviations nothing of a point's worth is counted.
SPREADS = 5.0
#: What drifts is judged by this many places, drawn with a seed of the judge's own.
DRAWN, SEED = 20_000, 4_711


@dataclass(frozen=True, slots=True)
class Found:
    """What a search sees.

    Parameters
    ----------
    area_m2
        Of the ground searched, each place once.
    importance
        What that is worth, of a sensor that misses what its looks find; None where all ground is worth the
        same.
    total
        What all that is asked is worth; None as before.
    """

    area_m2: float
    importance: float | None
    total: float | None = None


def searched(scenario: Scenario, plan: Plan) -> Found:
    """Ground seen by all collects of a plan, and its worth."""
    ground = shapely.union_all([region.area for region in scenario.regions], grid_size=GRID_M)
    prints = [footprint(scenario, collect, plan) for collect in plan.collects]
    seen = shapely.intersection(shapely.union_all(prints, grid_size=GRID_M), ground, grid_size=GRID_M)
    importance = scenario.importance
    if not importance.given:
        return Found(float(seen.area), None)
    if importance.drift is not None:
        return Found(float(seen.area), *_drifting(scenario, plan, prints, importance, importance.drift))
    looks = [shapely.intersection(each, ground, grid_size=GRID_M) for each in prints]
    before = [look.area for look in importance.seen]
    miss = 1.0 - importance.detection
    worth, total = 0.0, 0.0
    # Where looks find all, what was seen before is no ground any more.
    sampled = miss > 0.0
    for patch in importance.patches:
        if not (sampled and before):
            total += patch.score * shapely.intersection(ground, patch.area, grid_size=GRID_M).area
        if not sampled:
            worth += patch.score * shapely.intersection(seen, patch.area, grid_size=GRID_M).area
    whole = len(importance.points) + (importance.raster is not None)
    for number, (places, scores, cell_m2) in enumerate(_samples(importance, patches=sampled)):
        inside = _inside(ground, places)
        there = scores[inside] * _missed(before, places[inside], miss)
        missed = _missed(looks, places[inside], miss)
        worth += float((there * (1.0 - missed)).sum()) * cell_m2
        if number < whole or before:
            total += float(there.sum()) * cell_m2
    return Found(float(seen.area), worth, total)


def _inside(shape: BaseGeometry, places: Floats) -> NDArray[np.bool_]:
    shapely.prepare(shape)
    return np.asarray(shapely.contains_xy(shape, places[:, 0], places[:, 1]))


def _missed(looks: Sequence[BaseGeometry], places: Floats, miss: float) -> Floats:
    """At each place how probable it is that no look has found what is there."""
    left = np.ones(len(places))
    for look in looks:
        if not look.is_empty:
            left[_inside(look, places)] *= miss
    return left


def _samples(importance: Importance, *, patches: bool) -> list[tuple[Floats, Floats, float]]:
    """Places (N, 2) of each source with scores (N,), and what ground each stands for."""
    found = [_of_point(point) for point in importance.points]
    if importance.raster is not None:
        found.append(_of_raster(importance.raster))
    return found + ([_of_patch(patch) for patch in importance.patches] if patches else [])


def _lattice(bounds: tuple[float, float, float, float], cell_m: float) -> Floats:
    """Middles of square cells over a rectangle, (N, 2)."""
    west_m, south_m, east_m, north_m = bounds
    east = np.arange(west_m + 0.5 * cell_m, east_m, cell_m)
    north = np.arange(south_m + 0.5 * cell_m, north_m, cell_m)
    return np.stack(np.meshgrid(east, north), axis=-1).reshape(-1, 2)


def _of_point(point: ImportancePoint) -> tuple[Floats, Floats, float]:
    reach_m, cell_m = SPREADS * point.spread_m, point.spread_m / TO_SPREAD
    (east_m, north_m) = point.position
    places = _lattice((east_m - reach_m, north_m - reach_m, east_m + reach_m, north_m + reach_m), cell_m)
    off = np.hypot(*(places - np.asarray(point.position)).T) / point.spread_m
    return places, point.score * np.exp(-0.5 * off**2), cell_m**2


def _of_patch(patch: ImportancePatch) -> tuple[Floats, Floats, float]:
    west_m, south_m, east_m, north_m = patch.area.bounds
    places = _lattice(patch.area.bounds, max(east_m - west_m, north_m - south_m) / SIDE)
    places = places[_inside(patch.area, places)]
    # So that all of them stand for all of it.
    return places, np.full(len(places), patch.score), patch.area.area / max(len(places), 1)


def _of_raster(raster: ImportanceRaster) -> tuple[Floats, Floats, float]:
    rows, columns = raster.scores.shape
    bounds = (
        raster.west_m, raster.south_m,
        raster.west_m + columns * raster.cell_m, raster.south_m + rows * raster.cell_m,
    )  # fmt: skip
    row, column = np.divmod(np.arange(rows * columns), columns)
    places = np.array(bounds[:2]) + raster.cell_m * (np.stack([column, row], axis=1) + 0.5)
    return places, raster.scores.ravel(), raster.cell_m**2


def _drifting(
    scenario: Scenario, plan: Plan, prints: Sequence[BaseGeometry], importance: Importance, drift: Drift
) -> tuple[float, float]:
    """What is found of something that drifts, and all of it.

    A collect looks at a place where that is when the aircraft is abeam of it on the line, or nearest to that.
    """
    rng = np.random.default_rng(SEED)
    sources = _samples(importance, patches=True)
    weights = np.concatenate([scores * cell_m2 for _, scores, cell_m2 in sources])
    at = np.concatenate([places for places, _, _ in sources])
    edge_m = np.concatenate([np.full(len(places), math.sqrt(cell_m2)) for places, _, cell_m2 in sources])
    total = float(weights.sum())
    drawn = rng.choice(len(weights), DRAWN, p=weights / total)
    places = at[drawn] + edge_m[drawn, None] * rng.uniform(-0.5, 0.5, (DRAWN, 2))
    moves = np.array([drift.east_m_s, drift.north_m_s]) + drift.spread_m_s * rng.standard_normal((DRAWN, 2))
    places = places + drift.elapsed_s * moves
    left = np.ones(DRAWN)
    for look in importance.seen:
        left[_inside(look.area, _swept(look, places, moves))] *= 1.0 - importance.detection
    before = left.mean()
    order = sorted(range(len(prints)), key=lambda k: plan.collects[k].start_s)
    for k in order:
        there = _abeam(scenario, plan.collects[k], places, moves)
        left[_inside(prints[k], there)] *= 1.0 - importance.detection
    return total * float(before - left.mean()), total * float(before)


def _swept(look: Seen, places: Floats, moves: Floats) -> Floats:
    """Where what drifts was when a look before the start came by."""
    if look.course_rad is None:
        return np.asarray(places + 0.5 * (look.begin_s + look.end_s) * moves)
    along = np.array([math.cos(look.course_rad), math.sin(look.course_rad)])
    corners = shapely.get_coordinates(look.area)
    corners = corners[np.argsort(corners @ along, kind="stable")]
    return _met(corners[0], corners[-1], along, look.begin_s, look.end_s, places, moves)


def _abeam(scenario: Scenario, collect: Collect, places: Floats, moves: Floats) -> Floats:
    """Where what drifts is when the aircraft comes nearest to it on a collect."""
    begin, end = scenario.frame.to_local([place[:2] for place in (collect.line[0], collect.line[-1])])
    along = (end - begin) / max(float(np.hypot(*(end - begin))), 1e-9)
    return _met(begin, end, along, collect.start_s, collect.end_s, places, moves)


def _met(
    begin: Floats, end: Floats, along: Floats, from_s: float, until_s: float, places: Floats, moves: Floats
) -> Floats:
    """Where what drifts is when a line across the course comes by that moves from one place to another."""
    lasts_s = max(until_s - from_s, 1e-9)
    speed_m_s = float((end - begin) @ along) / lasts_s
    ahead = (places + from_s * moves - begin) @ along
    closing = np.maximum(speed_m_s - moves @ along, 1e-6)
    at_s = from_s + np.clip(ahead / closing, 0.0, lasts_s)
    return np.asarray(places + at_s[:, None] * moves)
