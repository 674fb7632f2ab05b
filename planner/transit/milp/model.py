"""The mixed integer program of eqs 34 to 47 (Stecz and Gromada 2020) as rows and columns.

Columns are w, v, u, z for each point and coordinate, then b and g of each obstacle and point. Big M is no
larger than eqs 37 to 40 need: a point is no further from either end than its steps reach, which bounds every
row. For the same reason an obstacle has no rows at points that cannot reach it.

Eq 47 is quadratic; each square has a column of its own that lies above ``TANGENTS`` tangents of the parabola,
so that the program stays linear and its bound true. The value told is always that of the trajectory itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from planner.transit.milp.values import Array, Problem

#: Tangents of each parabola of eq 47, evenly from -V to V.
TANGENTS = 33


@dataclass(slots=True)
class Program:
    """Columns with cost and bounds, and rows of them; built up, then given to a solver."""

    cost: list[float] = field(default_factory=list)
    lower: list[float] = field(default_factory=list)
    upper: list[float] = field(default_factory=list)
    integer: list[bool] = field(default_factory=list)
    row_lower: list[float] = field(default_factory=list)
    row_upper: list[float] = field(default_factory=list)
    starts: list[int] = field(default_factory=lambda: [0])
    columns: list[int] = field(default_factory=list)
    factors: list[float] = field(default_factory=list)

    def column(self, lower: float, upper: float, cost: float = 0.0, *, integer: bool = False) -> int:
        """A new column's number."""
        self.lower.append(lower)
        self.upper.append(upper)
        self.cost.append(cost)
        self.integer.append(integer)
        return len(self.cost) - 1

    def row(self, lower: float, upper: float, *terms: tuple[int, float]) -> None:
        """A new row: the sum of factors times columns lies between the two."""
        self.row_lower.append(lower)
        self.row_upper.append(upper)
        self.columns.extend(column for column, _ in terms)
        self.factors.extend(factor for _, factor in terms)
        self.starts.append(len(self.columns))


@dataclass(frozen=True, slots=True)
class Model:
    """A program, and which of its columns are w: (N, 2)."""

    program: Program
    places: NDArray[np.int64]


def reach(problem: Problem) -> tuple[Array, Array]:
    """The least and the greatest place of each point, (N, 2), by what its steps reach from either end."""
    before = problem.speed_m_s * problem.step_s * np.arange(problem.points)[:, None]
    after = before[::-1]
    start, end = np.array(problem.start), np.array(problem.end)
    low, high = np.maximum(start - before, end - after), np.minimum(start + before, end + after)
    if problem.box is not None:
        inner = slice(1, -1)
        low[inner] = np.maximum(low[inner], problem.box[:2])
        high[inner] = np.minimum(high[inner], problem.box[2:])
    return low, high


def build(problem: Problem, entered: tuple[int, ...]) -> Model | None:
    """The model with the rows of some obstacles; None where a point has no place at all.

    Parameters
    ----------
    entered
        Numbers of the obstacles that have rows.
    """
    low, high = reach(problem)
    if (low > high).any():
        return None
    program, count, step_s = Program(), problem.points, problem.step_s
    speed, control = problem.speed_m_s, problem.acceleration_m_s2
    each = [(t, i) for t in range(count) for i in range(2)]
    w = {at: program.column(float(low[at]), float(high[at])) for at in each}
    v = {at: program.column(-speed, speed) for at in each}
    u = {at: program.column(-control, control) for at in each}
    for t, i in each:
        if t == count - 1:
            continue
        # eqs 37 and 38
        program.row(0.0, 0.0, (v[t + 1, i], 1.0), (v[t, i], -1.0), (u[t, i], -step_s))
        program.row(0.0, 0.0, (w[t + 1, i], 1.0), (w[t, i], -1.0), (v[t, i], -step_s))
        if problem.goal == "control":
            # eqs 34 to 36; the last control moves no point
            if t < count - 2:
                z = program.column(0.0, control, 1.0)
                program.row(-math.inf, 0.0, (u[t, i], 1.0), (z, -1.0))
                program.row(0.0, math.inf, (u[t, i], 1.0), (z, 1.0))
        else:
            square = program.column(0.0, math.inf, step_s * step_s)
            for at in np.linspace(-speed, speed, TANGENTS):
                program.row(float(-at * at), math.inf, (square, 1.0), (v[t, i], float(-2.0 * at)))
    for t, angle_rad in ((0, problem.start_angle_rad), (count - 2, problem.end_angle_rad)):
        if angle_rad is not None:
            sine, cosine = math.sin(angle_rad), math.cos(angle_rad)
            program.row(0.0, 0.0, (v[t, 0], sine), (v[t, 1], -cosine))
            program.row(problem.least_m / step_s, math.inf, (v[t, 0], cosine), (v[t, 1], sine))
    for number in entered:
        for t in range(count - 1 if problem.whole_steps else count):
            points = (t, t + 1) if problem.whole_steps else (t,)
            _outside(program, problem, number, [(w[p, 0], w[p, 1], low[p], high[p]) for p in points])
    return Model(program, np.array([w[at] for at in each], dtype=np.int64).reshape(count, 2))


def _outside(
    program: Program, problem: Problem, number: int, points: list[tuple[int, int, Array, Array]]
) -> None:
    """Eqs 41 to 46 for one obstacle and one point, or the two of a step."""
    obstacle = problem.obstacles[number]
    rows, columns, _ = obstacle.normals.shape
    # What each row lacks at worst, over the places that its points reach: M.
    lacking = np.max(
        [
            obstacle.offsets_m - np.minimum(obstacle.normals * low, obstacle.normals * high).sum(axis=-1)
            for _, _, low, high in points
        ],
        axis=0,
    )
    if (lacking <= 0.0).any():
        return
    b = [program.column(0.0, 1.0, integer=True) for _ in range(rows)]
    g = [program.column(0.0, 1.0, integer=True) for _ in range(columns)] if columns > 1 else []
    for k, row in enumerate(b):
        for n in range(columns):
            east, north = (float(part) for part in obstacle.normals[k, n])
            offset_m, most_m = float(obstacle.offsets_m[k, n]), float(lacking[k, n])
            chosen = [(g[n], -most_m)] if g else []
            least_m = offset_m - most_m if g else offset_m
            for east_column, north_column, _, _ in points:
                terms = ((east_column, east), (north_column, north), (row, most_m), *chosen)
                program.row(least_m, math.inf, *terms)
    program.row(-math.inf, rows - 1.0, *((row, 1.0) for row in b))
    if g:
        program.row(1.0, 1.0, *((column, 1.0) for column in g))
