"""Resolution and aperture of a SAR's modes.

Stripmap keeps the beam abeam, or squinted by a fixed angle; spotlight turns it to stay on one place, so that
the aperture may be as long as the wanted resolution asks; ScanSAR shares one aperture's time among several
sub-swaths. I. G. Cumming and F. H. Wong, "Digital Processing of Synthetic Aperture Radar Data", 2005,
chapter 4 (CW); A. Moreira et al., "A Tutorial on Synthetic Aperture Radar", IEEE GRSM 1(1), 2013, section II
(M).
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Mode = Literal["stripmap", "spotlight", "scansar"]


def azimuth_resolution_m(wavelength_m: float, turned_rad: float, squint_rad: float = 0.0) -> float:
    """δ = λ / (4 sin(Δθ/2) cos θ_sq): resolution of an aperture seen under Δθ from the place.

    For small Δθ it is λ / (2Δθ); where Δθ = λ/D is the real antenna's beam that is D/2 (CW, M).
    """
    return wavelength_m / (4.0 * math.sin(turned_rad / 2.0) * math.cos(squint_rad))


def turned_for_rad(wavelength_m: float, resolution_m: float, squint_rad: float = 0.0) -> float:
    """Δθ that a resolution asks for: the inverse of ``azimuth_resolution_m``; NaN where none gives it."""
    sine = wavelength_m / (4.0 * resolution_m * math.cos(squint_rad))
    return 2.0 * math.asin(sine) if sine <= 1.0 else math.nan


def stripmap_aperture_m(range_m: float, beamwidth_rad: float, squint_rad: float = 0.0) -> float:
    """L = R θ_A / cos² θ_sq: the way along which a place abeam at slant range R stays in the beam (CW)."""
    return range_m * beamwidth_rad / math.cos(squint_rad) ** 2


def crabbed_aperture_m(
    range_m: float, beamwidth_rad: float, squint_rad: float, look_rad: float, yaw_rad: ArrayLike
) -> NDArray[np.float64]:
    """The same where the antenna is turned about the vertical by ψ besides.

    The angle φ of a place from the antenna's plane abeam is that of squint, sin φ = x_b / ρ, with x_b its
    distance ahead along the antenna's axis and ρ its slant range. Along the track a, dx_b/da = cos ψ and
    dρ/da = a / ρ, so that L = θ_A / (dφ/da) = R θ_A / (cos θ_sq (cos θ_sq cos ψ − sin θ_sq sin ψ sin θ)), θ
    the look angle; without ψ that is ``stripmap_aperture_m``, without squint R θ_A / cos ψ.
    """
    cos, sin = math.cos(squint_rad), math.sin(squint_rad)
    turned = cos * np.cos(yaw_rad) - sin * math.sin(look_rad) * np.sin(yaw_rad)
    return np.asarray(range_m * beamwidth_rad / (cos * turned), dtype=np.float64)


def spot_m(range_m: float, beamwidth_rad: float) -> float:
    """Length along track of the ground that a turning beam holds all the time: R θ_A, as it is abeam.

    Away from abeam the place is farther and the beam on it wider.
    """
    return range_m * beamwidth_rad


def scansar_resolution_m(stripmap_m: float, sub_swaths: int) -> float:
    """N sub-swaths take turns of 1/(N + 1) of the aperture each, so δ = (N + 1) δ_stripmap (after M)."""
    return (sub_swaths + 1) * stripmap_m if sub_swaths > 1 else stripmap_m
