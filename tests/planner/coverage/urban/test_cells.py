"""Boustrophedon cells and the two methods that cover cell by cell, by shapely, brute force and a raster."""

import itertools
import math
from collections import Counter

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, MultiPolygon, box

from planner.coverage.survey.among import _areal
from planner.coverage.urban.alternatives import CoverageAlternatives, alternatives, merged
from planner.coverage.urban.bcdh import BoustrophedonCells, circuit, doubled_cells
from planner.coverage.urban.boustrophedon import cells
from planner.coverage.urban.cellwise import back_and_forth
from planner.coverage.urban.fitting import Fitting
from planner.coverage.urban.free import FreeSpace, free_space
from planner.coverage.urban.measures import Sweep, measure
from tests.planner.coverage.urban.shapes import SHAPES, random_area, unseen

RING = box(0, 0, 300, 200).difference(box(100, 60, 200, 140))


@pytest.mark.parametrize(("shape", "angle_rad"), [("irregular", 0.0), ("non-convex", 0.7), ("square", 1.5)])
def test_cells_are_the_ground_and_every_slice_meets_them_once(shape: str, angle_rad: float) -> None:
    """Cells do not overlap, leave nothing, and a slice along the direction meets each in one piece."""
    ground = free_space(random_area(shape, 3)).ground
    found = cells(ground, angle_rad)
    outlines = [cell.outline for cell in found]
    assert sum(outline.area for outline in outlines) == pytest.approx(ground.area, rel=1e-6)
    assert (
        shapely.union_all(outlines, grid_size=1e-6).symmetric_difference(ground).area < 1e-3 * ground.length
    )
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)]) * 1000.0
    for cell in found:
        for place in np.random.default_rng(1).uniform(*np.reshape(cell.outline.bounds, (2, 2)), (10, 2)):
            slice_m = cell.outline.buffer(-1e-4).intersection(LineString([place - ahead, place + ahead]))
            assert len(shapely.get_parts(slice_m)) <= 1
        assert sum(half.area for half in cell.halves) == pytest.approx(cell.outline.area, abs=1e-2)


def test_a_box_cuts_a_rectangle_into_four_cells() -> None:
    """Below it, to either side, above it: the slice is cut at its foot and joined at its top."""
    found = cells(RING, 0.0)
    assert sorted(round(cell.outline.area) for cell in found) == [8000, 8000, 18000, 18000]
    assert sorted(Counter(n for cell in found for n in (cell.low, cell.high)).values()) == [1, 1, 3, 3]


def test_cells_are_doubled_at_least_cost() -> None:
    """Every node has an even number of cells afterwards, and no choice of cells does it for less area."""
    found = cells(free_space(random_area("rectangle", 6)).ground, 0.0)[:12]

    def is_even(doubled: frozenset[int]) -> bool:
        at = Counter(
            n for k, c in enumerate(found) for n in (c.low, c.high) for _ in range(1 + (k in doubled))
        )
        return all(count % 2 == 0 for count in at.values())

    areas = [cell.outline.area for cell in found]
    every = itertools.chain.from_iterable(itertools.combinations(range(len(found)), n) for n in range(13))
    least = min(sum(areas[k] for k in some) for some in every if is_even(frozenset(some)))
    chosen = doubled_cells(found)
    assert is_even(chosen)
    assert sum(areas[k] for k in chosen) == pytest.approx(least)


def test_the_circuit_visits_every_cell_and_goes_on_where_it_ended() -> None:
    """Each cell or half once, from node to node of the Reeb graph, back to the first."""
    ground = free_space(random_area("square", 4)).ground
    found = cells(ground, 0.0)
    visits = circuit(found, doubled_cells(found), (0.0, 0.0), 0.0)
    assert sum(part.area for part, _ in visits) == pytest.approx(ground.area, rel=1e-6)
    ends = []
    for part, upward in visits:
        cell = next(c for c in found if any(part is shape for shape in (c.outline, *c.halves)))
        ends.append((cell.low, cell.high) if upward else (cell.high, cell.low))
    assert all(before[1] == after[0] for before, after in itertools.pairwise(ends))
    assert ends[0][0] == ends[-1][1]


def test_alternatives_are_four_corners_of_a_cell() -> None:
    """A rectangle is begun at each of its corners, its lanes along the longer side."""
    part = box(0, 0, 200, 60)
    four = alternatives(part, Fitting(20.0, 15.0), FreeSpace(MultiPolygon([part]), (), 0.0))
    starts = {tuple(round(v) for v in way[0].start) for way in four}
    assert starts == {(0, 10), (0, 50), (200, 10), (200, 50)}
    assert all(sum(sweep.length_m for sweep in way) == pytest.approx(600.0) for way in four)


def test_cells_are_merged_where_one_sweep_sees_both() -> None:
    """Two halves of a rectangle are one; two across a step that interrupts lanes are not."""
    fitting = Fitting(20.0, 15.0)
    assert len(merged([box(0, 0, 200, 30), box(0, 30, 200, 60)], fitting)) == 1
    corner = [box(0, 0, 400, 40), box(180, 40, 220, 400)]
    assert len(merged(corner, fitting)) == 2


def test_extras_are_flown_from_the_lane_end_next_to_them() -> None:
    """A short sweep beside a lane's far end waits until the line comes there."""
    lanes = (Sweep((0, 0), (100, 0)), Sweep((0, 20), (100, 20)))
    found = back_and_forth(lanes, (Sweep((105, 25), (110, 25)),), (0, 0))
    assert [sweep.start for sweep in found] == [(0, 0), (105, 25), (100, 20)] or [
        sweep.start for sweep in found
    ] == [(0, 0), (110, 25), (100, 20)]


@pytest.mark.parametrize("method", [BoustrophedonCells(), CoverageAlternatives()])
@pytest.mark.parametrize("shape", SHAPES)
def test_the_baselines_see_everything(method: BoustrophedonCells | CoverageAlternatives, shape: str) -> None:
    """No place of a grid is left; the flight begins at the start and comes back."""
    urban = random_area(shape, 12)
    free = free_space(urban)
    flown = method(urban)
    assert unseen(flown.sweeps, free.ground.buffer(-1e-3), 20.0, 15.0, 2.0) == 0
    assert measure(urban, free, flown).coverage == pytest.approx(1.0, abs=1e-6)
    assert tuple(flown.line[0, :2]) == pytest.approx(urban.start)
    assert tuple(flown.line[-1, :2]) == pytest.approx(urban.end)
    within = urban.area.covers(LineString(flown.line[:, :2]))
    assert within


def test_a_cell_whose_grown_outline_crosses_itself_is_cut_by_what_it_covers() -> None:
    """Two squares that share a corner's overlap: no GEOS error, and no ground lost or counted twice."""
    crossed = MultiPolygon([box(0.0, 0.0, 10.0, 10.0), box(9.0, 9.0, 20.0, 20.0)])
    assert not crossed.is_valid
    found = _areal(crossed)
    assert found.is_valid
    assert found.area == pytest.approx(100.0 + 121.0 - 1.0)
    assert _areal(box(0.0, 0.0, 1.0, 1.0)).equals(box(0.0, 0.0, 1.0, 1.0))
