"""The program against hand-worked figures and against every choice of sides by linear programs of scipy."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from shapely.geometry import LineString, box

from planner.errors import CancelledError
from planner.transit.milp.solve import Limits, solve
from planner.transit.milp.values import Problem, controls, disc, value

EXACT = Limits(gap=1e-6)
#: 1 km in 50 s of 10 steps at most 30 m/s.
FREE = Problem((0.0, 0.0), (1000.0, 0.0), (), 11, 5.0, 30.0, 3.0)
#: A square of 300 m in the way of four steps.
BLOCKED = Problem((0.0, 0.0), (1000.0, 0.0), (disc((500.0, 20.0), 150.0, 2),), 5, 12.0, 35.0, 2.0)


def brute(problem: Problem) -> float:
    """Eq 34 at its least over every choice of a side for every point, each a linear program of scipy.

    Columns: controls of both coordinates and their sizes, then the first velocity.
    """
    count, step_s = problem.points, problem.step_s
    steps = count - 2
    best = math.inf

    def place(t: int, i: int) -> tuple[np.ndarray, float]:
        """w_t as factors of the columns and a constant."""
        row = np.zeros(4 * steps + 2)
        row[4 * steps + i] = t * step_s
        for k in range(min(steps, max(0, t - 1))):
            row[2 * k + i] = step_s**2 * (t - 1 - k)
        return row, problem.start[i]

    def velocity(t: int, i: int) -> np.ndarray:
        row = np.zeros(4 * steps + 2)
        row[4 * steps + i] = 1.0
        row[[2 * k + i for k in range(t)]] = step_s
        return row

    fixed, fixed_to, upper, upper_to = [], [], [], []
    for i in range(2):
        row, constant = place(count - 1, i)
        fixed.append(row)
        fixed_to.append(problem.end[i] - constant)
        for t in range(count - 1):
            for sign in (1.0, -1.0):
                upper.append(sign * velocity(t, i))
                upper_to.append(problem.speed_m_s)
        for k in range(steps):
            for sign in (1.0, -1.0):
                row = np.zeros(4 * steps + 2)
                row[2 * k + i], row[2 * steps + 2 * k + i] = sign, -1.0
                upper.append(row)
                upper_to.append(0.0)
    cost = np.concatenate([np.zeros(2 * steps), np.ones(2 * steps), np.zeros(2)])
    control = (-problem.acceleration_m_s2, problem.acceleration_m_s2)
    bounds = [control] * (2 * steps) + [(0.0, None)] * (2 * steps) + [(None, None)] * 2
    (obstacle,) = problem.obstacles
    sides = list(zip(obstacle.normals.reshape(-1, 2), obstacle.offsets_m.ravel(), strict=True))
    for choice in itertools.product(sides, repeat=count - 2):
        rows, limits = list(upper), list(upper_to)
        for t, (normal, offset_m) in enumerate(choice, start=1):
            (east, e0), (north, n0) = place(t, 0), place(t, 1)
            rows.append(-(normal[0] * east + normal[1] * north))
            limits.append(-(offset_m - normal[0] * e0 - normal[1] * n0))
        found = linprog(cost, rows, limits, fixed, fixed_to, bounds)
        if found.success:
            best = min(best, found.fun)
    return best


def test_without_obstacles_nothing_is_steered() -> None:
    """By hand: eq 34 is nothing on a straight; eq 47 is least in equal steps, 10 of 100 m: 100,000 m²."""
    control = solve(FREE, EXACT)
    assert (control.status, control.entered) == ("optimal", 0)
    assert control.objective == pytest.approx(0.0, abs=1e-6)
    length = solve(replace(FREE, goal="length"), EXACT)
    assert length.objective == pytest.approx(100_000.0, rel=5e-3)
    assert length.bound <= length.objective
    assert length.bound == pytest.approx(100_000.0, rel=5e-3)
    assert length.length_m == pytest.approx(1000.0, rel=5e-3)


@pytest.mark.parametrize("directions", [2, 3])
def test_least_control_is_that_of_every_choice_of_sides(directions: int) -> None:
    """By either choice of binaries, with all rows or only those needed, the optimum is brute force's."""
    expected = brute(replace(BLOCKED, obstacles=(disc((500.0, 20.0), 150.0, directions),)))
    assert 0.01 < expected < math.inf
    for printed, whole in itertools.product((False, True), repeat=2):
        obstacles = (disc((500.0, 20.0), 150.0, directions, printed=printed),)
        found = solve(replace(BLOCKED, obstacles=obstacles), EXACT, whole=whole)
        assert found.status == "optimal"
        assert found.objective == pytest.approx(expected, rel=1e-4)
        assert found.bound <= found.objective
        assert found.waypoints is not None
        assert obstacles[0].depths(found.waypoints).max() < 1e-3


