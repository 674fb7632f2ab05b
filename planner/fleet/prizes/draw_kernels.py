"""Compiled random numbers from a state of the caller's, so that threads do not share one."""

# mypy: allow-untyped-decorators

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

State = NDArray[np.uint64]

_SHIFTS = (np.uint64(12), np.uint64(25), np.uint64(27))
_FACTOR = np.uint64(2685821657736338717)
_KEPT = np.uint64(11)
_UNIT = 1.0 / 9007199254740992.0


def seeded(seed: int, stream: int = 0) -> State:
    """A state, uint64 (1,), for one of several streams of a seed."""
    words = np.random.SeedSequence([seed, stream]).generate_state(1, np.uint64)
    return words | np.uint64(1)


@njit(cache=True, nogil=True, inline="always")
def draw(state: State) -> float:
    """Uniform in [0, 1): xorshift64* (S. Vigna, "An experimental exploration of Marsaglia's xorshift
    generators, scrambled", ACM Transactions on Mathematical Software 42 (2016)).
    """
    x = state[0]
    x ^= x >> _SHIFTS[0]
    x ^= x << _SHIFTS[1]
    x ^= x >> _SHIFTS[2]
    state[0] = x
    return float((x * _FACTOR) >> _KEPT) * _UNIT
