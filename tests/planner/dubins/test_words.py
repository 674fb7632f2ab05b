"""Dubins lines against laws and brute force."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.angles import wrap_pi
from planner.dubins.path import Path
from planner.dubins.words import candidates, candidates_between, shortest, shortest_between
from planner.route import Anchor, Pose

coordinate = st.floats(-3000.0, 3000.0)
angle = st.floats(-4.0, 4.0)
poses = st.builds(Pose, coordinate, coordinate, angle)
#: Close together: every word exists and arcs of almost no length and almost full turns are met.
near = st.sampled_from([-200.0, -100.0, -1e-7, 0.0, 1e-9, 1e-4, 50.0, 100.0, 200.0, 400.0])
right_angles = st.sampled_from([-math.pi, -math.pi / 2, -1e-10, 0.0, 1e-10, 1e-8, math.pi / 2, math.pi, 7.0])
awkward = st.builds(Pose, near, near, right_angles)
radii = st.sampled_from([1.0, 37.5, 100.0, 800.0])


def assert_flyable(path: Path, radius_m: float) -> None:
    """Segments follow each other in place and direction, and no arc is tighter than the radius."""
    for before, after in itertools.pairwise(path.segments):
        assert math.dist(before.end.position, after.start.position) < 1e-6
        assert abs(wrap_pi(before.end.angle_rad - after.start.angle_rad)) < 1e-9
    for segment in path.segments:
        assert segment.length_m >= 0.0
        assert segment.kind == "straight" or segment.radius_m >= radius_m * (1.0 - 1e-12)


@given(poses | awkward, poses | awkward, radii)
def test_every_word_reaches_the_goal(start: Pose, goal: Pose, radius_m: float) -> None:
    """Each candidate starts at the start, ends at the goal within a micrometre, and is sorted by length."""
    paths = candidates(start, goal, radius_m)
    for path in paths:
        assert_flyable(path, radius_m)
        assert path.start == start
        assert math.dist(path.end.position, goal.position) < 1e-6
        assert abs(wrap_pi(path.end.angle_rad - goal.angle_rad)) < 1e-7
    lengths = [path.length_m for path in paths]
    assert lengths == pytest.approx(sorted(lengths), abs=1e-6)
    assert shortest(start, goal, radius_m).length_m == pytest.approx(lengths[0], abs=1e-9)


@given(poses, poses, radii)
def test_reverse_symmetry(start: Pose, goal: Pose, radius_m: float) -> None:
    """Flown backwards the shortest line is as long."""
    back = shortest(
        Pose(goal.east_m, goal.north_m, goal.angle_rad + math.pi),
        Pose(start.east_m, start.north_m, start.angle_rad + math.pi),
        radius_m,
    )
    assert back.length_m == pytest.approx(shortest(start, goal, radius_m).length_m, abs=1e-4)


@given(poses, poses, poses)
def test_triangle_inequality_and_euclid(a: Pose, b: Pose, c: Pose) -> None:
    """A detour is never shorter, and no line is shorter than the straight one."""
    direct = shortest(a, c, 100.0).length_m
    assert direct <= shortest(a, b, 100.0).length_m + shortest(b, c, 100.0).length_m + 1e-6
    assert direct >= math.dist(a.position, c.position) - 1e-6


@given(awkward, st.floats(0.0, 5000.0))
def test_straight_ahead_is_straight(start: Pose, distance_m: float) -> None:
    """A goal straight ahead is reached without a loop, wherever the frame's origin is."""
    far = Pose(start.east_m + 80_000.0, start.north_m - 60_000.0, start.angle_rad)
    goal = Pose(
        far.east_m + distance_m * math.cos(far.angle_rad),
        far.north_m + distance_m * math.sin(far.angle_rad),
        far.angle_rad,
    )
    assert shortest(far, goal, 100.0).length_m == pytest.approx(distance_m, abs=1e-3)


def brute_force_m(start: Pose, goal: Pose, radius_m: float, steps: int) -> float:
    """Upper bound of the shortest line: every pair of end arcs on a grid, joined by a straight or an arc.

    The middle part is accepted when it misses the goal's place and direction by less than the grid allows.
    """
    best = math.inf
    turns = np.linspace(0.0, 2.0 * math.pi, steps, endpoint=False)
    step_rad = 2.0 * math.pi / steps
    for s0, s1 in itertools.product((1.0, -1.0), repeat=2):
        out = start.angle_rad + s0 * turns
        left = np.stack(
            [
                start.east_m + s0 * radius_m * (np.sin(out) - math.sin(start.angle_rad)),
                start.north_m - s0 * radius_m * (np.cos(out) - math.cos(start.angle_rad)),
            ],
            axis=1,
        )
        into = goal.angle_rad - s1 * turns
        right = np.stack(
            [
                goal.east_m - s1 * radius_m * (math.sin(goal.angle_rad) - np.sin(into)),
                goal.north_m + s1 * radius_m * (math.cos(goal.angle_rad) - np.cos(into)),
            ],
            axis=1,
        )
        gap = right[None, :, :] - left[:, None, :]
        distance = np.hypot(gap[..., 0], gap[..., 1])
        bearing = np.arctan2(gap[..., 1], gap[..., 0])
        ends = radius_m * (turns[:, None] + turns[None, :])

        def off(angles: np.ndarray) -> np.ndarray:
            return np.abs(np.remainder(angles + math.pi, 2.0 * math.pi) - math.pi)

        straight = (off(bearing - out[:, None]) < step_rad) & (off(into[None, :] - out[:, None]) < step_rad)
        if straight.any():
            best = min(best, float((ends + distance)[straight].min()))
        if s0 == s1:
            turn = np.remainder(-s0 * (into[None, :] - out[:, None]), 2.0 * math.pi)
            chord = 2.0 * radius_m * np.sin(turn / 2.0)
            middle = (np.abs(chord - distance) < radius_m * step_rad) & (
                off(bearing - (out[:, None] - s0 * turn / 2.0)) < 2.0 * step_rad
            )
            if middle.any():
                best = min(best, float((ends + radius_m * turn)[middle].min()))
    return best


