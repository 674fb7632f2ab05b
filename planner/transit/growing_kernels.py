"""Compiled lists that grow: arrays with twice the room."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Array = NDArray[np.float64]
Index = NDArray[np.int64]


@njit(cache=True)
def more(rows: Array, fill: float) -> Array:
    """Twice the room, the new half filled."""
    grown = np.full((2 * rows.shape[0], rows.shape[1]), fill)
    grown[: rows.shape[0]] = rows
    return grown


@njit(cache=True)
def longer(values: Array) -> Array:
    """Twice the room."""
    grown = np.empty(2 * len(values))
    grown[: len(values)] = values
    return grown


@njit(cache=True)
def longer_indices(values: Index) -> Index:
    """Twice the room."""
    grown = np.empty(2 * len(values), dtype=np.int64)
    grown[: len(values)] = values
    return grown
