"""Patterns of search: strips that hold all of the ground."""

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Polygon, box

from planner.search.families import lanes, patterns, sector, spiral

ELL = Polygon([(0, 0), (900, 0), (900, 300), (300, 300), (300, 800), (0, 800)])


def held(strips, width_m, cap):
    """What strips a width wide hold together."""
    wide = [LineString(strip).buffer(width_m / 2.0, cap_style=cap) for strip in strips]
    return shapely.union_all(wide, grid_size=1e-6)


@pytest.mark.parametrize("angle_deg", [0.0, 30.0, 77.0, 120.0])
@pytest.mark.parametrize("ground", [box(-300, 100, 700, 500), ELL], ids=["rectangle", "ell"])
def test_lanes_hold_the_ground(ground, angle_deg):
    """Lanes at any heading hold all of the ground, neighbours flown opposite ways."""
    strips = lanes(ground, math.radians(angle_deg), 70.0)
    assert ground.difference(held(strips, 70.0 + 1e-6, "flat").buffer(1e-3)).area < 1.0
    along = strips[:, 1] - strips[:, 0]
    assert {round(math.cos(math.atan2(*a[::-1]) - math.radians(angle_deg))) for a in along} == {-1, 1}


def test_a_spiral_holds_a_rectangle():
    """Sides of rings, squares at their ends, hold all of a rectangle but at corners that turns are cut at."""
    ground = box(0, 0, 800, 600)
    for left in (True, False):
        strips = spiral(ground, 100.0, 0.0, left)
        assert held(strips, 100.0 + 1e-6, "square").intersection(ground).area > 0.985 * ground.area
        assert np.allclose(strips[1:, 0], strips[:-1, 1], atol=101.0)


def test_sectors_pass_their_datum():
    """Every leg of a sector search passes the datum in its middle."""
    strips = sector((50.0, -20.0), 400.0, 0.3)
    assert np.allclose(strips.mean(axis=1), [50.0, -20.0])
    assert np.allclose(np.hypot(*(strips[:, 1] - strips[:, 0]).T), 800.0)


def test_every_family_is_among_the_patterns():
    """Lanes along and across, spirals, squares and sectors are laid."""
    found = {pattern.family for pattern in patterns(ELL, 80.0, np.radians([0.0, 90.0]), (200.0, 200.0))}
    assert found == {"parallel", "creeping", "spiral", "square", "sector"}
