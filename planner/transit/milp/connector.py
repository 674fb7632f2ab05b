"""The program as a connector: a trajectory of straights from one anchor to another, smoothed and judged.

The paper's program (``model``) with what a flown line needs besides: straights, not points alone, keep
outside obstacles, and a first and a last step in the directions of the anchors. Tried with more room about
obstacles, more points and more time until the smoothed line is clear.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString

from planner.airspace.zones import KeepOut
from planner.dubins.path import Path
from planner.dubins.rounding import RoundingMethod, round_off
from planner.errors import InfeasibleError
from planner.progress import Stop, never, raise_if
from planner.route import Anchor
from planner.transit.milp.obstacles import obstacles_of
from planner.transit.milp.solve import Limits, solve
from planner.transit.milp.values import Array, Goal, Problem, Trajectory

#: L of the paper's figures.
DIRECTIONS = 4

#: Waypoints this near to the straight between their neighbours are none; obstacles keep twice as much.
STRAIGHT_M = 0.5

#: For one leg of a plan: nodes, so that the same plan comes on any machine, and seconds in case.
LIMITS = Limits(seconds=60.0, nodes=400, gap=0.05)

#: An attempt has so much time at least.
LEAST_S = 1.0


@dataclass(frozen=True, slots=True)
class Attempt:
    """One try.

    Parameters
    ----------
    slack
        The time is that of a line so many times as long as the straight.
    steps
        At most; fewer where they were shorter than a turn needs.
    margin
        Turn radii kept about obstacles: what arcs cut off corners.
    """

    slack: float
    steps: int
    margin: float


ATTEMPTS = (Attempt(1.3, 11, 0.0), Attempt(1.3, 11, 0.1), Attempt(2.0, 16, 0.1), Attempt(2.0, 16, 0.4))


def connect(
    start: Anchor,
    goal: Anchor,
    keep_out: KeepOut,
    radius_m: float,
    speed_m_s: float,
    wish: Goal = "control",
    *,
    directions: int = DIRECTIONS,
    smoothing: RoundingMethod = "fillet",
    limits: Limits = LIMITS,
    stop: Stop = never,
) -> tuple[Path, Trajectory]:
    """A flyable line from one anchor to another by eqs 34 to 47.

    Parameters
    ----------
    start, goal
        Places, and directions where not None; met exactly.
    keep_out
        Zones and area, all kept to.
    radius_m, speed_m_s
        Of the aircraft; V of the program is the speed, U the acceleration V² / R of its turns.
    wish
        Eq 34 or eq 47.
    directions
        L.
    smoothing
        How straights become arcs, see ``planner.dubins.rounding.round_off``.
    limits
        The nodes of each attempt, the time of all.

    Raises
    ------
    InfeasibleError
        Where no attempt gives a clear line; says how the last program ended, and whether that is proven.
    CancelledError
        ``stop`` said so, also while the solver runs.
    """
    said, spent_s = "the two are one place", 0.0
    for attempt in ATTEMPTS if math.dist(start.position, goal.position) > radius_m else ():
        raise_if(stop)
        problem = problem_of(start, goal, keep_out, radius_m, speed_m_s, wish, directions, attempt)
        found = solve(problem, replace(limits, seconds=max(limits.seconds - spent_s, LEAST_S)), stop)
        spent_s += found.seconds
        if found.waypoints is None:
            said = _ended(found, problem)
            continue
        for points in _straightened(found.waypoints):
            path = round_off(points, start.angle_rad, goal.angle_rad, radius_m, keep_out.clear, smoothing)
            if keep_out.clear(path):
                return path, found
        said = f"turns of {radius_m:.0f} m along its trajectory enter a zone"
    raise InfeasibleError(
        "transit",
        "transit",
        f"no line by the program from {start.position} to {goal.position}: {said}",
        "Connect by tangents, or open the way between the two.",
    )


def problem_of(
    start: Anchor,
    goal: Anchor,
    keep_out: KeepOut,
    radius_m: float,
    speed_m_s: float,
    wish: Goal,
    directions: int,
    attempt: Attempt,
) -> Problem:
    """The program of an attempt."""
    ends = (start.position, goal.position)
    margin_m = 2.0 * STRAIGHT_M + attempt.margin * radius_m
    obstacles, box = obstacles_of(keep_out, ends, margin_m, directions)
    turns = sum(anchor.angle_rad is not None for anchor in (start, goal))
    way_m = attempt.slack * math.dist(*ends) + 2.0 * radius_m * turns
    steps = max(4, min(attempt.steps, int(way_m / (1.5 * radius_m))))
    return Problem(
        *ends,
        obstacles,
        points=steps + 1,
        step_s=way_m / (steps * speed_m_s),
        speed_m_s=speed_m_s,
        acceleration_m_s2=speed_m_s**2 / radius_m,
        goal=wish,
        start_angle_rad=start.angle_rad,
        end_angle_rad=goal.angle_rad,
        least_m=min(radius_m, 0.7 * way_m / steps),
        whole_steps=True,
        box=box,
    )


def _straightened(waypoints: Array) -> Iterator[Array]:
    """The trajectory without the waypoints that lie on straights, then with them."""
    yield np.asarray(shapely.get_coordinates(LineString(waypoints).simplify(STRAIGHT_M)))
    yield waypoints


def _ended(found: Trajectory, problem: Problem) -> str:
    """How a program without a trajectory ended."""
    steps = f"of {problem.points - 1} steps in {problem.step_s * (problem.points - 1):.0f} s"
    if found.status == "infeasible":
        return f"no trajectory {steps} exists (proven)"
    return f"none {steps} was found within the limits ({found.nodes} nodes), nor proven not to exist"
