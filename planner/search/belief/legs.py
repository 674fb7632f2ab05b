"""Lines of legs changed corner by corner, for as long as more is found, or sooner."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.indexed import Running, flown_by
from planner.search.belief.patterns import Searcher

Floats = NDArray[np.float64]

#: Corners are moved by these parts of a swath: from, to.
MOVED = (0.05, 1.0)
#: So much longer than it may fly a line's corners are kept: what is cut off comes back where it gets shorter.
LONGER = 1.1
#: What is gained by less is gained of the places that it was found by alone.
LEAST = 3e-4


def reached(corners: Floats, one: Searcher) -> Floats:
    """The corners of those that a searcher comes to, and a little more."""
    along_m = np.concatenate([[0.0], np.hypot(*np.diff(corners, axis=0).T).cumsum()])
    return corners[: max(3, int(np.searchsorted(along_m, LONGER * one.track_m)) + 1)]


def improve(
    running: Running,
    corners: list[Floats],
    searchers: Sequence[Searcher],
    clear: Callable[[Floats], bool],
    tries: int,
    generator: np.random.Generator,
    enough: Callable[[], bool],
) -> None:
    """Legs moved, put in, taken out or flown in another order, where the whole gets better.

    Parameters
    ----------
    corners
        Of each aircraft of ``running``, its base first; changed with its line.
    clear
        Whether a line may be flown.
    """
    for _ in range(tries):
        if enough():
            return
        index = int(generator.integers(len(corners)))
        searcher = searchers[index]
        changed = _changed(corners[index], 2.0 * searcher.half_width_m, generator)
        line = flown_by(changed, searcher)
        if clear(line) and running.better(index, line, LEAST):
            corners[index] = changed


def _changed(corners: Floats, swath_m: float, generator: np.random.Generator) -> Floats:
    """One change of one line; the base stays."""
    count = len(corners)
    at = int(generator.integers(1, count))
    low, high = np.log(MOVED)
    moved = swath_m * math.exp(generator.uniform(low, high)) * generator.standard_normal(2)
    kind = generator.random()
    if kind < 0.7:
        # A corner, a leg, or some legs.
        many = 1 if kind < 0.4 else 2 if kind < 0.6 else int(generator.integers(2, 6))
        found = corners.copy()
        found[at : at + many] += moved
        return found
    if kind < 0.8:
        return np.insert(corners, at, 0.5 * (corners[at - 1] + corners[at]) + moved, axis=0)
    if kind < 0.9 and count > 4:
        return np.delete(corners, slice(at, at + int(generator.integers(1, 3))), axis=0)
    until = at + int(generator.integers(2, 8))
    return np.concatenate([corners[:at], corners[at:until][::-1], corners[until:]])
