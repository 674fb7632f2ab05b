"""Transits among 30 random circles: ours beside OMPL on the same problems, in one run.

Problems are seeded: a square of 10 km with 30 hard discs of 150 m to 700 m, and a pose at either end. In the
set ``open`` the ends leave room for a full turn, in the set ``tight`` they are anywhere outside the discs.
OMPL plans in its own Dubins state space with the same turn radius and is given a second for each problem; its
states are checked every few metres by a compiled test, ours are exact. Rows: one a problem with
``--option each=true``, one a set and planner of figures over all problems, one a set of ratios.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from planner.airspace.zones import Disc, KeepOut
from planner.errors import InfeasibleError
from planner.route import Anchor
from planner.transit.tangent import connect, forget_searches

HALF_MAP_M = 5_000.0
DISCS = 30
DISC_M = (150.0, 700.0)
RADIUS_M = 100.0

#: OMPL checks states this far apart along a motion.
OMPL_STEP_M = 5.0

#: Room for a full turn to either side of an end.
OPEN_M = 2.0 * RADIUS_M

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Problem:
    """One pose to another among discs, float64 (30, 3): east_m, north_m, radius_m."""

    start: Anchor
    goal: Anchor
    discs: Array


def problem(seed: int, tight: bool = False) -> Problem:
    """The problem of a seed: ends at least half the map apart, both clear of every disc."""
    generator = np.random.default_rng(seed)
    discs = np.column_stack(
        [generator.uniform(-HALF_MAP_M, HALF_MAP_M, (DISCS, 2)), generator.uniform(*DISC_M, DISCS)]
    )

    def end() -> Anchor:
        while True:
            east_m, north_m = generator.uniform(-HALF_MAP_M, HALF_MAP_M, 2)
            gaps_m = np.hypot(discs[:, 0] - east_m, discs[:, 1] - north_m) - discs[:, 2]
            if gaps_m.min() > (0.0 if tight else OPEN_M):
                return Anchor(float(east_m), float(north_m), float(generator.uniform(-math.pi, math.pi)))

    while True:
        start, goal = end(), end()
        if math.dist(start.position, goal.position) > HALF_MAP_M:
            return Problem(start, goal, discs)


def keep_out_of(given: Problem) -> KeepOut:
    """The discs as the connector takes them."""
    return KeepOut(
        tuple(Disc(f"d{k}", float(e), float(n), float(r), True) for k, (e, n, r) in enumerate(given.discs))
    )


def run(
    problems: int = 40,
    seconds: float = 1.0,
    planner: str = "BITstar",
    repeats: int = 3,
    sets: tuple[str, ...] = ("open", "tight"),
    each: bool = False,
) -> Iterator[dict[str, Any]]:
    """Rows of figures and of ratios for each set.

    Parameters
    ----------
    problems
        Seeds 0 to ``problems`` - 1.
    seconds
        OMPL's time for each problem; 0 leaves OMPL out.
    planner
        Name of a planner of ``ompl.geometric``.
    repeats
        Ours is timed so often; the median counts.
    each
        Rows for each problem, too.
    """
    peer = _ompl(planner) if seconds > 0.0 else None
    _ours(problem(0), 1)
    for name in sets:
        ours, theirs = [], []
        for seed in range(problems):
            given = problem(seed, name == "tight")
            ours.append(_ours(given, repeats))
            theirs.append(peer(given, seconds) if peer is not None else (math.nan, math.nan))
            if each:
                yield {
                    "bench": "transit-problem", "set": name, "seed": seed,
                    "direct_m": math.dist(given.start.position, given.goal.position),
                    "length_m": _number(ours[-1][0]), "time_s": ours[-1][1],
                    "ompl_length_m": _number(theirs[-1][0]), "ompl_time_s": _number(theirs[-1][1]),
                }  # fmt: skip
        yield _figures(name, "tangent", np.array(ours))
        if peer is None:
            why = "the package ompl is not installed" if seconds > 0.0 else "left out: seconds=0"
            yield {"bench": "transit", "set": name, "planner": planner, "absent": why}
            continue
        yield _figures(name, planner, np.array(theirs))
        yield _ratios(name, planner, np.array(ours), np.array(theirs))


def _ours(given: Problem, repeats: int) -> tuple[float, float]:
    """Length, NaN without a line, and median time of finding it."""
    length_m, times_s = math.nan, []
    for _ in range(repeats):
        zones = keep_out_of(given)
        forget_searches()
        began = time.perf_counter()
        try:
            length_m = connect(given.start, given.goal, zones, RADIUS_M).length_m
        except InfeasibleError:
            length_m = math.nan
        times_s.append(time.perf_counter() - began)
    return length_m, float(np.median(times_s))


@njit(cache=True)
def _outside(east_m: float, north_m: float, discs: Array) -> bool:
    for k in range(discs.shape[0]):
        if (east_m - discs[k, 0]) ** 2 + (north_m - discs[k, 1]) ** 2 < discs[k, 2] ** 2:
            return False
    return True


def _ompl(planner: str) -> Callable[[Problem, float], tuple[float, float]] | None:
    """The same by OMPL: length and time; None where it is not installed."""
    try:
        base, geometric, util = (import_module(f"ompl.{part}") for part in ("base", "geometric", "util"))
    except ModuleNotFoundError:
        return None
    util.setLogLevel(util.LogLevel.LOG_ERROR)
    util.RNG.setSeed(1)

    def solve(given: Problem, seconds: float) -> tuple[float, float]:
        space = base.DubinsStateSpace(RADIUS_M)
        bounds = base.RealVectorBounds(2)
        bounds.setLow(-1.5 * HALF_MAP_M)
        bounds.setHigh(1.5 * HALF_MAP_M)
        space.setBounds(bounds)
        setup = geometric.SimpleSetup(space)
        setup.setStateValidityChecker(lambda s: bool(_outside(s.getX(), s.getY(), given.discs)))
        information = setup.getSpaceInformation()
        information.setStateValidityCheckingResolution(OMPL_STEP_M / space.getMaximumExtent())
        states = []
        for end in (given.start, given.goal):
            state = space.allocState()
            state.setXY(end.east_m, end.north_m)
            state.setYaw(end.angle_rad)
            states.append(state)
        setup.setStartAndGoalStates(*states, 1e-6)
        setup.setOptimizationObjective(base.PathLengthOptimizationObjective(information))
        setup.setPlanner(getattr(geometric, planner)(information))
        began = time.perf_counter()
        setup.solve(seconds)
        took_s = time.perf_counter() - began
        length_m = setup.getSolutionPath().length() if setup.haveExactSolutionPath() else math.nan
        return length_m, took_s

    return solve


def _figures(name: str, planner: str, found: Array) -> dict[str, Any]:
    lengths_m, times_s = found[:, 0], found[:, 1]
    return {
        "bench": "transit", "set": name, "planner": planner, "problems": len(found),
        "solved": int(np.isfinite(lengths_m).sum()), "mean_length_m": float(np.nanmean(lengths_m)),
        "median_s": float(np.median(times_s)), "p95_s": float(np.percentile(times_s, 95.0)),
        "max_s": float(times_s.max()),
    }  # fmt: skip


def _ratios(name: str, planner: str, ours: Array, theirs: Array) -> dict[str, Any]:
    both = np.isfinite(ours[:, 0]) & np.isfinite(theirs[:, 0])
    ratios = ours[both, 0] / theirs[both, 0]
    return {
        "bench": "transit-ratio", "set": name, "against": planner, "both_solved": int(both.sum()),
        "only_ompl_solved": int((np.isnan(ours[:, 0]) & np.isfinite(theirs[:, 0])).sum()),
        "length_ratio_mean": float(ratios.mean()) if both.any() else None,
        "length_ratio_max": float(ratios.max()) if both.any() else None,
        "times_faster": float(np.median(theirs[:, 1]) / np.median(ours[:, 1])),
    }  # fmt: skip


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
