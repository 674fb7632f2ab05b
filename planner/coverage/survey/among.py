"""Ground that obstacles cut, as cells with lanes of their own: headings, ends and order are chosen together.

Boustrophedon cells (Choset 2000) of the open ground, for slices along the direction that promises least; each
is a stop of the tour with all ways of a survey to see it, as in R. Bähnemann et al., "Revisiting
Boustrophedon Coverage Path Planning as a Generalized Traveling Salesman Problem" (2021).
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

import shapely
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.surroundings import Surroundings
from planner.coverage.decompose import OVERLAP_M
from planner.coverage.merge import MergedRegion, split_region
from planner.coverage.registry import family_of
from planner.coverage.survey.pieces import Pieces, visits
from planner.coverage.urban.boustrophedon import cells
from planner.coverage.urban.layout import headings
from planner.coverage.urban.regions import open_ground
from planner.coverage.urban.visibility import edges_of
from planner.coverage.visible import Seeing
from planner.coverage.ways import Target
from planner.errors import InfeasibleError
from planner.progress import Stop, raise_if
from planner.sensors.camera import CameraSensor

#: Smaller cells are seen from their neighbours'.
LEAST_CELL_M2 = 1.0
#: Pieces of ground that is left are seen with this much round them.
LEFT_MARGIN_M = 0.05
#: Of more cells the tour is left to sweeps.
MOST_CELLS = 60


def cell_targets(
    asked: Seeing, around: Surroundings, margin_m: float, stop: Stop, enough: Stop
) -> tuple[Target, ...] | None:
    """A target for each cell of each region's open ground; None where too many, or none to be flown.

    Parameters
    ----------
    margin_m
        Kept from what may not be entered: turns at the end of lanes have to have room there.
    stop, enough
        The one cancels; the other ends the search for cells that promise more.
    """
    found: list[Target] = []
    for region in asked.regions:
        for part in split_region(region):
            level = asked.level.of(part)
            sensor, height_m = asked.suite.over(part.sensor, part.area, asked.airspace, level)
            there = asked.at(level, around)
            ground = open_ground(part.area, asked.airspace, level, margin_m)
            uncut = ground.area > part.area.area - LEAST_CELL_M2
            if uncut or not isinstance(sensor, CameraSensor):
                family, how = family_of(sensor), (part, sensor, height_m, there)
                found += family.targets(*how, wide=True, division="auto", enough=enough)
                continue
            trial = Pieces(sensor, height_m, there, stop)
            pieces = _best(part, ground, trial, stop, enough)
            if pieces is None or len(found) + len(pieces) > MOST_CELLS:
                return None
            found += [trial.target(visit) for piece in pieces for visit in visits(piece, trial)]
    return tuple(found)


def left_targets(asked: Seeing, around: Surroundings, left: Iterable[BaseGeometry]) -> tuple[Target, ...]:
    """A target for each piece of ground that is left of each region, to be seen from beside it.

    Parameters
    ----------
    left
        Of each region of what is asked, in its order.

    Raises
    ------
    InfeasibleError
        Where some piece cannot be seen from where one may fly.
    """
    found: list[Target] = []
    for region, ground in zip(asked.regions, left, strict=True):
        level = asked.level.of(region)
        there = asked.at(level, around)
        for piece in shapely.get_parts(ground):
            if piece.is_empty:
                continue
            hull = piece.buffer(LEFT_MARGIN_M, join_style="mitre").convex_hull
            whole = replace(region, area=hull)
            sensor, height_m = asked.suite.over(region.sensor, hull, asked.airspace, level)
            if isinstance(sensor, CameraSensor):
                (part,) = split_region(whole)
                found.append(Pieces(sensor, height_m, there).target(replace(part, axes=())))
    return tuple(found)


def _best(
    part: MergedRegion, ground: BaseGeometry, trial: Pieces, stop: Stop, enough: Stop
) -> tuple[MergedRegion, ...] | None:
    """The cells, for slices along some edges of the ground, that promise the shortest tour."""
    best: tuple[float, tuple[MergedRegion, ...]] | None = None
    if ground.area < LEAST_CELL_M2:
        return None
    for angle_rad in headings(edges_of(ground)):
        raise_if(stop)
        if best is not None and enough():
            break
        outlines = list(_cells(ground, angle_rad))
        if not outlines or len(outlines) > MOST_CELLS:
            continue
        pieces = tuple(trial.cut(part.piece(outline)) for outline in outlines)
        try:
            cost_m = trial.cost_m(pieces, math.inf if best is None else best[0])
        except InfeasibleError:
            continue
        if math.isfinite(cost_m) and (best is None or cost_m < best[0]):
            best = (cost_m, pieces)
    return None if best is None else best[1]


def _cells(ground: BaseGeometry, angle_rad: float) -> Iterator[Polygon]:
    """Cells that reach a little into each other, so that no rounding leaves a gap between what they see."""
    for cell in cells(ground, angle_rad):
        grown = _areal(cell.outline.buffer(OVERLAP_M, join_style="mitre"))
        wide = shapely.intersection(grown, ground, grid_size=1e-6)
        yield from (
            piece
            for piece in shapely.get_parts(wide)
            if isinstance(piece, Polygon) and piece.area > LEAST_CELL_M2
        )


def _areal(shape: BaseGeometry) -> BaseGeometry:
    """A shape, or what it covers where its outline crosses itself: cells are joined at slivers."""
    if shape.is_valid:
        return shape
    covered: BaseGeometry = shapely.make_valid(shape, method="structure", keep_collapsed=False)
    return covered
