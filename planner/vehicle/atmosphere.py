"""The standard atmosphere, below 11 km."""

from __future__ import annotations

import math

#: Temperature lapse over temperature at sea level, per metre, and the exponent of density (ISO 2533).
LAPSE_PER_M, DENSITY_EXPONENT = 2.25577e-5, 4.25588


def density_ratio(above_sea_m: float) -> float:
    """Density of the air over that at sea level."""
    inside_m = min(max(above_sea_m, -1_000.0), 11_000.0)
    return float((1.0 - LAPSE_PER_M * inside_m) ** DENSITY_EXPONENT)


def true_over_equivalent(above_sea_m: float) -> float:
    """True airspeed over equivalent airspeed."""
    return 1.0 / math.sqrt(density_ratio(above_sea_m))
