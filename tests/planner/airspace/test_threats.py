"""Threat risks against the plain equations and shapely's geometry."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point
from shapely.ops import unary_union

from planner.airspace.threats import (
    MIN_RADAR_RANGE_M,
    curve_risk,
    line_risk,
    metres_inside,
    risk_of_detection,
    risk_of_kill,
    threat_arrays,
    threat_discs,
)
from planner.airspace.values import Threat

MISSILE = Threat("M", "missile", (0.0, 0.0), 800.0)
RADAR = Threat("D", "radar", (500.0, 100.0), 600.0, intensity_m=600.0)

coordinate = st.floats(-2000.0, 2000.0)
lines = st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=8)


def plain_line_risk(points, threats, spacing_m):
    """Eqs 12 and 14 written out: the twin of the compiled sums."""
    samples = [tuple(p) for p in points]
    for (e0, n0), (e1, n1) in pairwise(points):
        length_m = math.dist((e0, n0), (e1, n1))
        along_m = spacing_m
        while along_m < length_m - 1e-6 * spacing_m:
            samples.append((e0 + (e1 - e0) * along_m / length_m, n0 + (n1 - n0) * along_m / length_m))
            along_m += spacing_m
    return plain_sum(samples, threats)


def plain_sum(samples, threats):
    kill = math.fsum(
        risk_of_kill(math.dist(p, t.centre), t.radius_m)
        for t in threats
        if t.model == "missile"
        for p in samples
    )
    detection = math.fsum(
        risk_of_detection(math.dist(p, t.centre), t.radius_m, t.intensity_m)
        for t in threats
        if t.model == "radar"
        for p in samples
    )
    return kill, detection


def test_risk_of_kill_values():
    """Eq 11 is 1 at the missile, 1/2 at its effective distance and 0 beyond."""
    assert risk_of_kill(0.0, 800.0) == 1.0
    assert risk_of_kill(800.0, 800.0) == pytest.approx(0.5)
    assert risk_of_kill(400.0, 800.0) == pytest.approx(16.0 / 17.0)
    assert risk_of_kill(800.001, 800.0) == 0.0
    assert risk_of_kill(0.0, 0.0) == 0.0


def test_risk_of_detection_values():
    """Eq 13 is 1 where distance equals intensity, 0 beyond the radius, and finite at the radar."""
    assert risk_of_detection(600.0, 600.0, 600.0) == pytest.approx(1.0)
    assert risk_of_detection(300.0, 600.0, 600.0) == pytest.approx(16.0)
    assert risk_of_detection(600.1, 600.0, 600.0) == 0.0
    assert risk_of_detection(0.0, 600.0, 600.0) == pytest.approx((600.0 / MIN_RADAR_RANGE_M) ** 4)


def test_threats_below_the_aircraft_do_not_act():
    """A cylinder's cap: flown over above its height, a threat leaves no row."""
    low = Threat("L", "missile", (1.0, 2.0), 3.0, height_m=400.0)
    missiles, radars = threat_arrays((low, RADAR), altitude_m=500.0)
    assert missiles.shape == (0, 3)
    assert radars.tolist() == [[500.0, 100.0, 600.0, 600.0]]
    missiles, _ = threat_arrays((low, RADAR), altitude_m=400.0)
    assert missiles.tolist() == [[1.0, 2.0, 3.0]]
    assert threat_discs((low, RADAR)).shape == (2, 3)
    assert metres_inside([(0.0, 2.0), (9.0, 2.0)], (low,), altitude_m=500.0) == 0.0


def test_a_leg_as_long_as_the_spacing_has_no_dividing_point():
    """Two waypoints 100 m apart count as two points, not three."""
    kill, detection = line_risk([(0.0, 0.0), (100.0, 0.0)], (MISSILE,))
    assert kill == pytest.approx(1.0 + risk_of_kill(100.0, 800.0))
    assert detection == 0.0


