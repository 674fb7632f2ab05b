"""Shapes moved disk after disk against shapely's own buffer, and what that spares."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Polygon

from planner.airspace.growth import FEW, grown


def comb(teeth: int, pitch_m: float, deep_m: float) -> Polygon:
    """A bar with teeth upwards."""
    edge = []
    for k in range(teeth):
        edge += [(k * pitch_m, deep_m), ((k + 0.5) * pitch_m, 1.0)]
    return Polygon([*edge, (teeth * pitch_m, -5.0), (0.0, -5.0)])


@settings(max_examples=8)
@given(st.floats(0.5, 300.0), st.floats(5.0, 300.0), st.floats(1.0, 120.0))
def test_it_holds_all_within_the_distance_and_hardly_more(pitch_m: float, deep_m: float, by_m: float) -> None:
    """Its edge is nowhere nearer than that, less a thousandth, and no corner of it is much farther."""
    shape = comb(FEW // 2 + 1, pitch_m, deep_m)
    found = grown(shape, by_m)
    shapely.prepare(shape)
    assert found.covers(shape)
    assert shape.distance(found.boundary) >= by_m * (1.0 - 1e-3)
    assert shapely.distance(shapely.points(shapely.get_coordinates(found)), shape).max() <= 1.01 * by_m


@settings(max_examples=8)
@given(st.floats(0.5, 300.0), st.floats(5.0, 300.0), st.floats(1.0, 60.0))
def test_what_is_left_is_as_far_from_the_edge(pitch_m: float, deep_m: float, by_m: float) -> None:
    """Shrunk, it is as far from the edge to a thousandth, and no corner of what is left is much farther."""
    wide = comb(FEW // 2 + 1, pitch_m, deep_m)
    shape = Polygon(shapely.box(-300.0, -305.0, 300.0 + wide.bounds[2], 1.0).union(wide))
    found = grown(shape, -by_m)
    assert not found.is_empty
    assert shape.covers(found)
    assert shape.exterior.distance(found) >= by_m * (1.0 - 1e-3)
    shapely.prepare(shape.exterior)
    corners = shapely.points(shapely.get_coordinates(found))
    assert shapely.distance(corners, shape.exterior).max() <= 1.01 * by_m


def test_few_corners_are_moved_at_once() -> None:
    """As shapely moves them: to the last digit."""
    shape = comb(20, 10.0, 50.0)
    assert shapely.equals_exact(grown(shape, 30.0, 8), shape.buffer(30.0, quad_segs=8), 0.0)


def test_teeth_become_one_before_they_are_moved_far(monkeypatch: pytest.MonkeyPatch) -> None:
    """The ground that edges are moved over, where they cross, is a small part of that at once."""
    moved_m2: list[float] = []
    real = Polygon.buffer

    def told(self: Polygon, by_m: float, **more: object) -> object:
        moved_m2.append(self.length * by_m)
        return real(self, by_m, **more)

    monkeypatch.setattr(Polygon, "buffer", told)
    teeth = comb(1200, 0.6, 400.0)
    grown(teeth, 80.0)
    assert sum(moved_m2) < 0.05 * teeth.length * 80.0
