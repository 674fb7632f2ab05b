"""Transits among 30 random circles: ours beside OMPL on the same problems, in one run.

Problems are seeded: a square of 10 km with 30 hard discs of 150 m to 700 m, and a pose at either end. In the
set ``open`` the ends leave room for a full turn, in the set ``tight`` they are anywhere outside the discs.
OMPL plans in its own Dubins state space with the same turn radius; its states are checked every few metres
by a compiled test, ours are exact. It is an anytime planner that takes all the time it is given, so its time
says nothing: it is looked at as it goes on, and compared at equal time (the first look not before ours is
done) and by the time to equal quality (the first look at which its line is no more than 1 % longer). Problems
whose shortest line is that without discs are counted as ``direct``. Rows: one a problem with
``--option each=true``, one a set and planner of figures over all problems, one a set of comparisons.
"""

from __future__ import annotations

import json
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.airspace.zones import Disc, KeepOut
from planner.dubins.kernels import dubins_lengths
from planner.errors import InfeasibleError
from planner.jit import njit
from planner.route import Anchor
from planner.transit.tangent import connect, forget_searches

HALF_MAP_M = 5_000.0
DISCS = 30
DISC_M = (150.0, 700.0)
RADIUS_M = 100.0

#: OMPL is looked at after a millisecond, and from then on whenever this much more of its time is gone.
FIRST_LOOK_S = 1e-3
LOOKS_APART = 1.5
#: A line longer by no more than this is as good.
EQUAL = 1.01

#: Lines that differ by no more than this are one.
DIRECT_M = 0.01

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
        OMPL's time for each problem, at most; 0 leaves OMPL out.
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
        ours: list[tuple[float, float]] = []
        theirs: list[tuple[Look, ...]] = []
        direct = 0
        for seed in range(problems):
            given = problem(seed, name == "tight")
            ours.append(_ours(given, repeats))
            direct += _is_direct(given, ours[-1][0])
            theirs.append(peer(given, seconds) if peer is not None else ())
            if each:
                yield {
                    "bench": "transit-problem", "set": name, "seed": seed,
                    "direct_m": math.dist(given.start.position, given.goal.position),
                    "length_m": _number(ours[-1][0]), "time_s": ours[-1][1],
                    "ompl": [(look.time_s, _number(look.length_m)) for look in theirs[-1]],
                }  # fmt: skip
        yield _figures(name, "tangent", np.array(ours))
        if peer is None:
            why = "the package ompl is not installed" if seconds > 0.0 else "left out: seconds=0"
            yield {"bench": "transit", "set": name, "planner": planner, "absent": why}
            continue
        last = np.array([(looks[-1].length_m, looks[-1].time_s) for looks in theirs])
        yield _figures(name, planner, last)
        yield _compared(name, planner, ours, theirs) | {"direct": direct}


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


def _is_direct(given: Problem, length_m: float) -> bool:
    """Whether a line is no longer than the shortest without discs."""
    start, goal = (np.array([[end.east_m, end.north_m, end.angle_rad]]) for end in (given.start, given.goal))
    return bool(length_m <= dubins_lengths(start, goal, RADIUS_M)[0] + DIRECT_M)


@njit(cache=True)
def _outside(east_m: float, north_m: float, discs: Array) -> bool:
    for k in range(discs.shape[0]):
        if (east_m - discs[k, 0]) ** 2 + (north_m - discs[k, 1]) ** 2 < discs[k, 2] ** 2:
            return False
    return True


@dataclass(frozen=True, slots=True)
class Look:
    """What a planner had after a time: its length, NaN without a line."""

    time_s: float
    length_m: float


def _ompl(planner: str) -> Callable[[Problem, float], tuple[Look, ...]] | None:
    """The same by OMPL, looked at as it goes on; None where it is not installed."""
    try:
        base, geometric, util = (import_module(f"ompl.{part}") for part in ("base", "geometric", "util"))
    except ModuleNotFoundError:
        return None
    util.setLogLevel(util.LogLevel.LOG_ERROR)
    util.RNG.setSeed(1)

    def solve(given: Problem, seconds: float) -> tuple[Look, ...]:
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
        looks: list[Look] = []
        spent_s, until_s = 0.0, min(FIRST_LOOK_S, seconds)
        while spent_s < seconds:
            began = time.perf_counter()
            setup.solve(until_s - spent_s)
            spent_s += time.perf_counter() - began
            found = setup.haveExactSolutionPath()
            looks.append(Look(spent_s, setup.getSolutionPath().length() if found else math.nan))
            until_s = min(max(until_s, spent_s) * LOOKS_APART, seconds)
        return tuple(looks)

    return solve


def _figures(name: str, planner: str, found: Array) -> dict[str, Any]:
    lengths_m, times_s = found[:, 0], found[:, 1]
    return {
        "bench": "transit", "set": name, "planner": planner, "problems": len(found),
        "solved": int(np.isfinite(lengths_m).sum()), "mean_length_m": float(np.nanmean(lengths_m)),
        "median_s": float(np.median(times_s)), "p95_s": float(np.percentile(times_s, 95.0)),
        "max_s": float(times_s.max()),
    }  # fmt: skip


def _compared(
    name: str, planner: str, ours: Sequence[tuple[float, float]], theirs: Sequence[Sequence[Look]]
) -> dict[str, Any]:
    """At equal time, by the time to equal quality, and at the end of OMPL's time."""
    solved = [(mine, looks) for mine, looks in zip(ours, theirs, strict=True) if math.isfinite(mine[0])]
    # The first look not before ours was done: in OMPL's favour.
    then = [next((look for look in looks if look.time_s >= mine[1]), looks[-1]) for mine, looks in solved]
    equal_s = [
        next((look.time_s for look in looks if look.length_m <= EQUAL * mine[0]), math.inf)
        for mine, looks in solved
    ]
    there = [second / mine[1] for second, (mine, _) in zip(equal_s, solved, strict=True)]
    at_once = [look.length_m / mine[0] for look, (mine, _) in zip(then, solved, strict=True)]
    at_end = [mine[0] / looks[-1].length_m for mine, looks in solved]
    return {
        "bench": "transit-compared", "set": name, "against": planner, "solved": len(solved),
        "only_ompl_solved": sum(
            math.isnan(mine[0]) and math.isfinite(looks[-1].length_m)
            for mine, looks in zip(ours, theirs, strict=True)
        ),
        "at_equal_time_solved": int(np.isfinite(at_once).sum()),
        "at_equal_time_ompl_to_ours_median_of_solved": _middle(at_once),
        "equal_quality_reached": int(np.isfinite(equal_s).sum()),
        "equal_quality_median_s_of_reached": _middle(equal_s),
        "equal_quality_times_ours_median_of_reached": _middle(there),
        "at_end_solved": int(np.isfinite(at_end).sum()),
        "at_end_ours_to_ompl_mean": float(np.nanmean(at_end)) if np.isfinite(at_end).any() else None,
        "at_end_ours_to_ompl_max": float(np.nanmax(at_end)) if np.isfinite(at_end).any() else None,
    }  # fmt: skip


def _middle(values: Sequence[float]) -> float | None:
    """Median of those that are finite; None where none is."""
    finite = [value for value in values if math.isfinite(value)]
    return float(np.median(finite)) if finite else None


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
