"""The air's density by height: autopilots hold the airspeed that their pitot tube tells, not the true one.

Written for itself: what judges missions by flying them shares nothing with what encodes them.
"""

from __future__ import annotations

import math

_SCALE_PER_M, _EXPONENT, _TROPOPAUSE_M = 2.25577e-5, 4.25588, 11_000.0


def density_ratio(above_sea_m: float) -> float:
    """Density over that at sea level, in the standard atmosphere (ISO 2533) below 11 km."""
    inside_m = min(max(above_sea_m, 0.0), _TROPOPAUSE_M)
    return float((1.0 - _SCALE_PER_M * inside_m) ** _EXPONENT)


def true_over_equivalent(above_sea_m: float) -> float:
    """True airspeed over the equivalent one."""
    return 1.0 / math.sqrt(density_ratio(above_sea_m))
