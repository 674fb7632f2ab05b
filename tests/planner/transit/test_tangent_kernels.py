"""The compiled search against trying every sequence of circles."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import LineString, Point, Polygon, box

from planner.airspace.zones import ring_edges
from planner.dubins.path import Path, Segment
from planner.dubins.words import candidates_between
from planner.route import Anchor, Pose
from planner.transit.tangent_kernels import RADIUS_SLACK, least_to_go, search, tangent, turn_between

coordinate = st.floats(-1000.0, 1000.0)
wheels = st.tuples(coordinate, coordinate, st.sampled_from([-300.0, -100.0, 0.0, 100.0, 250.0]))


def on_wheel(wheel: np.ndarray, phi: float) -> np.ndarray:
    """Place on a wheel flown in a direction: the centre lies a signed radius to the left."""
    return np.array([wheel[0] + wheel[2] * math.sin(phi), wheel[1] - wheel[2] * math.cos(phi)])


def pose_on(wheel: np.ndarray, phi: float) -> Pose:
    """That place with the direction."""
    east_m, north_m = on_wheel(wheel, phi)
    return Pose(float(east_m), float(north_m), phi)


@settings(deadline=None)
@given(wheels, wheels)
def test_tangent_touches_both_wheels(first: tuple[float, ...], second: tuple[float, ...]) -> None:
    """It leaves the first and reaches the second along its own direction; none exists for nested circles."""
    both = np.array([first, second])
    phi, length_m = tangent(both, 0, 1)
    apart_m = math.dist(first[:2], second[:2])
    if length_m < 0.0:
        assert apart_m < max(abs(first[2] - second[2]), 1e-6)
        return
    reached = on_wheel(both[0], phi) + length_m * np.array([math.cos(phi), math.sin(phi)])
    assert reached == pytest.approx(on_wheel(both[1], phi), abs=1e-5)


def plain_search_m(circles: np.ndarray, start: Pose, goal: Pose, r: float, blocked: list[Polygon]) -> float:
    """The shortest clear line over any sequence of different wheels, every one tried, clear by shapely."""
    ways = np.array([[e, n, s * radius] for e, n, radius in circles for s in (1.0, -1.0)])
    ends = [
        [
            (pose.east_m - s * math.sin(pose.angle_rad), pose.north_m + s * math.cos(pose.angle_rad), s)
            for s in (r, -r)
        ]
        for pose in (start, goal)
    ]
    best_m = math.inf
    for first, last in itertools.product(*ends):
        for count in range(3):
            for middle in itertools.permutations(range(len(ways)), count):
                chain = np.array([first, *ways[list(middle)], last])
                path = chain_path(chain, start.angle_rad, goal.angle_rad)
                if path is None or path.length_m >= best_m:
                    continue
                line = LineString(path.sample(1.0, 1e9)[:, :2])
                if all(line.intersection(zone).length < 2.0 for zone in blocked):
                    best_m = path.length_m
    return best_m


def chain_path(chain: np.ndarray, start_rad: float, goal_rad: float) -> Path | None:
    """Arcs and tangents over wheels in turn; None where two have no tangent."""
    segments: list[Segment] = []
    arriving = start_rad
    for i, wheel in enumerate(chain):
        phi, length_m = tangent(chain, i, i + 1) if i + 1 < len(chain) else (goal_rad, 0.0)
        if length_m < 0.0:
            return None
        turn = (phi - arriving) * math.copysign(1.0, wheel[2]) % (2.0 * math.pi)
        turn = 0.0 if turn > 2.0 * math.pi - 1e-9 else turn
        kind = "left" if wheel[2] > 0.0 else "right"
        arc = Segment(kind, pose_on(wheel, arriving), turn * abs(wheel[2]), abs(wheel[2]))
        segments += [arc, Segment("straight", pose_on(wheel, phi), length_m)]
        arriving = phi
    return Path(tuple(segments))


@pytest.mark.parametrize("seed", range(10))
def test_search_is_the_best_sequence(seed: int) -> None:
    """With two discs and a box in the way the search finds what trying every sequence finds."""
    generator = np.random.default_rng(seed)
    discs = np.array(
        [
            [generator.uniform(-300, 300), generator.uniform(-500, -100), generator.uniform(150, 350)],
            [generator.uniform(-300, 300), generator.uniform(100, 500), generator.uniform(150, 350)],
        ]
    )
    wall = box(600.0, -100.0, 620.0, 100.0)
    start = Pose(-1000.0, float(generator.uniform(-500, 500)), float(generator.uniform(-3, 3)))
    goal = Pose(1000.0, float(generator.uniform(-500, 500)), float(generator.uniform(-3, 3)))
    corners = [[east, north, 100.0] for east in (600.0, 620.0) for north in (10.0, -10.0)]
    circles = np.array([*discs, *corners])
    r = 100.0
    expected_m = plain_search_m(
        circles, start, goal, r, [*(Point(e, n).buffer(s, quad_segs=64) for e, n, s in discs), wall]
    )
    rows = [[e, n, s * radius] for e, n, radius in circles for s in (1.0, -1.0)]
    ends = [
        [pose.east_m - s * math.sin(pose.angle_rad), pose.north_m + s * math.cos(pose.angle_rad), s]
        for pose in (start, goal)
        for s in (r, -r)
    ]
    arguments = (
        np.array([*ends, *rows]),
        np.array([[0.0, start.angle_rad, 0.0], [1.0, start.angle_rad, 0.0]]),
        np.array([[2.0, goal.angle_rad, 0.0], [3.0, goal.angle_rad, 0.0]]),
        np.array([goal.east_m, goal.north_m, goal.angle_rad]),
        r,
        discs - np.array([0.0, 0.0, 1e-3]),
        ring_edges(wall),
    )
    length_m, visits = search(*arguments, math.inf, len(arguments[0]))
    below = search(*arguments, length_m, len(arguments[0]))
    assert math.isinf(below[0])
    assert len(below[1]) == 0
    assert search(*arguments, 1.001 * length_m, len(arguments[0]))[0] == length_m
    # The plain twin visits at most two circles between the ends.
    assert length_m <= expected_m + 1e-6
    if len(visits) <= 5:
        assert length_m == pytest.approx(expected_m, abs=1e-6)


poses = st.builds(Pose, coordinate, coordinate, st.floats(-math.pi, math.pi))


@settings(deadline=None)
@given(poses, poses, st.booleans())
def test_the_bound_is_the_dubins_line(pose: Pose, goal: Pose, free: bool) -> None:
    """What is left to fly is bounded by the shortest plain word, and by hardly less."""
    angle_rad = None if free else goal.angle_rad
    anchors = Anchor(pose.east_m, pose.north_m, pose.angle_rad), Anchor(goal.east_m, goal.north_m, angle_rad)
    word_m = candidates_between(*anchors, 100.0)[0].length_m
    tight_m = candidates_between(*anchors, 100.0 * (1.0 - RADIUS_SLACK))[0].length_m
    row = np.array([goal.east_m, goal.north_m, math.nan if free else goal.angle_rad])
    bound_m = least_to_go(pose.east_m, pose.north_m, pose.angle_rad, row, 100.0)
    assert bound_m <= word_m + 1e-6
    # A place on a turning circle is at a jump of the length: there less is as good a bound.
    centres = [on_wheel(np.array([pose.east_m, pose.north_m, s]), pose.angle_rad) for s in (-100.0, 100.0)]
    if not free or all(abs(math.dist(row[:2], centre) - 100.0) > 0.01 for centre in centres):
        assert bound_m == pytest.approx(tight_m, abs=1e-4)


def test_turns_are_counted_the_way_flown() -> None:
    """A quarter to the left is three quarters to the right; a place turns for nothing; no turn is no turn."""
    assert turn_between(100.0, 0.0, math.pi / 2) == pytest.approx(math.pi / 2)
    assert turn_between(-100.0, 0.0, math.pi / 2) == pytest.approx(1.5 * math.pi)
    assert turn_between(0.0, 0.0, 2.0) == 0.0
    assert turn_between(100.0, 1.0, 1.0 - 1e-12) == 0.0


def test_no_way_is_infinite() -> None:
    """A goal walled in gives infinity and no visits."""
    length_m, visits = search(
        np.array([[0.0, 0.0, 0.0], [1000.0, 0.0, 0.0]]),
        np.array([[0.0, 0.0, 0.0]]),
        np.array([[1.0, 0.0, 0.0]]),
        np.array([1000.0, 0.0, math.nan]),
        100.0,
        np.empty((0, 3)),
        ring_edges(box(900, -100, 1100, 100)),
        math.inf,
        2,
    )
    assert math.isinf(length_m)
    assert visits.shape == (0, 3)