@given(points=lines, spacing_m=st.floats(20.0, 500.0))
@settings(max_examples=150, deadline=None)
def test_line_risk_equals_its_twin(points, spacing_m):
    """The compiled eqs 12 and 14 equal the written-out sums."""
    # off round numbers: a sample within rounding of a disc's rim may fall on either side of it
    threats = (
        Threat("M1", "missile", (0.1234567, 0.7654321), 800.0),
        Threat("D1", "radar", (500.1234567, 99.7654321), 600.0, intensity_m=600.0),
        Threat("M2", "missile", (-900.1234567, 700.7654321), 650.0),
    )
    expected = plain_line_risk(points, threats, spacing_m)
    assert line_risk(points, threats, spacing_m) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@given(points=lines, split=st.integers(2, 9))
@settings(max_examples=100, deadline=None)
def test_curve_risk_does_not_depend_on_the_vertices(points, split):
    """Cutting every chord of a curve into pieces leaves its risk as it was."""
    dense = [points[0]]
    for (e0, n0), (e1, n1) in pairwise(points):
        dense += [(e0 + (e1 - e0) * k / split, n0 + (n1 - n0) * k / split) for k in range(1, split + 1)]
    # the discs' rims are kept off the samples: rounding there would be a step of 1/2
    threats = (MISSILE, RADAR)
    length_m = sum(math.dist(a, b) for a, b in pairwise(points))
    line = LineString(points) if len(points) > 1 and length_m > 0 else None
    samples = [100.0 * k for k in range(int(length_m // 100.0) + 1)] + [length_m]
    if line is not None:
        for along_m in samples:
            place = line.interpolate(along_m)
            for t in threats:
                if abs(place.distance(Point(t.centre)) - t.radius_m) < 1e-6:
                    return
    if length_m % 100.0 < 1e-3 or length_m % 100.0 > 100.0 - 1e-3:
        return
    assert curve_risk(dense, threats) == pytest.approx(curve_risk(points, threats), rel=1e-6, abs=1e-9)


def test_curve_risk_counts_start_steps_and_end():
    """A 250 m curve is sampled at 0, 100, 200 and 250 m; a 200 m one at 0, 100 and 200 m."""
    for length_m, places in ((250.0, (0.0, 100.0, 200.0, 250.0)), (200.0, (0.0, 100.0, 200.0))):
        kill, _ = curve_risk([(0.0, 0.0), (length_m, 0.0)], (MISSILE,))
        assert kill == pytest.approx(sum(risk_of_kill(d, 800.0) for d in places))


@given(points=lines.filter(lambda p: len(p) > 1))
@settings(max_examples=100, deadline=None)
def test_metres_inside_agrees_with_shapely(points):
    """Length inside the union of overlapping discs, against shapely on fine polygons of them."""
    threats = (MISSILE, RADAR, Threat("M2", "missile", (-1500.0, -900.0), 500.0))
    inside_m = metres_inside(points, threats)
    lower = unary_union([Point(t.centre).buffer(t.radius_m, quad_segs=720) for t in threats])
    upper = unary_union([Point(t.centre).buffer(t.radius_m + 0.01, quad_segs=720) for t in threats])
    below_m, above_m = 0.0, 0.0
    for a, b in pairwise(points):
        if math.dist(a, b) > 1e-6:
            below_m += LineString([a, b]).intersection(lower).length
            above_m += LineString([a, b]).intersection(upper).length
    assert below_m - 1e-3 <= inside_m <= above_m + 1e-3


def test_bad_lines_are_refused():
    """Wrong shapes and a spacing of nothing are errors, not zeros."""
    with pytest.raises(ValueError, match="shape"):
        line_risk(np.zeros((0, 2)), (MISSILE,))
    with pytest.raises(ValueError, match="spacing_m"):
        curve_risk([(0.0, 0.0), (1.0, 1.0)], (MISSILE,), spacing_m=0.0)
