"""Compiled: numbers drawn by chance, the same from the same seed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit


@njit(cache=True, nogil=True)
def drawn(state: NDArray[np.uint64]) -> float:
    """A number in [0, 1): xorshift, Marsaglia (2003). ``state``, (1,), is not 0 and is changed."""
    x = state[0]
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    state[0] = x
    return float(x >> np.uint64(11)) * (1.0 / 9007199254740992.0)
