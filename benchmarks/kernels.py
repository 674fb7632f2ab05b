"""Lengths of Dubins lines: the compiled kernel on one core, a chunked numpy version, and OMPL's ``distance``.

All take the same seeded pairs of poses in one run. OMPL is called from Python once a pair; what such a call
costs by itself is measured on a space whose distance is trivial, and rates net of it are given, too. Rows:
one a contestant, then one of ratios and of the largest differences in length.
"""

from __future__ import annotations

import json
import math
import statistics
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from planner.dubins.kernels import dubins_lengths
from planner.dubins.words import shortest
from planner.route import Pose

RADIUS_M = 100.0
HALF_MAP_M = 5_000.0

#: Pairs at a time in numpy: arrays that stay in the cache of a core.
CHUNK = 4_096

Array = NDArray[np.float64]


def pairs(count: int, seed: int = 0) -> tuple[Array, Array]:
    """Starts and goals, each (count, 3); every fourth goal lies near its start, where words of arcs win."""
    generator = np.random.default_rng(seed)

    def poses() -> Array:
        return np.column_stack(
            [
                generator.uniform(-HALF_MAP_M, HALF_MAP_M, (count, 2)),
                generator.uniform(-math.pi, math.pi, count),
            ]
        )

    starts, goals = poses(), poses()
    near = slice(0, None, 4)
    goals[near, :2] = starts[near, :2] + generator.uniform(
        -4.0 * RADIUS_M, 4.0 * RADIUS_M, goals[near, :2].shape
    )
    return starts, goals


def _wrapped(turn_rad: Array) -> Array:
    wrapped: Array = turn_rad - 2.0 * np.pi * np.floor(turn_rad / (2.0 * np.pi))
    return np.where(2.0 * np.pi - wrapped < 1e-9, 0.0, wrapped)


def numpy_lengths(starts: Array, goals: Array, radius_m: float) -> Array:
    """Lengths in metres, shape (N,), of the shortest of the six words, by whole arrays."""
    alpha, beta = starts[:, 2], goals[:, 2]
    de, dn = ((goals[:, :2] - starts[:, :2]) / radius_m).T
    sa, ca, sb, cb = np.sin(alpha), np.cos(alpha), np.sin(beta), np.cos(beta)
    best = np.full(len(de), np.inf)
    for s in (1.0, -1.0):
        ce, cn = de - s * sb + s * sa, dn + s * cb - s * ca
        p = np.hypot(ce, cn)
        phi = np.arctan2(cn, ce)
        best = np.minimum(best, _wrapped(s * (phi - alpha)) + p + _wrapped(s * (beta - phi)))
        near = np.flatnonzero(p <= 4.0)
        lean = np.arccos(p[near] / 4.0) + 0.5 * np.pi
        turns = _wrapped(s * (phi[near] - alpha[near]) + lean) + _wrapped(s * (beta[near] - phi[near]) + lean)
        best[near] = np.minimum(best[near], turns + 2.0 * lean)
        ce, cn = de + s * sb + s * sa, dn - s * cb - s * ca
        square = ce * ce + cn * cn - 4.0
        p = np.sqrt(np.maximum(square, 0.0))
        phi = np.arctan2(2.0 * s * ce + p * cn, p * ce - 2.0 * s * cn)
        length = _wrapped(s * (phi - alpha)) + p + _wrapped(s * (phi - beta))
        best = np.where(square >= 0.0, np.minimum(best, length), best)
    return radius_m * best


def chunked_lengths(starts: Array, goals: Array, radius_m: float, chunk: int = CHUNK) -> Array:
    """``numpy_lengths`` by so many pairs at a time."""
    return np.concatenate(
        [
            numpy_lengths(starts[k : k + chunk], goals[k : k + chunk], radius_m)
            for k in range(0, len(starts), chunk)
        ]
    )


