"""Trajectories among 23 threats by the program of Stecz and Gromada (2020), beside ``tangent``, in one run.

The paper's Figure 18 prints no figures, so the threats are seeded: 23 discs that do not touch, in a square of
6 km. As there, one destination lies beyond them and one among them, ends have no direction, and eq 34
(``control``) and eq 47 (``length``) are both made least, with several numbers L of directions. Rows:

``printed``
    Eqs 34 to 47 as printed: every obstacle at every point, points alone outside. Status, bound, the length of
    the straights, and how deep these cut into threats between the points (``inside_m``).
``flyable``
    The line of ``transit: milp``: straights outside, smoothed, clear of every threat.
``tangent``
    The line of ``transit: tangent``, its time the median of many, each searched anew.

``effort_m_s`` sums the changes of both coordinates of the velocity, which for straights is eq 34 times ε.
``--option picture=FILE`` writes an SVG of the flyable lines with L = 4 instead.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import LineString, Point

from benchmarks.milp_picture import picture as drawn
from planner.airspace.zones import Disc, KeepOut
from planner.dubins.path import Path
from planner.errors import InfeasibleError
from planner.route import Anchor
from planner.transit.milp.connector import connect as connect_by_program
from planner.transit.milp.solve import Limits, solve
from planner.transit.milp.values import Goal, Problem, Trajectory, controls, disc
from planner.transit.tangent import connect, forget_searches

THREATS = 23
HALF_M = 3_000.0
DISC_M = (250.0, 550.0)
#: Between neighbours, and round the destination among them.
GAP_M, CLEARING_M = 100.0, 300.0
RADIUS_M, SPEED_M_S = 250.0, 40.0
START = Anchor(-4_000.0, -300.0)
CASES = {"beyond": Anchor(4_000.0, 500.0), "between": Anchor(0.0, 0.0)}
GOALS: tuple[Goal, ...] = ("control", "length")
#: The printed program's points, and its time in times of the straight's.
POINTS, SLACK = 16, 1.3


def threats(seed: int) -> NDArray[np.float64]:
    """Discs (23, 3): east_m, north_m, radius_m."""
    generator = np.random.default_rng(seed)
    found: list[tuple[float, float, float]] = []
    while len(found) < THREATS:
        east_m, north_m = (float(value) for value in generator.uniform(-HALF_M, HALF_M, 2))
        radius_m = float(generator.uniform(*DISC_M))
        apart = all(math.dist((east_m, north_m), d[:2]) > radius_m + d[2] + GAP_M for d in found)
        if apart and math.hypot(east_m, north_m) > radius_m + CLEARING_M:
            found.append((east_m, north_m, radius_m))
    return np.array(found)


def run(
    seconds: float = 30.0,
    directions: Sequence[int] = (2, 4, 7),
    seed: int = 1,
    points: int = POINTS,
    repeats: int = 21,
    picture: str | None = None,
) -> Iterator[dict[str, Any]]:
    """Rows for each destination.

    Parameters
    ----------
    seconds
        For each program; of ``flyable``, for all attempts together.
    points
        N of the printed program.
    repeats
        ``tangent`` is timed so often.
    picture
        A file to write.
    """
    discs = threats(seed)
    zones = KeepOut(tuple(Disc(f"t{k}", e, n, r, True) for k, (e, n, r) in enumerate(discs.tolist())))
    limits = Limits(seconds, gap=0.01)
    if picture is not None:
        lines = [
            (name, f"{case} {name}", path)
            for case, goal in CASES.items()
            for name, path in _lines(goal, zones, limits).items()
        ]
        FilePath(picture).write_text(drawn(discs, lines, HALF_M), encoding="utf-8")
        yield {"bench": "milp", "picture": picture}
        return
    for case, goal in CASES.items():
        line, tangent_s = _tangent(goal, zones, repeats)
        yield {
            "bench": "milp", "to": case, "line": "tangent", "length_m": line.length_m,
            "effort_m_s": effort_m_s(line), "time_s": tangent_s,
        }  # fmt: skip
        for count in directions:
            for wish in GOALS:
                yield _printed(case, goal, discs, wish, count, points, limits)
                yield _flyable(case, goal, zones, wish, count, limits, line, tangent_s)


def _lines(goal: Anchor, zones: KeepOut, limits: Limits) -> dict[str, Path]:
    found = {"tangent": connect(START, goal, zones, RADIUS_M)}
    for wish in GOALS:
        found[wish], _ = connect_by_program(
            START, goal, zones, RADIUS_M, SPEED_M_S, wish, limits=Limits(limits.seconds, gap=0.05)
        )
    return found


def _tangent(goal: Anchor, zones: KeepOut, repeats: int) -> tuple[Path, float]:
    """The line, and the median time of finding it anew."""
    line = connect(START, goal, zones, RADIUS_M)
    times_s = []
    for _ in range(repeats):
        forget_searches()
        began = time.perf_counter()
        line = connect(START, goal, zones, RADIUS_M)
        times_s.append(time.perf_counter() - began)
    return line, float(np.median(times_s))


def printed_problem(goal: Anchor, discs: NDArray[np.float64], wish: Goal, count: int, points: int) -> Problem:
    """Eqs 34 to 47 with b_tol and g_ton of their own."""
    step_s = SLACK * math.dist(START.position, goal.position) / SPEED_M_S / (points - 1)
    obstacles = tuple(disc((e, n), r, count, printed=True) for e, n, r in discs.tolist())
    return Problem(
        START.position, goal.position, obstacles, points, step_s, SPEED_M_S, SPEED_M_S**2 / RADIUS_M, wish
    )


def _printed(
    case: str, goal: Anchor, discs: NDArray[np.float64], wish: Goal, count: int, points: int, limits: Limits
) -> dict[str, Any]:
    problem = printed_problem(goal, discs, wish, count, points)
    began = time.perf_counter()
    found = solve(problem, limits, whole=True)
    time_s = time.perf_counter() - began
    row: dict[str, Any] = {
        "bench": "milp", "to": case, "line": "printed", "objective": wish, "directions": count,
        "points": points, "time_s": time_s, **_ended(found),
        "length_m": None, "effort_m_s": None, "inside_m": None,
    }  # fmt: skip
    if found.waypoints is not None:
        straights = LineString(found.waypoints)
        inside_m = max(r - straights.distance(Point(e, n)) for e, n, r in discs.tolist())
        row["length_m"] = found.length_m
        row["effort_m_s"] = float(np.abs(controls(found.waypoints, problem.step_s)).sum()) * problem.step_s
        row["inside_m"] = max(0.0, inside_m)
    return row


def _flyable(
    case: str,
    goal: Anchor,
    zones: KeepOut,
    wish: Goal,
    count: int,
    limits: Limits,
    line: Path,
    tangent_s: float,
) -> dict[str, Any]:
    row: dict[str, Any] = {
        "bench": "milp", "to": case, "line": "flyable", "objective": wish, "directions": count,
    }  # fmt: skip
    began = time.perf_counter()
    try:
        path, found = connect_by_program(
            START, goal, zones, RADIUS_M, SPEED_M_S, wish, directions=count, limits=replace(limits, gap=0.05)
        )
    except InfeasibleError as error:
        return row | {"time_s": time.perf_counter() - began, "refused": error.message}
    time_s = time.perf_counter() - began
    return row | {
        "time_s": time_s, **_ended(found), "length_m": path.length_m, "effort_m_s": effort_m_s(path),
        "time_to_tangent": time_s / tangent_s, "length_to_tangent": path.length_m / line.length_m,
    }  # fmt: skip


def _ended(found: Trajectory) -> dict[str, Any]:
    """The status and how well the objective is known."""
    known = {"value": found.objective, "bound": found.bound, "gap": found.gap}
    finite = {name: number if math.isfinite(number) else None for name, number in known.items()}
    return {"status": found.status, **finite, "nodes": found.nodes, "entered": found.entered}


def effort_m_s(path: Path) -> float:
    """Changes of both coordinates of the velocity along a line, summed."""
    angles_rad = path.sample(1.0)[:, 2]
    changes = np.abs(np.diff(np.cos(angles_rad))) + np.abs(np.diff(np.sin(angles_rad)))
    return SPEED_M_S * float(changes.sum())


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
