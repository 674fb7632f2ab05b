"""What a search sees, for the judge: from its published line and its sensor alone."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely

from planner.check.coverage import GRID_M
from planner.check.footprints import footprint
from planner.plan import Plan
from planner.scenario import Scenario


@dataclass(frozen=True, slots=True)
class Found:
    """What a search sees.

    Parameters
    ----------
    area_m2
        Of the ground searched, each place once.
    importance
        What that is worth; None where all ground is worth the same.
    """

    area_m2: float
    importance: float | None


def searched(scenario: Scenario, plan: Plan) -> Found:
    """Ground seen by all collects of a plan, and its worth."""
    ground = shapely.union_all([region.area for region in scenario.regions], grid_size=GRID_M)
    prints = [footprint(scenario, collect, plan) for collect in plan.collects]
    seen = shapely.intersection(shapely.union_all(prints, grid_size=GRID_M), ground, grid_size=GRID_M)
    importance = scenario.importance
    if not importance.given:
        return Found(float(seen.area), None)
    worth = math.fsum(
        patch.score * shapely.intersection(seen, patch.area, grid_size=GRID_M).area
        for patch in importance.patches
    )
    raster = importance.raster
    if raster is not None and not seen.is_empty:
        rows, columns = raster.scores.shape
        east = raster.west_m + (np.arange(columns) + 0.5) * raster.cell_m
        north = raster.south_m + (np.arange(rows) + 0.5) * raster.cell_m
        shapely.prepare(seen)
        inside = shapely.contains_xy(seen, *np.meshgrid(east, north))
        worth += float(raster.scores[inside].sum()) * raster.cell_m**2
    return Found(float(seen.area), worth)