@pytest.mark.parametrize("seed", range(12))
def test_brute_force(seed: int) -> None:
    """A search over all arcs on a fine grid finds nothing shorter, and nothing much longer."""
    generator = np.random.default_rng(seed)
    start = Pose(0.0, 0.0, float(generator.uniform(-math.pi, math.pi)))
    east_m, north_m = generator.uniform(-250.0, 250.0, 2).tolist()
    goal = Pose(east_m, north_m, float(generator.uniform(-math.pi, math.pi)))
    steps = 720
    grid_error_m = 100.0 * 2.0 * math.pi / steps * 6.0 + 2.0 * math.pi / steps * 400.0
    found_m = brute_force_m(start, goal, 100.0, steps)
    assert shortest(start, goal, 100.0).length_m == pytest.approx(found_m, abs=grid_error_m)


def test_textbook_lengths() -> None:
    """Half a turn, a quarter turn and the three-arc word for two poses side by side have known lengths."""
    assert shortest(Pose(0, 0, 0), Pose(0, 200, math.pi), 100.0).length_m == pytest.approx(100 * math.pi)
    assert shortest(Pose(0, 0, 0), Pose(100, 100, math.pi / 2), 100.0).length_m == pytest.approx(50 * math.pi)
    # Turning on the spot by half a turn: LRL or RLR with arcs of 60, 300 and 60 degrees.
    turned = shortest(Pose(0, 0, 0), Pose(0, 0, math.pi), 100.0)
    assert turned.length_m == pytest.approx(100 * math.radians(420))
    assert len(turned.segments) == 3


@settings(deadline=None)
@given(poses | awkward, poses | awkward)
def test_free_direction_is_the_best_direction(start: Pose, goal: Pose) -> None:
    """With a free end the line is no longer than for any of 72 directions there."""
    free_goal = shortest_between(Anchor(*start.position, start.angle_rad), Anchor(*goal.position), 100.0)
    free_start = shortest_between(Anchor(*start.position), Anchor(*goal.position, goal.angle_rad), 100.0)
    turned = [k * math.pi / 36.0 for k in range(72)]
    best_goal = min(shortest(start, Pose(*goal.position, a), 100.0).length_m for a in turned)
    best_start = min(shortest(Pose(*start.position, a), goal, 100.0).length_m for a in turned)
    for path, best_m in ((free_goal, best_goal), (free_start, best_start)):
        assert_flyable(path, 100.0)
        assert math.dist(path.start.position, start.position) < 1e-6
        assert math.dist(path.end.position, goal.position) < 1e-6
        assert path.length_m <= best_m + 1e-6
    own = shortest(start, free_goal.end, 100.0).length_m
    assert own <= free_goal.length_m + 1e-5


def test_two_arcs_to_a_place_inside_the_turning_circle() -> None:
    """A place beside the aircraft, inside its turning circle, is reached by turning away first."""
    path = shortest_between(Anchor(0.0, 0.0, 0.0), Anchor(0.0, 50.0), 100.0)
    assert [segment.kind for segment in path.segments] == ["right", "left"]
    assert path.segments[1].turn_rad > math.pi


def test_all_two_piece_words_arrive() -> None:
    """Every word to a place with free direction ends there."""
    for east_m, north_m in itertools.product((-250.0, -90.0, 0.0, 60.0, 400.0), repeat=2):
        for path in candidates_between(Anchor(0.0, 0.0, 0.3), Anchor(east_m, north_m), 100.0):
            assert math.dist(path.end.position, (east_m, north_m)) < 1e-6
            assert_flyable(path, 100.0)


def test_both_free_is_straight() -> None:
    """Without directions the line is the straight one."""
    path = shortest_between(Anchor(1.0, 2.0), Anchor(4.0, 6.0), 100.0)
    assert path.length_m == pytest.approx(5.0)
    assert [segment.kind for segment in path.segments] == ["straight"]
