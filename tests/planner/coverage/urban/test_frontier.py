"""Sweeps laid at one heading over ground with holes."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon, box
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.columns_kernels import intervals, left_over
from planner.coverage.urban.frontier import Frontier, Laid, Manner
from planner.coverage.urban.visibility import edges_of

ACROSS_M, ALONG_M = 20.0, 30.0
GROUND = box(0.0, 0.0, 400.0, 300.0).difference(
    shapely.union_all(
        [box(60, 40, 130, 150), box(200, 90, 290, 170), Polygon([(300, 200), (380, 230), (310, 280)])]
    )
)


def seen_of(lines: np.ndarray) -> BaseGeometry:
    """Ground below lines, the test's own: a flat strip, longer by half a frame at both ends."""
    shapes = []
    for start, end in lines:
        ahead = (end - start) / np.hypot(*(end - start)) * ALONG_M / 2.0
        shapes.append(LineString([start - ahead, end + ahead]).buffer(ACROSS_M / 2.0, cap_style="flat"))
    return shapely.union_all(shapes, grid_size=1e-6)


def laid(angle_rad: float, manner: Manner, *, downwards: bool = False) -> np.ndarray:
    """Lines over the ground, as they can be flown."""
    frontier = Frontier.of(edges_of(GROUND), angle_rad, False, ACROSS_M)
    laid = (frontier.mirrored() if downwards else frontier).laid(ACROSS_M, ALONG_M, manner)
    return laid.within(edges_of(GROUND.buffer(1e-5, join_style="mitre")), ACROSS_M, ALONG_M)[0].lines()


@pytest.mark.parametrize("downwards", [False, True])
@pytest.mark.parametrize(
    "manner", [Manner(None, 0.0, 0.0), Manner(None, 2.0, 0.5), Manner(0.25), Manner(0.0)]
)
@pytest.mark.parametrize("angle_deg", [0.0, 90.0])
def test_along_an_edge_all_ground_is_seen(angle_deg: float, manner: Manner, downwards: bool) -> None:
    """Nothing is left but where a slanted obstacle bars the way, and all lines stay on the ground."""
    lines = laid(math.radians(angle_deg), manner, downwards=downwards)
    assert shapely.difference(GROUND, seen_of(lines)).area < 0.002 * GROUND.area
    assert shapely.covers(GROUND.buffer(1e-3), shapely.linestrings(lines)).all()


def test_a_plain_rectangle_takes_as_few_sweeps_as_it_is_wide() -> None:
    """200 m of height are ten sweeps, each half a frame short of both edges."""
    ground = box(0.0, 0.0, 500.0, 200.0)
    frontier = Frontier.of(edges_of(ground), 0.0, False, ACROSS_M)
    lines = frontier.laid(ACROSS_M, ALONG_M, Manner(None, 0.0, 0.0)).lines()
    assert len(lines) == 10
    assert sorted(lines[:, 0, 1].tolist()) == pytest.approx([10.0 + 20.0 * k for k in range(10)])
    assert np.sort(lines[:, :, 0], axis=1) == pytest.approx(np.tile([15.0, 485.0], (10, 1)))


def test_what_lines_see_is_what_lies_below_them() -> None:
    """As strips of the test's own; what is cut off them, where ground ends, is told as lost."""
    rng = np.random.default_rng(2)
    rows = np.column_stack([rng.uniform(-50, 150, 20), rng.uniform(200, 500, 20), rng.uniform(0, 300, 20)])
    laid = Laid(0.3, rows)
    inside, lost = laid.within(edges_of(GROUND), ACROSS_M, ALONG_M)
    assert shapely.covers(GROUND.buffer(1e-6), shapely.linestrings(inside.lines())).all()
    for whole, parts in ((laid.lines(), laid), (inside.lines(), inside)):
        seen = shapely.union_all(parts.strips(ACROSS_M, ALONG_M), grid_size=1e-6)
        assert seen.symmetric_difference(seen_of(whole)).area < 1.0
    both = shapely.union_all([*inside.strips(ACROSS_M, ALONG_M), *lost], grid_size=1e-6)
    assert both.symmetric_difference(seen_of(laid.lines())).area < 1.0


def test_intervals_are_what_a_line_across_the_ground_meets() -> None:
    """In the middle of each column, as shapely cuts it; no less anywhere in the column."""
    turned = shapely.affinity.rotate(GROUND, 25.0, origin=(0, 0))
    edges = edges_of(turned)
    borders = np.unique(edges[:, [0, 2]])
    ground, middles, offsets = intervals(edges, borders)
    for k in range(0, len(borders) - 1, 3):
        middle = (borders[k] + borders[k + 1]) / 2.0
        cut = shapely.get_parts(LineString([(middle, -1e3), (middle, 1e3)]).intersection(turned))
        expected = sorted(part.bounds[1::2] for part in cut)
        found = middles[offsets[k] : offsets[k + 1]]
        assert found == pytest.approx(np.array(expected))
        within = ground[offsets[k] : offsets[k + 1]]
        assert (within[:, 0] <= found[:, 0] + 1e-9).all()
        assert (within[:, 1] >= found[:, 1] - 1e-9).all()


def test_what_sweeps_leave_over_is_the_difference() -> None:
    """Bands taken from intervals, as shapely takes them."""
    rng = np.random.default_rng(1)
    for _ in range(30):
        marks = np.sort(rng.uniform(0.0, 100.0, 6)).reshape(-1, 2)
        rows = np.sort(rng.uniform(0.0, 100.0, 3))
        sweeps = np.column_stack([np.zeros((3, 2)), rows, np.zeros((3, 2))])
        left, offsets = left_over(marks, np.array([0, 3]), sweeps, 15.0)
        bands = shapely.union_all([LineString([(row - 7.5, 0), (row + 7.5, 0)]) for row in rows])
        lines = shapely.union_all([LineString([(low, 0), (high, 0)]) for low, high in marks])
        expected = shapely.get_parts(lines.difference(bands))
        assert offsets.tolist() == [0, len(left)]
        assert left == pytest.approx(np.array(sorted(part.bounds[::2] for part in expected)).reshape(-1, 2))
