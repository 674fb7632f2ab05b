"""``auto`` on the paper's case, and on ground that is not worth the same everywhere."""

import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point

from planner.errors import InfeasibleError
from planner.search.course import DiscSearch, Glider
from planner.search.paper_case import SIDE_M, paper_case
from planner.search.refine import auto
from planner.search.values import worth_of_ground

SHORT = ((96, 60), (12, 300), (4, 600))


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


def _seen(case, points):
    return LineString(points).buffer(50.0, quad_segs=64).intersection(case.ground).area / case.ground.area


@pytest.mark.parametrize("seed", [3, 11])
def test_auto_sees_as_much_whatever_is_drawn(seed):
    """Seeds of which one line alone led to 92.8 % of the square."""
    assert _seen(paper_case(), auto(paper_case(), seed).points) >= 0.95


@pytest.mark.parametrize(("turned_deg", "mirrored"), [(30.0, False), (-117.0, True)])
def test_ground_turned_mirrored_and_moved_is_searched_as_well(found, turned_deg, mirrored):
    """The same line turned alike, but for rounding, on the energy it takes."""
    case, turn = paper_case(), math.radians(turned_deg)
    axes = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
    axes = np.diag([-1.0 if mirrored else 1.0, 1.0]) @ axes

    def moved(places):
        return np.asarray(places) @ axes + (812.0, -95.0)

    ground = shapely.transform(case.ground, moved)
    ends = (tuple(moved([case.start])[0]), tuple(moved([case.end])[0]))
    worth = worth_of_ground(ground, case.worth.cell_m)
    line = auto(DiscSearch(ground, worth, 50.0, *ends, case.glider), seed=0)
    assert _seen(replace(case, ground=ground), line.points) == pytest.approx(
        _seen(case, found.points), abs=0.005
    )
    assert math.dist(line.points[0], ends[0]) < 1e-6
    assert math.dist(line.points[-1], ends[1]) < 1e-6
    assert line.energy_j <= case.glider.energy_j


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
