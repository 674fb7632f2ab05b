"""The order of many regions: local search over orders, the best options found anew with each move."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.coverage.ways import Options
from planner.progress import Progress, Stop, raise_if
from planner.routing.large import kernels
from planner.vehicle.wind import CIRCLE_RAD, still_air_factor

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Regions whose centroids are among this many nearest count as neighbours.
NEIGHBOURS = 10
#: Rounds of the search, and regions taken out and put back in each: their product is the whole budget.
ROUNDS = 20
PUT_BACK = 30_000
#: Largest number of regions taken out at once.
MOST_OUT = 10
#: Blocks of costs are kept up to this many bytes; all are given up and made anew beyond it.
POOL_BYTES = 600_000_000
LONGEST_RUN = 40


def large_order(
    orders: list[Ints],
    centroids: Floats,
    options: list[Options],
    first: Floats,
    last: Floats,
    around: Surroundings,
    discs: Floats,
    seed: int,
    progress: Progress,
    stop: Stop,
    enough: Stop,
) -> tuple[float, Ints]:
    """The best order found within an iteration budget; the same for the same seed.

    Parameters
    ----------
    orders
        To begin with, int64 (C,) each.
    centroids
        Of the regions, (C, 2).
    first, last
        Costs from the start to each option (its own included) and from it to the end, (N,), regions side by
        side.
    discs
        What to go round, (K, 3).
    stop, enough
        Asked between rounds: the one cancels, the other ends the search with what has been found.

    Returns
    -------
    tuple
        Estimated cost and the order.
    """
    sizes = np.array([len(o.inner_m) for o in options], dtype=np.int64)
    count, width = len(options), int(sizes.max())
    at = np.concatenate([[0], np.cumsum(sizes)])

    def padded(rows: list[Floats], fill: float) -> Floats:
        out = np.full((count, width, *rows[0].shape[1:]), fill)
        for c, row in enumerate(rows):
            out[c, : len(row)] = row
        return out

    capacity = max(2, min(count * count, POOL_BYTES // (4 * width * width)))
    gaps = np.hypot(*(centroids[:, None, :] - centroids[None, :, :]).transpose(2, 0, 1))
    nearest = np.argsort(gaps + np.diag(np.full(count, -1.0)), axis=1, kind="stable")[:, 1:]
    near = np.zeros((count, count), dtype=np.bool_)
    for c in range(count):
        near[c, nearest[c, :NEIGHBOURS]] = True
    near |= near.T
    web = kernels.Web(
        first=padded([first[at[c] : at[c + 1]] for c in range(count)], np.inf),
        last=padded([last[at[c] : at[c + 1]] for c in range(count)], np.inf),
        pool=np.empty((capacity, width, width), dtype=np.float32),
        slots=np.full((count, count), -1, dtype=np.int64),
        used=np.zeros(1, dtype=np.int64),
        exits=padded([o.exits for o in options], 0.0),
        entries=padded([o.entries for o in options], 0.0),
        inner=padded([o.inner_m for o in options], np.inf),
        counts=sizes,
        radius=around.radius_m,
        discs=discs,
        wind=_wind(around),
    )
    tried = [kernels.reverse_runs(order, LONGEST_RUN, near, web) for order in orders]
    cost_m, order = min(tried, key=lambda found: float(found[0]))
    most = max(1, min(MOST_OUT, 3 * count // 4))
    iterations = max(1, PUT_BACK // (ROUNDS * most))
    for index in range(ROUNDS):
        raise_if(stop)
        progress("routing", 0.1 + 0.3 * index / ROUNDS)
        if enough():
            break
        heat_m = 0.002 * float(cost_m) * (1.0 - index / ROUNDS) / max(1.0, count / 10.0)
        cost_m, order = kernels.ruin_and_recreate(
            order, iterations, seed * ROUNDS + index, most, heat_m, near, nearest, web
        )
    cost_m, order = kernels.reverse_runs(order, LONGEST_RUN, near, web)
    return float(cost_m), order


def _wind(around: Surroundings) -> Floats:
    """The wind as ``large_kernels.in_wind`` takes it."""
    wind = around.wind
    if wind.speed_m_s == 0.0:
        return np.zeros(4)
    strength = wind.speed_m_s / around.airspeed_m_s
    mean = float(still_air_factor(CIRCLE_RAD, around.airspeed_m_s, wind).mean())
    return np.array(
        [strength * math.cos(wind.toward_rad), strength * math.sin(wind.toward_rad), strength, mean]
    )