def run(
    count: int = 500_000, plain: int = 20_000, peer: int = 100_000, repeats: int = 5, seed: int = 0
) -> Iterator[dict[str, Any]]:
    """Rows of pairs a second and of ratios.

    Parameters
    ----------
    count, plain, peer
        Pairs for the compiled and the numpy version, for the plain one, and for OMPL.
    repeats
        Runs of each; the median counts.
    """
    starts, goals = pairs(count, seed)
    dubins_lengths(starts[:2], goals[:2], RADIUS_M)
    compiled, numpy_m = np.empty(0), np.empty(0)
    compiled_s, numpy_s = [], []
    # In turns, so that whatever else the machine does slows both.
    for _ in range(repeats):
        compiled, taken_s = _timed(lambda: dubins_lengths(starts, goals, RADIUS_M))
        compiled_s.append(taken_s)
        numpy_m, taken_s = _timed(lambda: chunked_lengths(starts, goals, RADIUS_M))
        numpy_s.append(taken_s)
    rate, numpy_rate = count / statistics.median(compiled_s), count / statistics.median(numpy_s)
    plain_m, plain_s = _timed(lambda: _plain(starts[:plain], goals[:plain]))
    yield _row("compiled", count, rate)
    yield _row("numpy, chunked", count, numpy_rate)
    yield _row("plain", plain, plain / plain_s)
    ratios: dict[str, Any] = {
        "bench": "kernels-ratio",
        "to_numpy": rate / numpy_rate,
        "to_plain": rate / (plain / plain_s),
        "off_numpy_m": _off(compiled, numpy_m),
        "off_plain_m": _off(compiled, plain_m),
        "off_plain_ulp": float((np.abs(compiled[:plain] - plain_m) / np.spacing(plain_m)).max()),
    }
    other = _ompl(starts[:peer], goals[:peer], repeats)
    if other is None:
        yield {"bench": "kernels", "contestant": "OMPL", "absent": "the package ompl is not installed"}
    else:
        other_m, gross_s, net_s = other
        yield _row("OMPL distance", peer, peer / gross_s) | {"net_pairs_per_s": peer / net_s}
        ratios |= {
            "to_ompl": rate * gross_s / peer,
            "to_ompl_net": rate * net_s / peer,
            "off_ompl_m": _off(compiled, other_m),
        }
    yield ratios


def _timed(work: Callable[[], Array]) -> tuple[Array, float]:
    # Of this core: what others do on the machine at the same time counts less.
    began = time.thread_time()
    found = work()
    return found, time.thread_time() - began


def _plain(starts: Array, goals: Array) -> Array:
    pairs_of = zip(starts.tolist(), goals.tolist(), strict=True)
    return np.array([shortest(Pose(*a), Pose(*b), RADIUS_M).length_m for a, b in pairs_of])


def _off(ours: Array, others: Array) -> float:
    return float(np.abs(ours[: len(others)] - others).max())


def _row(contestant: str, count: int, rate: float) -> dict[str, Any]:
    return {"bench": "kernels", "contestant": contestant, "pairs": count, "pairs_per_s": rate}


def _ompl(starts: Array, goals: Array, repeats: int) -> tuple[Array, float, float] | None:
    """Lengths, time, and time less that of as many trivial calls; None where OMPL is not installed."""
    try:
        base = import_module("ompl.base")
    except ModuleNotFoundError:
        return None
    space = base.DubinsStateSpace(RADIUS_M)

    def states(poses: Array) -> list[Any]:
        made = []
        for east_m, north_m, angle_rad in poses.tolist():
            state = space.allocState()
            state.setXY(east_m, north_m)
            state.setYaw(angle_rad)
            made.append(state)
        return made

    a, b = states(starts), states(goals)
    trivial = base.RealVectorStateSpace(1)
    nothing = trivial.allocState()
    others = np.empty(0)
    gross_s, empty_s = [], []
    for _ in range(repeats):
        others, taken_s = _timed(lambda: np.array([space.distance(x, y) for x, y in zip(a, b, strict=True)]))
        gross_s.append(taken_s)
        _, taken_s = _timed(
            lambda: np.array([trivial.distance(nothing, nothing) for _ in zip(a, b, strict=True)])
        )
        empty_s.append(taken_s)
    gross = statistics.median(gross_s)
    return others, gross, max(gross - statistics.median(empty_s), 1e-9)


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
