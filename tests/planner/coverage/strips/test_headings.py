"""Headings that a shape singles out, judged by widths that shapely measures."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Point, Polygon

from planner.coverage.strips.headings import anchor_rad, first_visit_rad, grid, telling
from tests.planner.coverage.shapes import box

SWATH_M = 100.0


def swaths(angles_rad: np.ndarray) -> np.ndarray:
    return np.full(len(angles_rad), SWATH_M)


def width_m(area: Polygon, angle_rad: float) -> float:
    """Extent across a heading."""
    turned = affinity.rotate(area, -angle_rad, origin=(0, 0), use_radians=True)
    return float(turned.bounds[3] - turned.bounds[1])


def lanes(area: Polygon, angle_rad: float) -> int:
    return max(1, math.ceil((width_m(area, angle_rad) - 1e-3) / SWATH_M))


@st.composite
def outlines(draw: st.DrawFn) -> Polygon:
    """Star-shaped outlines a few swaths across."""
    radii = draw(st.lists(st.floats(60.0, 400.0), min_size=3, max_size=8))
    angles = np.linspace(0.0, math.tau, len(radii), endpoint=False)
    return Polygon([(r * math.cos(a), r * math.sin(a)) for r, a in zip(radii, angles, strict=True)])


@given(outlines())
@settings(deadline=None, max_examples=30)
def test_no_heading_takes_fewer_lanes_than_the_best_that_is_singled_out(area: Polygon) -> None:
    """Among all headings in steps of half a degree none needs fewer lanes."""
    singled = min(lanes(area, angle) for angle in telling(area, swaths))
    assert singled <= min(lanes(area, math.radians(step / 2.0)) for step in range(360))


@given(outlines())
@settings(deadline=None, max_examples=30)
def test_every_edge_is_among_them_both_ways(area: Polygon) -> None:
    """Each edge of the outline and of its hull has its direction and the opposite in the list."""
    found = telling(area, swaths)
    for ring in (area.exterior, area.convex_hull):
        places = shapely.get_coordinates(ring)
        for ahead in np.diff(places, axis=0):
            for turn in (0.0, math.pi):
                off = found - math.atan2(ahead[1], ahead[0]) - turn
                assert np.abs(np.mod(off + math.pi, math.tau) - math.pi).min() < 1e-6


@given(outlines())
@settings(deadline=None, max_examples=30)
def test_breaks_are_where_one_lane_less_just_does(area: Polygon) -> None:
    """Where the lane count changes between headings a degree apart, one in the list has the lower."""
    found = telling(area, swaths)
    headings = [math.radians(step) for step in range(361)]
    counts = [lanes(area, heading) for heading in headings]
    # Between two of these headings there may be one with fewer than any of them.
    fewest = min(*counts, *(lanes(area, angle) for angle in found))
    for k in range(360):
        low = min(counts[k], counts[k + 1])
        if counts[k] == counts[k + 1] or low > 1.5 * fewest:
            continue
        between = [a for a in found if headings[k] - 1e-6 <= a <= headings[k + 1] + 1e-6]
        assert any(lanes(area, angle) <= low for angle in between)


def test_the_grid_starts_across_the_least_width() -> None:
    """A long box turned by any angle has its own long side as the first of the grid."""
    for turned in (0.0, 0.3, 1.2, 2.8):
        area = affinity.rotate(box(300.0, 900.0), turned, origin=(0, 0), use_radians=True)
        assert width_m(area, grid(area, math.radians(10.0))[0]) == pytest.approx(300.0)


@given(outlines(), st.floats(0.0, math.tau))
@settings(deadline=None, max_examples=30)
def test_the_headings_turn_with_the_shape(area: Polygon, turned: float) -> None:
    """What is singled out of the turned shape is what was singled out, turned."""
    again = telling(affinity.rotate(area, turned, origin=(0, 0), use_radians=True), swaths)
    for angle in telling(area, swaths):
        off = again - angle - turned
        assert np.abs(np.mod(off + math.pi, math.tau) - math.pi).min() < 1e-3


def test_noise_in_the_last_digits_does_not_move_the_grid() -> None:
    """Sides of a box equally wide but for less than a millimetre give the same grid."""
    area = box(500.0, 500.0, 0.4)
    rng = np.random.default_rng(3)
    ring = shapely.get_coordinates(area)[:-1]
    first = np.sort(np.mod(grid(area, math.radians(10.0)), math.radians(10.0)))[0]
    for _ in range(5):
        noisy = Polygon(ring + rng.uniform(-1e-4, 1e-4, ring.shape))
        off = math.remainder(anchor_rad(noisy) - first, math.radians(10.0))
        assert abs(off) < 1e-5


@given(st.floats(1.3, 5.0), st.floats(-3.0, 3.0), st.floats(-math.pi, math.pi), st.booleans())
@settings(deadline=None, max_examples=30)
def test_visits_share_headings_as_the_scenario_lies(
    long: float, lies_rad: float, angle_rad: float, mirrored: bool
) -> None:
    """Turned about the scenario's middle, or mirrored, the first visit's heading turns with a region."""
    oblong = box(100.0 * long, 100.0, lies_rad)
    for shape in (oblong, Point(3000.0, 1000.0).buffer(0.5, quad_segs=1)):
        turned = affinity.rotate(shape, angle_rad, origin=(0, 0), use_radians=True)
        wanted_rad = first_visit_rad(shape) + angle_rad
        if mirrored:
            turned, wanted_rad = affinity.scale(turned, yfact=-1.0, origin=(0, 0)), -wanted_rad
        assert abs(math.remainder(first_visit_rad(turned) - wanted_rad, math.tau)) < 1e-6
