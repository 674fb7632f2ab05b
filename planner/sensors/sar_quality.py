"""How much can be made out in a radar image, and how far to fly for one.

Source: Stecz and Gromada 2020 (see ``optics``), equations 9, 10, 17 and 18; after Gutchess et al. and Nolan
et al.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Final

Coefficients = tuple[float, float, float]

#: a, b and c of equation 10 by elevation angle in degrees; the paper gives one row.
NOLAN: Final[dict[float, Coefficients]] = {15.0: (5.29, 1.91, 0.32)}


def niirs_by_range(slant_km: float, down_rad: float) -> float:
    """NIIRS by slant range and depression angle (equation 9).

    The paper names no units; kilometres and radians give values on the scale.
    """
    return 5.606 - 0.763 * slant_km + 3.657 * down_rad - 3.422 * down_rad**2


def niirs_by_resolution(
    gsd_m: float, snr: float, elevation_deg: float, table: Mapping[float, Coefficients] = NOLAN
) -> float:
    """NIIRS by ground sampled distance, noise and elevation angle (equation 10).

    Between two rows of the table the coefficients are interpolated; beyond it nothing is known. The paper
    prints a − b·log10(GSD) with b = −1.91, by which coarser images would be better; b is positive here.

    Raises
    ------
    ValueError
        The elevation is beyond the table, or a number is not positive.
    """
    if not (gsd_m > 0.0 and snr > 0.0):
        raise ValueError("ground sampled distance and signal to noise ratio are positive")
    a, b, c = _coefficients(elevation_deg, table)
    return a - b * math.log10(gsd_m) + c * math.log10(math.log10(1.0 + snr))


def _coefficients(elevation_deg: float, table: Mapping[float, Coefficients]) -> Coefficients:
    rows = sorted(table)
    if not rows or not rows[0] <= elevation_deg <= rows[-1]:
        known = f"{rows[0]:g}° to {rows[-1]:g}°" if rows else "no elevation"
        raise ValueError(f"coefficients are known for {known}, not for {elevation_deg:g}°: add a row")
    above = next(row for row in rows if row >= elevation_deg)
    below = next(row for row in reversed(rows) if row <= elevation_deg)
    share = 0.0 if above == below else (elevation_deg - below) / (above - below)
    low, high = table[below], table[above]
    return (
        low[0] + share * (high[0] - low[0]),
        low[1] + share * (high[1] - low[1]),
        low[2] + share * (high[2] - low[2]),
    )


def aperture_length_m(slant_m: float, wavelength_m: float, resolution_m: float, factor: float = 1.0) -> float:
    """L_A, the way flown for one image of a cross-range resolution (equation 17); γ is ``factor``."""
    if not min(slant_m, wavelength_m, resolution_m, factor) > 0.0:
        raise ValueError("range, wavelength, resolution and factor are positive")
    return factor * slant_m * wavelength_m / (2.0 * resolution_m)


def mosaic_length_m(aperture_m: float, images: int) -> float:
    """The way flown for a mosaic of images (equation 18); a continuous strip is any length from one on."""
    if images < 1:
        raise ValueError("a mosaic has an image at least")
    return aperture_m * images


def mosaic_overlaps(image_length_m: float, aperture_m: float) -> bool:
    """Whether images side by side overlap: each is longer than the way flown for it (Q > L_A)."""
    return image_length_m > aperture_m
