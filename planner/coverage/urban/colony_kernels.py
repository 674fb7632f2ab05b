"""Compiled ant colony for the order of footprint sweeps (Majeed and Lee 2019, section 3.5, eqs 3 to 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@njit(cache=True, nogil=True)
def colony_tour(
    distances: Floats, draws: Floats, alpha: float, beta: float, rho: float, deposit: float, trail: float
) -> Ints:
    """The shortest closed tour that an ant walked.

    Parameters
    ----------
    distances
        (M, M), d_ij > 0 for i != j; the visibility η_ij is its inverse.
    draws
        Uniform in [0, 1), (iterations, ants, M): of each ant's walk, its first point and each choice.
    alpha, beta
        α and β of eq. 3.
    rho
        ρ of eq. 4, what evaporates.
    deposit
        K of eq. 6.
    trail
        τ_ij before the first iteration.
    """
    count = len(distances)
    sight = np.empty((count, count))
    for i in range(count):
        for j in range(count):
            sight[i, j] = 0.0 if i == j else (1.0 / distances[i, j]) ** beta
    tau = np.full((count, count), trail)
    weights = np.empty((count, count))
    best = np.arange(count)
    best_m = np.inf
    allowed = np.empty(count, dtype=np.int64)
    tours = np.empty((draws.shape[1], count), dtype=np.int64)
    lengths = np.empty(draws.shape[1])
    for iteration in range(draws.shape[0]):
        for i in range(count):
            for j in range(count):
                weights[i, j] = tau[i, j] ** alpha * sight[i, j] if alpha != 1.0 else tau[i, j] * sight[i, j]
        for ant in range(draws.shape[1]):
            left = count
            for i in range(count):
                allowed[i] = i
            pick = int(draws[iteration, ant, 0] * count)
            length_m = 0.0
            for step in range(count):
                here = allowed[pick]
                tours[ant, step] = here
                left -= 1
                allowed[pick] = allowed[left]
                if left == 0:
                    break
                total = 0.0
                for k in range(left):
                    total += weights[here, allowed[k]]
                # eq. 3: the point at which the running sum passes the draw
                mark = draws[iteration, ant, step + 1] * total
                pick = left - 1
                running = 0.0
                for k in range(left):
                    running += weights[here, allowed[k]]
                    if running > mark:
                        pick = k
                        break
                length_m += distances[here, allowed[pick]]
            length_m += distances[tours[ant, count - 1], tours[ant, 0]]
            lengths[ant] = length_m
            if length_m < best_m:
                best_m = length_m
                best = tours[ant].copy()
        for i in range(count):
            for j in range(count):
                tau[i, j] *= 1.0 - rho
        for ant in range(draws.shape[1]):
            for step in range(count):
                i, j = tours[ant, step], tours[ant, (step + 1) % count]
                tau[i, j] += deposit / lengths[ant]
                tau[j, i] += deposit / lengths[ant]
    return best
