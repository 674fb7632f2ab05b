"""Legs against zones and area, judged by shapely."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from shapely import constrained_delaunay_triangles
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

from planner.airspace.kernels import CLEAR, FORBIDDEN, OUTSIDE, leg_verdict
from planner.airspace.zones import ring_edges

AREA = Polygon(
    [(0.0, 0.0), (4000.0, 0.0), (4000.0, 3000.0), (2500.0, 3000.0), (2000.0, 1500.0), (0.0, 3000.0)]
)
ZONES = (
    Polygon(
        [(500.0, 500.0), (1500.0, 500.0), (1500.0, 700.0), (700.0, 700.0), (700.0, 1400.0), (500.0, 1400.0)]
    ),
    Polygon(
        [(2700.0, 400.0), (3700.0, 400.0), (3700.0, 1400.0), (2700.0, 1400.0)],
        [[(2900.0, 600.0), (3500.0, 600.0), (3500.0, 1200.0), (2900.0, 1200.0)]],
    ),
)
DISC = (3200.0, 2300.0, 350.0)
RINGS = [ring_edges(zone) for zone in ZONES]
EDGES = np.concatenate(RINGS)
OFFSETS = np.cumsum([0, *(len(ring) for ring in RINGS)], dtype=np.int64)
NO_EDGES = np.empty((0, 4))

ALLOWED = [
    shapely.get_coordinates(piece)[:3]
    for piece in constrained_delaunay_triangles(AREA.difference(unary_union(ZONES))).geoms
]
#: Well inside one of the triangles of the allowed ground: hardly one is drawn in vain.
place = st.builds(
    lambda corners, first, second: tuple(
        corners.T @ (first, (1.0 - first) * second, (1.0 - first) * (1.0 - second))
    ),
    st.sampled_from(ALLOWED),
    st.floats(0.001, 0.999),
    st.floats(0.001, 0.999),
)


@given(start=place, bearing_rad=st.floats(0.0, 2.0 * math.pi), length_m=st.floats(20.0, 2500.0))
@settings(max_examples=400, deadline=None)
def test_verdict_agrees_with_shapely(start, bearing_rad, length_m):
    """A leg begun on allowed ground is clear exactly where shapely finds it so."""
    end = (start[0] + length_m * math.cos(bearing_rad), start[1] + length_m * math.sin(bearing_rad))
    line = LineString([start, end])
    disc_m = line.distance(Point(DISC[:2])) - DISC[2]
    edge_m = min(line.distance(zone.boundary) for zone in ZONES)
    corner_m = min(line.distance(Point(corner)) for corner in AREA.exterior.coords)
    # the near end is judged with the leg before, and a hair's breadth is nobody's business
    assume(AREA.exterior.distance(Point(start)) > 1e-3 and AREA.exterior.distance(Point(end)) > 1e-3)
    assume(abs(disc_m) > 1e-3 and corner_m > 1e-3)
    # nor is a leg along an edge, which is neither in nor out
    assume(edge_m > 1e-3 or any(zone.buffer(-1e-3).intersection(line).length > 1e-2 for zone in ZONES))
    (e0, n0), (e1, n1) = start, end
    verdict = leg_verdict(e0, n0, e1, n1, np.array([DISC]), EDGES, OFFSETS, ring_edges(AREA))
    if not AREA.contains(line):
        assert verdict == OUTSIDE
    elif disc_m < 0.0 or any(zone.intersects(line) for zone in ZONES):
        assert verdict == FORBIDDEN
    else:
        assert verdict == CLEAR


def test_no_rows_are_no_limit():
    """Without zones and area every leg is clear."""
    nothing = np.zeros(1, dtype=np.int64)
    assert leg_verdict(0.0, 0.0, 1e6, 1e6, np.empty((0, 3)), NO_EDGES, nothing, NO_EDGES) == CLEAR


@pytest.mark.parametrize(
    ("leg", "expected"),
    [
        ((400.0, 400.0, 600.0, 600.0), FORBIDDEN),  # in by a corner
        ((400.0, 600.0, 650.0, 350.0), CLEAR),  # touching that corner alone
        ((400.0, 400.0, 1600.0, 800.0), FORBIDDEN),  # in by a corner, out by an edge
        ((400.0, 300.0, 400.0, 1500.0), CLEAR),  # beside a zone
    ],
)
def test_corners(leg, expected):
    """A corner may be touched, not passed."""
    e0, n0, e1, n1 = leg
    verdict = leg_verdict(e0, n0, e1, n1, np.empty((0, 3)), EDGES, OFFSETS, NO_EDGES)
    assert verdict == expected