def test_more_directions_come_nearer() -> None:
    """The finer the polygon about a disc, the shorter the way round: an octagon holds less than a square."""
    lengths_m = []
    for directions in (2, 3, 5):
        obstacles = (disc((500.0, 20.0), 150.0, directions),)
        lengths_m.append(solve(replace(BLOCKED, goal="length", obstacles=obstacles), EXACT).objective)
    assert lengths_m[0] > lengths_m[1] >= lengths_m[2] - 1e-6


def test_the_trajectory_keeps_its_laws() -> None:
    """Ends, speeds and controls are within eqs 37 to 40, and the value told is that of the points."""
    found = solve(BLOCKED, EXACT)
    assert found.waypoints is not None
    assert tuple(found.waypoints[0]) == pytest.approx(BLOCKED.start)
    assert tuple(found.waypoints[-1]) == pytest.approx(BLOCKED.end)
    assert np.abs(np.diff(found.waypoints, axis=0) / BLOCKED.step_s).max() < BLOCKED.speed_m_s + 1e-6
    used = controls(found.waypoints, BLOCKED.step_s)
    assert np.abs(used).max() < BLOCKED.acceleration_m_s2 + 1e-6
    assert found.objective == pytest.approx(np.abs(used).sum()) == value("control", found.waypoints, 12.0)


@pytest.mark.parametrize("goal", ["control", "length"])
def test_turned_and_mirrored_it_is_as_good(goal: str) -> None:
    """A quarter turn and a mirror image, which the directions share, change the optimum by under 0.5 %."""
    here = solve(replace(BLOCKED, goal=goal), EXACT)
    turned = replace(BLOCKED, goal=goal, end=(0.0, 1000.0), obstacles=(disc((-20.0, 500.0), 150.0, 2),))
    mirrored = replace(BLOCKED, goal=goal, obstacles=(disc((500.0, -20.0), 150.0, 2),))
    assert solve(turned, EXACT).objective == pytest.approx(here.objective, rel=5e-3)
    assert solve(mirrored, EXACT).objective == pytest.approx(here.objective, rel=5e-3)


def test_whole_steps_keep_straights_outside() -> None:
    """Points alone leave the straights to cut the square; whole steps do not, and steer more."""
    square = box(350.0, -130.0, 650.0, 170.0)
    points, steps = solve(BLOCKED, EXACT), solve(replace(BLOCKED, whole_steps=True), EXACT)
    assert square.intersection(LineString(points.waypoints)).length > 10.0
    assert square.buffer(-1e-3).intersection(LineString(steps.waypoints)).is_empty
    assert steps.objective > points.objective


def test_directions_of_the_first_and_last_step() -> None:
    """Where they are given, the first and the last step are flown so, and as long as asked."""
    asked = replace(FREE, start_angle_rad=0.5, end_angle_rad=-0.8, least_m=60.0)
    found = solve(asked, EXACT)
    steps = np.diff(found.waypoints, axis=0)
    assert math.atan2(steps[0, 1], steps[0, 0]) == pytest.approx(0.5, abs=1e-6)
    assert math.atan2(steps[-1, 1], steps[-1, 0]) == pytest.approx(-0.8, abs=1e-6)
    assert min(np.hypot(*steps[0]), np.hypot(*steps[-1])) > 60.0 - 1e-6


def test_no_trajectory_is_proven() -> None:
    """An end inside an obstacle, too little time, a box without way: infeasible, never an empty line."""
    held = replace(FREE, obstacles=(disc((1000.0, 0.0), 50.0, 4),))
    late = replace(FREE, step_s=3.0)
    closed = replace(BLOCKED, box=(-100.0, -100.0, 1100.0, 100.0), whole_steps=True)
    for problem in (held, late, closed):
        found = solve(problem, EXACT)
        assert (found.status, found.waypoints, found.objective) == ("infeasible", None, math.inf)


def crowd() -> Problem:
    """A dozen discs in the way."""
    places = np.random.default_rng(2).uniform([300.0, -800.0], [2700.0, 800.0], (12, 2))
    obstacles = tuple(disc((float(e), float(n)), 200.0, 4, printed=True) for e, n in places)
    return Problem((0.0, 0.0), (3000.0, 0.0), obstacles, 12, 12.0, 30.0, 3.0)


def test_limits_are_told() -> None:
    """With one node the search ends without its proof, and says so; the bound is below what is found."""
    found = solve(crowd(), Limits(nodes=1), whole=True)
    assert found.status in ("feasible", "unknown")
    assert found.bound <= found.objective


def test_stopped_while_the_solver_runs() -> None:
    """The stop is asked again and again by the solver itself, and ends it."""
    asked = 0

    def stop() -> bool:
        nonlocal asked
        asked += 1
        return asked > 3

    with pytest.raises(CancelledError):
        solve(crowd(), stop=stop, whole=True)
    assert asked >= 4
