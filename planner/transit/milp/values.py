"""What a trajectory is asked for, and what a solver says of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planner.route import Point

Array = NDArray[np.float64]

#: Eq 34, the changes of the controls, or eq 47, the squares of the steps.
Goal = Literal["control", "length"]

#: How a solver ended: proven best; the best so far when a limit came; proven that there is none; neither.
Status = Literal["optimal", "feasible", "infeasible", "unknown"]

#: A point this deep in an obstacle is on its edge.
TOUCH_M = 1e-4


#: A control this small, or square of a step, is rounding.
NOTHING = 1e-9


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Where no point may lie, as families of half-planes: outside one of them is outside.

    Parameters
    ----------
    normals, offsets_m
        Shapes (L, K, 2) and (L, K): point w is outside where ``normals[l, k] @ w >= offsets_m[l, k]`` for
        some l and k. Rows l have binaries b_tol, columns k binaries g_tok (eqs 41 to 46).
    """

    normals: Array
    offsets_m: Array

    def depths(self, points: Array) -> Array:
        """How deep points (N, 2) lie inside, metres; negative outside."""
        reached = np.einsum("lki,ni->nlk", self.normals, points) - self.offsets_m
        return np.asarray(-reached.max(axis=(1, 2)), dtype=np.float64)


def disc(centre: Point, radius_m: float, directions: int, *, printed: bool = False) -> Obstacle:
    """A disc by the tangents of eqs 41 to 44 in L directions of each quarter: the 4 (L - 1)-gon about it.

    The paper prints angles of (l - 1) π/6, which fill a quarter with L = 4; here L of any number do, at
    (l - 1) π / (2 (L - 1)). With L = 1 there are two sides alone, south and north.

    Parameters
    ----------
    printed
        Whether a half-plane is chosen by b_tol and g_ton, as printed, or by one binary of its own. The places
        outside are the same; with one binary a solver is ten times as fast.
    """
    if directions < 1 or not radius_m > 0.0:
        raise ValueError(f"a disc needs a radius and a direction, not {radius_m} and {directions}")
    step_rad = math.pi / (2.0 * (directions - 1)) if directions > 1 else 0.0
    angles = step_rad * np.arange(directions)
    sine, cosine = np.sin(angles), np.cos(angles)
    # (c - w) times these is at least R, so w times their opposites is at least R - c times them.
    towards = np.stack(
        [np.stack([sn * sine, cn * cosine], axis=-1) for sn, cn in ((1, 1), (-1, -1), (1, -1), (-1, 1))],
        axis=1,
    )
    if not printed:
        towards = np.unique(np.round(towards.reshape(-1, 1, 2), 12) + 0.0, axis=0)
    return Obstacle(-towards, radius_m - towards @ np.asarray(centre))


def convex(ring: Array) -> Obstacle:
    """A convex polygon by its own edges: ring (K, 2), counter-clockwise, the first point not repeated."""
    edges = np.roll(ring, -1, axis=0) - ring
    outward = np.column_stack([edges[:, 1], -edges[:, 0]]) / np.hypot(edges[:, 0], edges[:, 1])[:, None]
    return Obstacle(outward[:, None, :], np.einsum("ki,ki->k", outward, ring)[:, None])


@dataclass(frozen=True, slots=True)
class Problem:
    """The model of eqs 34 to 47.

    Parameters
    ----------
    start, end
        w_1 and w_N (eq 40).
    obstacles
        O.
    points
        N, >= 3.
    step_s
        ε.
    speed_m_s, acceleration_m_s2
        V^max = -V^min and U^max = -U^min, of each coordinate (eq 39).
    goal
        Which of the two objectives.
    start_angle_rad, end_angle_rad
        Direction of the first and the last step, any where None, as in the paper; where one is given the
        step is ``least_m`` long or longer.
    least_m
        See there.
    whole_steps
        Whether both ends of a step keep outside the same half-plane, so that the straight between them does,
        too; the paper asks it of points alone.
    box
        West, south, east, north of what points keep to; None for anywhere.
    """

    start: Point
    end: Point
    obstacles: tuple[Obstacle, ...]
    points: int
    step_s: float
    speed_m_s: float
    acceleration_m_s2: float
    goal: Goal = "control"
    start_angle_rad: float | None = None
    end_angle_rad: float | None = None
    least_m: float = 0.0
    whole_steps: bool = False
    box: tuple[float, float, float, float] | None = None

    def __post_init__(self) -> None:
        positive = (self.step_s, self.speed_m_s, self.acceleration_m_s2)
        if self.points < 3 or not all(value > 0.0 and math.isfinite(value) for value in positive):
            raise ValueError(
                f"a trajectory needs three points and positive limits, not {self.points}, {positive}"
            )


@dataclass(frozen=True, slots=True)
class Trajectory:
    """What the solver found.

    Parameters
    ----------
    status
        See ``Status``.
    waypoints
        w_t, shape (N, 2); None where none was found.
    objective, bound
        Of the goal, eq 34 in m/s² or eq 47 in m²; no trajectory has less than the bound. The objective is
        infinite without waypoints.
    nodes, entered, seconds
        Nodes searched, obstacles that had to be told of, and the solver's time.
    """

    status: Status
    waypoints: Array | None
    objective: float
    bound: float
    nodes: int
    entered: int
    seconds: float

    @property
    def gap(self) -> float:
        """How far above the bound the objective may be, of the objective; infinite without waypoints."""
        if not math.isfinite(self.objective):
            return math.inf
        return max(0.0, self.objective - self.bound) / self.objective if self.objective > NOTHING else 0.0

    @property
    def length_m(self) -> float:
        """Of the straights between the waypoints; infinite without."""
        if self.waypoints is None:
            return math.inf
        steps = np.diff(self.waypoints, axis=0)
        return float(np.hypot(steps[:, 0], steps[:, 1]).sum())


def controls(waypoints: Array, step_s: float) -> Array:
    """u_t of a trajectory (eqs 37, 38), shape (N - 2, 2), m/s²; the last step has none that counts."""
    return np.asarray(np.diff(waypoints, n=2, axis=0) / step_s**2, dtype=np.float64)


def value(goal: Goal, waypoints: Array, step_s: float) -> float:
    """Of eq 34 or eq 47 for a trajectory."""
    if goal == "control":
        return float(np.abs(controls(waypoints, step_s)).sum())
    return float((np.diff(waypoints, axis=0) ** 2).sum())
