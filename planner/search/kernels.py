"""What passes see of ground by cells; the plain twin is ``programme.Sweep.sees``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.jit import njit

Floats = NDArray[np.float64]

#: Columns of a sweep's row: start, unit vector along, then from and to ahead and aside.
COLUMNS = 8


@njit(cache=True, nogil=True)
def _around(
    sweep: Floats, west_m: float, south_m: float, cell_m: float, rows: int, columns: int
) -> tuple[int, int, int, int]:
    """First and last row, first and last column of the cells that a sweep may see."""
    east, north, ahead_e, ahead_n, from_m, to_m, right_m, left_m = sweep
    least_e, most_e, least_n, most_n = np.inf, -np.inf, np.inf, -np.inf
    for far in (from_m, to_m):
        for side in (right_m, left_m):
            e = east + far * ahead_e - side * ahead_n
            n = north + far * ahead_n + side * ahead_e
            least_e, most_e = min(least_e, e), max(most_e, e)
            least_n, most_n = min(least_n, n), max(most_n, n)
    return (
        max(0, int(np.floor((least_n - south_m) / cell_m - 0.5))),
        min(rows - 1, int(np.ceil((most_n - south_m) / cell_m - 0.5))),
        max(0, int(np.floor((least_e - west_m) / cell_m - 0.5))),
        min(columns - 1, int(np.ceil((most_e - west_m) / cell_m - 0.5))),
    )


@njit(cache=True, nogil=True)
def mark_seen(seen: NDArray[np.bool_], west_m: float, south_m: float, cell_m: float, sweeps: Floats) -> None:
    """Mark the cells (rows, columns) whose middle one of the sweeps (N, 8) sees."""
    rows, columns = seen.shape
    for k in range(len(sweeps)):
        east, north, ahead_e, ahead_n, from_m, to_m, right_m, left_m = sweeps[k]
        if to_m < from_m or left_m < right_m:
            continue
        first_row, last_row, first_column, last_column = _around(
            sweeps[k], west_m, south_m, cell_m, rows, columns
        )
        for i in range(first_row, last_row + 1):
            n = south_m + (i + 0.5) * cell_m - north
            for j in range(first_column, last_column + 1):
                if seen[i, j]:
                    continue
                e = west_m + (j + 0.5) * cell_m - east
                ahead = e * ahead_e + n * ahead_n
                aside = n * ahead_e - e * ahead_n
                seen[i, j] = from_m <= ahead <= to_m and right_m <= aside <= left_m


@njit(cache=True, nogil=True)
def take_looks(
    left: Floats, west_m: float, south_m: float, cell_m: float, sweeps: Floats, miss: float
) -> None:
    """Multiply by ``miss``, for each sweep (N, 8) that sees it, what is left of each cell (rows, columns)."""
    rows, columns = left.shape
    for k in range(len(sweeps)):
        east, north, ahead_e, ahead_n, from_m, to_m, right_m, left_m = sweeps[k]
        if to_m < from_m or left_m < right_m:
            continue
        first_row, last_row, first_column, last_column = _around(
            sweeps[k], west_m, south_m, cell_m, rows, columns
        )
        for i in range(first_row, last_row + 1):
            n = south_m + (i + 0.5) * cell_m - north
            for j in range(first_column, last_column + 1):
                e = west_m + (j + 0.5) * cell_m - east
                ahead = e * ahead_e + n * ahead_n
                aside = n * ahead_e - e * ahead_n
                if from_m <= ahead <= to_m and right_m <= aside <= left_m:
                    left[i, j] *= miss


@njit(cache=True, nogil=True)
def drifting_gains(
    left: Floats,
    places: Floats,
    drifts: Floats,
    sweeps: Floats,
    begins_s: Floats,
    lengths_m: Floats,
    speeds_m_s: Floats,
    miss: float,
) -> Floats:
    """What each sweep (N, 8) finds of places (M, 2) that drift on, those before it taken off.

    A place is looked at where it is when the aircraft is abeam of it, or nearest to that on its pass.

    Parameters
    ----------
    left
        float64 (M,): how likely each place is, and what is missed so far; changed.
    begins_s, lengths_m, speeds_m_s
        (N,): when each pass begins, its length and the speed over the ground.
    """
    gains = np.zeros(len(sweeps))
    for k in range(len(sweeps)):
        east, north, ahead_e, ahead_n, from_m, to_m, right_m, left_m = sweeps[k]
        lasts_s = lengths_m[k] / speeds_m_s[k]
        for i in range(len(places)):
            e = places[i, 0] + begins_s[k] * drifts[i, 0] - east
            n = places[i, 1] + begins_s[k] * drifts[i, 1] - north
            on_m_s = drifts[i, 0] * ahead_e + drifts[i, 1] * ahead_n
            off_m_s = drifts[i, 1] * ahead_e - drifts[i, 0] * ahead_n
            ahead, aside = e * ahead_e + n * ahead_n, n * ahead_e - e * ahead_n
            at_s = ahead / max(speeds_m_s[k] - on_m_s, 1e-6)
            at_s = min(lasts_s, max(0.0, at_s))
            ahead, aside = ahead + at_s * on_m_s, aside + at_s * off_m_s
            if from_m <= ahead <= to_m and right_m <= aside <= left_m:
                gains[k] += (1.0 - miss) * left[i]
                left[i] *= miss
    return gains
