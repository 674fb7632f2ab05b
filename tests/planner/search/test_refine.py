"""``auto`` on the paper's case, and on ground that is not worth the same everywhere."""

import math

import numpy as np
import pytest
from shapely.geometry import LineString, Point

from planner.errors import InfeasibleError
from planner.search.course import DiscSearch, Glider
from planner.search.paper_case import SIDE_M, paper_case
from planner.search.refine import auto
from planner.search.values import worth_of_ground

SHORT = ((64, 40), (4, 600))


@pytest.fixture(scope="module")
def found():
    """The line of ``auto`` on the paper's case."""
    return auto(paper_case(), seed=0)


def test_auto_sees_the_paper_s_square(found):
    """At least 95 % of it, the exit reached, and at most 1 % of the energy left, none owed."""
    case = paper_case()
    # By shapely, from the line alone.
    seen = LineString(found.points).buffer(50.0, quad_segs=64).intersection(case.ground).area
    assert seen >= 0.95 * SIDE_M**2
    assert math.dist(found.points[-1], case.end) < 5.0
    assert math.dist(found.points[0], case.start) < 1e-6
    length_m = LineString(found.points).length
    least_j = length_m / case.glider.airspeed_m_s * case.glider.power_w(0.0)
    assert least_j <= found.energy_j <= case.glider.energy_j
    assert found.energy_j >= 0.99 * case.glider.energy_j


def test_auto_turns_no_tighter_than_its_load_factor_allows(found):
    """Circles through three vertices of the line are no smaller than the tightest turn."""
    a, b, c = found.points[:-2], found.points[1:-1], found.points[2:]
    sides = [np.hypot(*(p - q).T) for p, q in ((a, b), (b, c), (a, c))]
    doubled = np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    bent = doubled > 1e-6 * sides[0] * sides[1]
    radii = np.prod(sides, axis=0)[bent] / (2.0 * doubled[bent])
    assert radii.min() > 0.97 * paper_case().glider.radius_m


def test_auto_looks_where_it_is_worth_most():
    """With energy for a part of the ground alone the part that is worth ten times as much is seen."""
    case = paper_case()
    rows, columns = case.worth.scores.shape
    scores = np.ones((rows, columns))
    scores[rows // 2 :, columns // 2 :] = 10.0
    worth = worth_of_ground(case.ground, case.worth.cell_m, scores)
    glider = Glider(case.glider.power, case.glider.airspeed_m_s, 1.5, 0.45 * case.glider.energy_j)
    asked = DiscSearch(case.ground, worth, 50.0, case.start, case.end, glider)
    line = auto(asked, rounds=SHORT)
    rich = [Point(p) for p in worth.centres_m[scores == 10.0]]
    seen = LineString(line.points).buffer(50.0)
    assert sum(seen.covers(place) for place in rich) > 0.6 * len(rich)


def test_too_little_energy_is_told():
    """Where no line ends at the exit within the energy that is said, not flown."""
    case = paper_case()
    glider = Glider(case.glider.power, case.glider.airspeed_m_s, 1.5, 0.01 * case.glider.energy_j)
    with pytest.raises(InfeasibleError, match="Wh"):
        auto(DiscSearch(case.ground, case.worth, 50.0, case.start, case.end, glider), rounds=SHORT)
