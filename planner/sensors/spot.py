"""What a spotlight pass resolves: not only at the beam's centre, but all over its spot.

From a place at slant range R abeam, the line of sight to an aircraft x along the track from abeam makes an
angle θ with the plane abeam, sin θ = x / √(x² + R²). An aperture from x₁ to x₂ resolves along the track

    δ = λ / (2 (sin θ₂ − sin θ₁)) = λ / (4 sin(Δθ/2) cos θ_m),

with Δθ = θ₂ − θ₁ and θ_m their mean: ``sar_modes.azimuth_resolution_m``. It is worse the farther a place is,
so a line just long enough for the beam's centre is too short for the far edge.
"""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

#: A line is found to this; a longer one than any flight means that no line is long enough.
LINE_M = 1e-3
LONGEST_M = 1e7


def sine_turned(first_m: ArrayLike, last_m: ArrayLike, range_m: ArrayLike) -> Floats:
    """sin θ₂ − sin θ₁ of an aperture seen from places, its ends along the track from abeam of each."""
    first, last, away = (np.asarray(value, dtype=np.float64) for value in (first_m, last_m, range_m))
    return np.asarray(last / np.hypot(last, away) - first / np.hypot(first, away))


def sine_wanted(turned_rad: float, squint_rad: float) -> float:
    """What a resolution asks for: 2 sin(Δθ/2) cos θ_sq of the turn at the beam's centre."""
    return 2.0 * math.sin(turned_rad / 2.0) * math.cos(squint_rad)


@lru_cache(maxsize=4096)
def line_for_m(wanted: float, near_m: float, far_m: float, least_m: float, most_m: float) -> float:
    """The shortest line from which every place of a spot is resolved; inf where none is long enough.

    Between the spot's corners it is nowhere worse: along the track the sine turned falls from abeam of the
    line's middle to both sides, and over range it rises to one greatest value and falls again.

    Parameters
    ----------
    wanted
        ``sine_wanted``.
    near_m, far_m
        Least and greatest slant range abeam.
    least_m, most_m
        Least and greatest way of the places ahead of the line's middle.
    """
    corners = np.array(list(product((near_m, far_m), (least_m, most_m))))

    def enough(length_m: float) -> bool:
        ends = (-length_m / 2.0 - corners[:, 1], length_m / 2.0 - corners[:, 1])
        return bool((sine_turned(*ends, corners[:, 0]) >= wanted).all())

    low_m, high_m = 0.0, max(far_m, 1.0)
    while not enough(high_m):
        low_m, high_m = high_m, 2.0 * high_m
        if high_m > LONGEST_M:
            return math.inf
    while high_m - low_m > LINE_M:
        middle_m = (low_m + high_m) / 2.0
        low_m, high_m = (low_m, middle_m) if enough(middle_m) else (middle_m, high_m)
    return high_m
