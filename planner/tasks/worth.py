"""What the ground of a scenario is worth to a search, by cells, and how that moves on."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import affinity
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.scenario import Scenario
from planner.search.seen import missed_before, moved_on
from planner.search.values import Worth, worth_of_ground
from planner.wishes import Importance, ImportanceRaster

Floats = NDArray[np.float64]

#: Places on a raster's edge, but for rounding, are on it.
EDGE = 1e-9
#: A cell's worth is the mean of so many places to a side of it at most.
MOST_WITHIN = 8


def ground_of(shape: BaseGeometry) -> Polygon | MultiPolygon:
    """What of a shape has an area."""
    parts = [p for p in shapely.get_parts(shape).tolist() if isinstance(p, Polygon) and p.area > 0.0]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)


def worth_of(scenario: Scenario, ground: Polygon | MultiPolygon, cell_m: float) -> Worth:
    """Scores of the ground by cells, less what looks before the search have taken of them."""
    plain = worth_of_ground(ground, cell_m)
    return worth_of_ground(ground, cell_m, scores_at(scenario, plain.centres_m, cell_m))


def scores_at(scenario: Scenario, places_m: Floats, cell_m: float) -> Floats:
    """What a square metre is worth at places (N, M, 2), of a raster the mean over cells of so many metres.

    Less what looks before the search have taken of it; of ground and what is beside it alike.
    """
    importance = scenario.importance
    left = missed_before(importance, places_m)
    if not importance.given:
        return left
    east, north = places_m[..., 0], places_m[..., 1]
    scores = np.zeros(east.shape)
    for patch in importance.patches:
        shapely.prepare(patch.area)
        scores += np.where(shapely.contains_xy(patch.area, east, north), patch.score, 0.0)
    for point in importance.points:
        off = np.hypot(east - point.position[0], north - point.position[1]) / point.spread_m
        scores += point.score * np.exp(-0.5 * off**2)
    raster = importance.raster
    if raster is not None:
        # The mean over each cell: one of the raster's is often much smaller.
        within = min(MOST_WITHIN, math.ceil(cell_m / raster.cell_m - EDGE))
        for north_part, east_part in np.ndindex(within, within):
            off_m = cell_m * ((np.array([east_part, north_part]) + 0.5) / within - 0.5)
            scores += _on_raster(raster, east + off_m[0], north + off_m[1]) / within**2
    return np.asarray(scores * left)


def _on_raster(raster: ImportanceRaster, east_m: Floats, north_m: Floats) -> Floats:
    """Scores of the raster's cells that places lie in, 0 outside of it."""
    rows, columns = raster.scores.shape
    row = np.floor((north_m - raster.south_m) / raster.cell_m + EDGE).astype(np.int64)
    column = np.floor((east_m - raster.west_m) / raster.cell_m + EDGE).astype(np.int64)
    inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    found = raster.scores[np.clip(row, 0, rows - 1), np.clip(column, 0, columns - 1)]
    return np.where(inside, found, 0.0)


def drifted(importance: Importance, time_s: float) -> Importance:
    """What is worth how much after a time of the search, the drift's own spread for points alone."""
    drift = importance.drift
    if drift is None:
        return importance
    since_s = drift.elapsed_s + time_s
    east_m, north_m = since_s * drift.east_m_s, since_s * drift.north_m_s
    points = []
    for point in importance.points:
        spread_m = math.hypot(point.spread_m, since_s * drift.spread_m_s)
        there = (point.position[0] + east_m, point.position[1] + north_m)
        score = point.score * (point.spread_m / spread_m) ** 2
        points.append(replace(point, position=there, spread_m=spread_m, score=score))
    patches = tuple(
        replace(patch, area=affinity.translate(patch.area, east_m, north_m)) for patch in importance.patches
    )
    raster = importance.raster
    if raster is not None:
        raster = replace(raster, west_m=raster.west_m + east_m, south_m=raster.south_m + north_m)
    seen = moved_on(importance.seen, drift.east_m_s, drift.north_m_s, time_s)
    return replace(importance, points=tuple(points), patches=patches, raster=raster, seen=seen)
