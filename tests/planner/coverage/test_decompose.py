"""Divisions of shapes: pieces that hold all of the shape, at the places that tell."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from shapely.geometry import LineString, Polygon

from planner.coverage.decompose import OVERLAP_M, cuts, divide, is_plain, legs, merged
from tests.planner.coverage.strips.test_sweeps import stars

L_SHAPE = Polygon([(0, 0), (3000, 0), (3000, 600), (600, 600), (600, 2500), (0, 2500)])


@given(area=stars())
@settings(deadline=None, max_examples=60)
def test_pieces_together_are_the_shape(area: Polygon) -> None:
    """Every division holds all of the shape, nothing beside it, and overlaps by little."""
    for pieces in cuts(area):
        assert len(pieces) >= 2
        together = shapely.union_all(list(pieces), grid_size=1e-6)
        beside = shapely.symmetric_difference(together, area, grid_size=1e-6)
        assert beside.area < 1e-5 * area.length
        cut_m = sum(piece.length for piece in pieces) - area.length
        assert sum(piece.area for piece in pieces) <= area.area + cut_m * 2.0 * OVERLAP_M + 1.0
        assert all(isinstance(piece, Polygon) and piece.is_valid for piece in pieces)


def test_an_l_is_cut_at_its_corner() -> None:
    """Among the divisions of an L are both that leave two rectangles."""
    found = [sorted(round(piece.area) for piece in pieces) for pieces in cuts(L_SHAPE)]
    across = sorted([round(600.0 * 2501.0), round(2401.0 * 600.0)])
    assert any(np.allclose(areas, across, rtol=0.01) for areas in found)
    assert not is_plain(L_SHAPE)
    assert is_plain(L_SHAPE.convex_hull)


def test_a_hole_is_cut_round() -> None:
    """A square ring is divided into four pieces without holes."""
    ring = shapely.box(0, 0, 3000, 3000).difference(shapely.box(1000, 1000, 2000, 2000))
    assert isinstance(ring, Polygon)
    round_it = [pieces for pieces in cuts(ring) if not any(piece.interiors for piece in pieces)]
    assert round_it
    assert min(len(pieces) for pieces in round_it) == 4


def test_slivers_and_cuts_beside_the_shape_are_no_divisions() -> None:
    """A chord outside, or one that leaves next to nothing, divides nothing."""
    square = shapely.box(0, 0, 1000, 1000)
    assert divide(square, [LineString([(-500, -10), (2000, -10)])]) is None
    assert divide(square, [LineString([(-1, 0.5), (1001, 0.5)])]) is None
    halves = divide(square, [LineString([(-1, 500), (1001, 500)])])
    assert halves is not None
    assert [piece.area for piece in halves] == pytest.approx([501_000.0, 501_000.0])
    assert merged(halves) is not None
    assert merged((square, shapely.box(2000, 0, 3000, 1000))) is None


def test_a_corridor_is_cut_at_its_bends_in_order() -> None:
    """Legs follow the axis, one more than there are bends; a straight corridor has none."""
    axis = LineString([(0, 0), (2000, 0), (2000, 1500), (3500, 2500)])
    area = axis.buffer(100.0, cap_style="flat")
    assert isinstance(area, Polygon)
    found = legs(area, axis)
    assert found is not None
    assert len(found) == 3
    places = [axis.project(piece.centroid) for piece in found]
    assert places == sorted(places)
    assert shapely.union_all(list(found), grid_size=1e-6).symmetric_difference(area).area < 1e-5 * area.length
    straight = LineString([(0, 0), (900, 0), (2000, 10)])
    bar = straight.buffer(100.0, cap_style="flat")
    assert isinstance(bar, Polygon)
    assert legs(bar, straight) is None
