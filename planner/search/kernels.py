"""What passes see of ground by cells; the plain twin is ``programme.Sweep.sees``."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Columns of a sweep's row: start, unit vector along, then from and to ahead and aside.
COLUMNS = 8


@njit(cache=True, nogil=True)
def mark_seen(seen: NDArray[np.bool_], west_m: float, south_m: float, cell_m: float, sweeps: Floats) -> None:
    """Mark the cells (rows, columns) whose middle one of the sweeps (N, 8) sees."""
    rows, columns = seen.shape
    for k in range(len(sweeps)):
        east, north, ahead_e, ahead_n, from_m, to_m, right_m, left_m = sweeps[k]
        if to_m < from_m or left_m < right_m:
            continue
        least_e, most_e, least_n, most_n = np.inf, -np.inf, np.inf, -np.inf
        for far in (from_m, to_m):
            for side in (right_m, left_m):
                e = east + far * ahead_e - side * ahead_n
                n = north + far * ahead_n + side * ahead_e
                least_e, most_e = min(least_e, e), max(most_e, e)
                least_n, most_n = min(least_n, n), max(most_n, n)
        first_row = max(0, int(np.floor((least_n - south_m) / cell_m - 0.5)))
        last_row = min(rows - 1, int(np.ceil((most_n - south_m) / cell_m - 0.5)))
        first_column = max(0, int(np.floor((least_e - west_m) / cell_m - 0.5)))
        last_column = min(columns - 1, int(np.ceil((most_e - west_m) / cell_m - 0.5)))
        for i in range(first_row, last_row + 1):
            n = south_m + (i + 0.5) * cell_m - north
            for j in range(first_column, last_column + 1):
                if seen[i, j]:
                    continue
                e = west_m + (j + 0.5) * cell_m - east
                ahead = e * ahead_e + n * ahead_n
                aside = n * ahead_e - e * ahead_n
                seen[i, j] = from_m <= ahead <= to_m and right_m <= aside <= left_m
