"""Visiting order of the regions: section 4.3.1 of Li, Chen, Wang, Li (2018).

The regions stand for their centroids and the threats are left out, as in the paper. An open tour: from the
start through all regions to the end, which may be the same place.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.routing import kernels

TourMethod = Literal["genetic", "exact", "auto"]
Floats = NDArray[np.float64]
Orders = NDArray[np.int64]

#: Held–Karp keeps 2^N·N lengths: 1.8 MB at this N.
EXACT_UP_TO = 14

_POPULATION = 120
_GENERATIONS = 400
_PATIENCE = 80
_TOURNAMENT = 3
_CROSSOVER = 0.9
_MUTATION = 0.3
_ELITE = 4


def order(
    centroids: ArrayLike,
    start: tuple[float, float],
    end: tuple[float, float],
    method: TourMethod = "auto",
    seed: int = 0,
) -> tuple[int, ...]:
    """Indices of the regions in visiting order.

    Parameters
    ----------
    centroids
        Shape (N, 2): east_m, north_m.
    start, end
        East and north in metres.
    method
        ``"genetic"`` is the paper's (its reference [69]): order crossover, inversion and move mutations,
        tournament selection; the same order for the same seed. ``"exact"`` is Held–Karp up to
        ``EXACT_UP_TO`` regions, beyond them 2-opt and Or-opt from nearest neighbours, which is not exact.
        ``"auto"`` is ``"exact"``.
    seed
        Of the genetic algorithm; the others have nothing random.
    """
    places = np.asarray(centroids, dtype=np.float64).reshape(-1, 2)
    if len(places) < 2:
        return tuple(range(len(places)))
    legs_m = _distances(places, places)
    first_m = _distances(places, np.asarray([start], dtype=np.float64))[:, 0]
    last_m = _distances(places, np.asarray([end], dtype=np.float64))[:, 0]
    if method == "genetic":
        found = _genetic(legs_m, first_m, last_m, np.random.default_rng(seed))
    elif method not in ("exact", "auto"):
        raise ValueError(f"no such method for the visiting order: {method!r}")
    elif len(places) <= EXACT_UP_TO:
        found = kernels.held_karp(legs_m, first_m, last_m)
    else:
        found = kernels.improve(legs_m, first_m, last_m, _nearest_neighbours(legs_m, first_m))
    return tuple(int(index) for index in found)


def tour_length_m(
    centroids: ArrayLike, start: tuple[float, float], end: tuple[float, float], visiting: tuple[int, ...]
) -> float:
    """Length from the start through the centroids in an order to the end."""
    places = np.asarray(centroids, dtype=np.float64).reshape(-1, 2)[list(visiting)]
    line = np.vstack([[start], places, [end]])
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def _distances(places: Floats, others: Floats) -> Floats:
    gaps = places[:, None, :] - others[None, :, :]
    distances_m: Floats = np.hypot(gaps[..., 0], gaps[..., 1])
    return distances_m


def _nearest_neighbours(legs_m: Floats, first_m: Floats) -> Orders:
    free = np.ones(len(first_m), dtype=np.bool_)
    found = np.empty(len(first_m), dtype=np.int64)
    from_here_m = first_m
    for position in range(len(found)):
        place = int(np.argmin(np.where(free, from_here_m, np.inf)))
        found[position] = place
        free[place] = False
        from_here_m = legs_m[place]
    return found


def _lengths(legs_m: Floats, first_m: Floats, last_m: Floats, orders: Orders) -> Floats:
    lengths_m: Floats = first_m[orders[:, 0]] + last_m[orders[:, -1]]
    lengths_m += legs_m[orders[:, :-1], orders[:, 1:]].sum(axis=1)
    return lengths_m


def _genetic(legs_m: Floats, first_m: Floats, last_m: Floats, rng: np.random.Generator) -> Orders:
    count = len(first_m)
    population = rng.permuted(np.tile(np.arange(count), (_POPULATION, 1)), axis=1)
    lengths_m = _lengths(legs_m, first_m, last_m, population)
    best: Orders = population[np.argmin(lengths_m)].copy()
    best_m, idle = float(lengths_m.min()), 0
    for _ in range(_GENERATIONS):
        mothers, fathers = population[_select(lengths_m, rng)], population[_select(lengths_m, rng)]
        children = np.where(
            rng.random((_POPULATION, 1)) < _CROSSOVER, _order_crossover(mothers, fathers, rng), mothers
        )
        children = np.where(rng.random((_POPULATION, 1)) < _MUTATION, _invert(children, rng), children)
        children = np.where(rng.random((_POPULATION, 1)) < _MUTATION, _move(children, rng), children)
        children[:_ELITE] = population[np.argsort(lengths_m, kind="stable")[:_ELITE]]
        population, lengths_m = children, _lengths(legs_m, first_m, last_m, children)
        idle += 1
        if lengths_m.min() < best_m - kernels.LEAST_GAIN_M:
            best, best_m, idle = population[np.argmin(lengths_m)].copy(), float(lengths_m.min()), 0
        if idle >= _PATIENCE:
            break
    return best


def _select(lengths_m: Floats, rng: np.random.Generator) -> Orders:
    """Winners of one tournament each, shape (P,)."""
    rivals = rng.integers(0, len(lengths_m), (len(lengths_m), _TOURNAMENT))
    best = np.argmin(lengths_m[rivals], axis=1)[:, None]
    winners: Orders = np.take_along_axis(rivals, best, axis=1).reshape(-1)
    return winners


def _stretches(shape: tuple[int, int], rng: np.random.Generator) -> tuple[Orders, Orders]:
    """A random stretch [low, high) of positions a row, each (P, 1)."""
    ends = np.sort(rng.integers(0, shape[1] + 1, (shape[0], 2)), axis=1)
    return ends[:, :1], ends[:, 1:]


def _order_crossover(mothers: Orders, fathers: Orders, rng: np.random.Generator) -> Orders:
    """A stretch of the mother where it stands, the rest in the father's order."""
    positions = np.arange(mothers.shape[1])
    low, high = _stretches((mothers.shape[0], mothers.shape[1]), rng)
    kept = (positions >= low) & (positions < high)
    where = np.argsort(mothers, axis=1)
    fathers_kept = np.take_along_axis(kept, np.take_along_axis(where, fathers, axis=1), axis=1)
    genes = np.take_along_axis(fathers, np.argsort(fathers_kept, axis=1, kind="stable"), axis=1)
    slots = np.argsort(kept, axis=1, kind="stable")
    children = np.empty_like(mothers)
    np.put_along_axis(children, slots, genes, axis=1)
    return np.where(kept, mothers, children)


def _invert(orders: Orders, rng: np.random.Generator) -> Orders:
    """Turn round a stretch."""
    positions = np.arange(orders.shape[1])
    low, high = _stretches((orders.shape[0], orders.shape[1]), rng)
    source = np.where((positions >= low) & (positions < high), low + high - 1 - positions, positions)
    return np.take_along_axis(orders, source, axis=1)


def _move(orders: Orders, rng: np.random.Generator) -> Orders:
    """Move the last place of a stretch to its front."""
    positions = np.arange(orders.shape[1])
    low, high = _stretches((orders.shape[0], orders.shape[1]), rng)
    inner = (positions > low) & (positions < high)
    source = np.where(inner, positions - 1, np.where((positions == low) & (high > low), high - 1, positions))
    return np.take_along_axis(orders, source, axis=1)
