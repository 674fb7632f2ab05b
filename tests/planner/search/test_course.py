"""Lines with rounded corners, and what a disc sees along them, against shapely."""

import math

import numpy as np
import pytest
from shapely.geometry import LineString, Point, box

from planner.search.course import swept
from planner.search.course_kernels import disc_worth, rounded
from planner.search.paper_case import AIRSPEED_M_S, STORED_J, STRAIGHT_M2, navion, paper_case
from planner.search.values import worth_of_ground


def test_corners_are_arcs():
    """A square corner is a quarter of a circle that its legs touch; lengths are those of the line."""
    corners = np.array([[0.0, 0.0], [200.0, 0.0], [200.0, 150.0], [50.0, 150.0]])
    points, straight_m, turned_m = rounded(corners, 40.0, 0.5)
    assert straight_m == pytest.approx(160.0 + 70.0 + 110.0)
    assert turned_m == pytest.approx(40.0 * math.pi)
    assert LineString(points).length == pytest.approx(straight_m + turned_m, rel=1e-4)
    first = points[(points[:, 0] > 160.1) & (points[:, 1] < 39.9)]
    assert np.hypot(*(first - [160.0, 40.0]).T) == pytest.approx(np.full(len(first), 40.0))


@pytest.mark.parametrize(
    "corners", [[[0, 0], [30, 0], [30, 300]], [[0, 0], [100, 0], [0, 0]], [[5, 5], [5, 5]]]
)
def test_corners_without_room_are_none(corners):
    """Legs shorter than their arcs take, turns on the spot, and legs of no length are not flyable."""
    assert math.isinf(rounded(np.array(corners, dtype=float), 40.0, 5.0)[1])


def test_a_disc_sees_what_shapely_says():
    """Cells within reach of a random line are those of shapely's distances."""
    rng = np.random.default_rng(3)
    worth = worth_of_ground(box(0.0, 0.0, 400.0, 300.0), 10.0, rng.random((30, 40)))
    line = rng.uniform(-50.0, 400.0, (7, 2))
    flown = LineString(line)
    inside = [[flown.distance(Point(place)) <= 45.0 for place in row] for row in worth.centres_m.tolist()]
    expected = worth.scores[np.array(inside)].sum()
    seen = disc_worth(line, 45.0, worth.scores, worth.west_m, worth.south_m, worth.cell_m)
    assert seen == pytest.approx(expected)


def test_ground_swept_has_its_area():
    """A straight line's swept ground is a rectangle and two half discs, never more."""
    area = swept(np.array([[0.0, 0.0], [300.0, 0.0]]), 50.0).area
    true_m2 = 300.0 * 100.0 + math.pi * 2500.0
    assert (1.0 - 1e-4) * true_m2 < area <= true_m2


def test_the_paper_s_aircraft_sees_its_area_in_straight_flight():
    """Energy, drag and speed come to 598,100 m² in straight flight, and turns of n = 1.5 take more."""
    glider = navion()
    assert glider.straight_m * 100.0 == pytest.approx(STRAIGHT_M2)
    straight_w, turning_w = glider.power_w(0.0), glider.power_w(glider.max_turn_rad_s)
    assert STORED_J / straight_w * AIRSPEED_M_S == pytest.approx(5981.0)
    assert turning_w > straight_w
    # ψ̇ = g √(n² − 1) / V.
    assert glider.max_turn_rad_s == pytest.approx(9.80665 * math.sqrt(1.25) / AIRSPEED_M_S)
    assert paper_case().ground.area == pytest.approx(STRAIGHT_M2, rel=1e-4)
