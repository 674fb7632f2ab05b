"""Categories of eq 16 and the spans they rest on."""

import itertools
import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import binary_erosion
from shapely import affinity
from shapely.geometry import Polygon

from planner.coverage.merge import merge_regions
from planner.coverage.strips.classify import angles_around, classify, hull_points, spans_at
from tests.planner.coverage.shapes import HEIGHT_M, box, paper_sensor, polygons, sample

PIXEL_M = 5.4
SWATH_M = paper_sensor().swath_m(HEIGHT_M)


@pytest.mark.parametrize("case", [1, 2, 3, 4])
def test_table_2(case: int) -> None:
    """R6 is a point region, R2, R3 and R5 are quasi-point, R1 and R4 distributed (Table 2 of the paper)."""
    kinds = {r.label: classify(r.area, SWATH_M).kind for r in merge_regions(sample(case).regions)}
    assert kinds == {
        "R1": "distributed",
        "R2": "quasi-point",
        "R3": "quasi-point",
        "R4": "distributed",
        "R5": "quasi-point",
        "R6": "point",
    }


@settings(deadline=None)
@given(polygons(), st.floats(-10.0, 10.0))
def test_spans_against_rotation(area: Polygon, angle_rad: float) -> None:
    """Spans are the bounds of the polygon turned the other way by shapely, concave vertices included."""
    spans = spans_at(hull_points(area), np.array([angle_rad]))
    turned = affinity.rotate(area, -angle_rad, origin=(0.0, 0.0), use_radians=True)
    found = (spans.x_min_m[0], spans.y_min_m[0], spans.x_max_m[0], spans.y_max_m[0])
    assert found == pytest.approx(turned.bounds, abs=1e-6)


@settings(max_examples=100, deadline=None)
@given(polygons((50.0, 700.0)), st.floats(100.0, 1200.0))
def test_kind_says_which_angles_work(area: Polygon, swath_m: float) -> None:
    """One pass sees a point region at every angle, a quasi-point one at some, a distributed one at none."""
    found = classify(area, swath_m)
    around_rad = angles_around()
    one_pass = spans_at(hull_points(area), around_rad).across_m <= swath_m
    assert {"point": one_pass.all(), "quasi-point": one_pass.any(), "distributed": not one_pass.any()}[
        found.kind
    ]
    assert found.turns == (1 if found.kind == "distributed" else 0)
    assert np.all(found.long_m >= found.short_m)
    assert len(found.angles_rad) == 90
    if found.kind != "distributed":
        np.testing.assert_array_equal(found.feasible_rad, around_rad[one_pass])
    if found.kind == "quasi-point":
        assert found.long_m.max() >= swath_m >= found.short_m.min()


@settings(max_examples=15, deadline=None)
@given(polygons((50.0, 700.0)), st.floats(0.6, 1.2), st.booleans())
def test_kind_as_on_pixels(area: Polygon, part: float, of_long: bool) -> None:
    """Algorithm 2 on the paper's binary image gives the sides and, pixels apart, the category of eq 16."""
    around = shapely.get_coordinates(area.minimum_rotated_rectangle)
    lengths_m = sorted(math.dist(a, b) for a, b in itertools.pairwise(around))
    swath_m = part * lengths_m[-1 if of_long else 0]
    # A pixel is on where the region comes within half its diagonal, so that thin points are not lost.
    reach_m = PIXEL_M / math.sqrt(2.0)
    west, south, east, north = area.buffer(2.0 * PIXEL_M).bounds
    easts, norths = np.meshgrid(
        np.arange(west, east + PIXEL_M, PIXEL_M), np.arange(south, north + PIXEL_M, PIXEL_M)
    )
    shapely.prepare(area)
    image = shapely.dwithin(area, shapely.points(easts, norths), reach_m)
    edges = image & ~binary_erosion(image)
    found = classify(area, swath_m)
    sides = []
    for angle_rad in found.angles_rad:
        x = easts[edges] * math.cos(angle_rad) + norths[edges] * math.sin(angle_rad)
        y = norths[edges] * math.cos(angle_rad) - easts[edges] * math.sin(angle_rad)
        sides.append((np.ptp(x), np.ptp(y)))
    long_m, short_m = np.max(sides, axis=1), np.min(sides, axis=1)
    np.testing.assert_allclose(found.long_m, long_m, atol=2.0 * PIXEL_M)
    np.testing.assert_allclose(found.short_m, short_m, atol=2.0 * PIXEL_M)
    # Eq 16, where no side is within the pixels' reach of the swath.
    if min(np.abs(long_m.max() - swath_m), np.abs(short_m.min() - swath_m)) > 2.0 * PIXEL_M:
        kind = (
            "point" if long_m.max() < swath_m else "quasi-point" if short_m.min() < swath_m else "distributed"
        )
        assert found.kind == kind


def test_side_equal_to_the_swath() -> None:
    """A strip exactly one swath wide is quasi-point: seen whole along its length, and only so."""
    strip = Polygon([(0, 0), (1000, 0), (1000, 500), (0, 500)])
    found = classify(strip, 500.0)
    assert found.kind == "quasi-point"
    np.testing.assert_allclose(found.feasible_rad, [0.0, math.pi])
    assert classify(strip, 499.0).kind == "distributed"


def test_square_whose_diagonal_does_not_fit() -> None:
    """A square narrower than the swath with a longer diagonal is quasi-point: it fits upright only."""
    assert classify(box(500.0, 500.0), SWATH_M).kind == "quasi-point"
    assert classify(box(400.0, 400.0), SWATH_M).kind == "point"


def test_two_swaths_too_narrow() -> None:
    """Nothing is feasible for a region wider than two swaths all round."""
    found = classify(box(3000.0, 3000.0), SWATH_M)
    assert found.kind == "distributed"
    assert found.feasible_rad.size == 0


def test_coarse_steps_keep_quarter_turns() -> None:
    """However the step divides a circle, an angle's opposite and its perpendiculars are in the grid."""
    for step_deg in (0.7, 1.0, 7.0, 27.0, 100.0):
        around = angles_around(math.radians(step_deg))
        assert np.diff(around).max() <= math.radians(step_deg) + 1e-12
        assert len(around) % 4 == 0
