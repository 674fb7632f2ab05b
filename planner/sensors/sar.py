"""Side-looking synthetic aperture radar in stripmap mode without squint.

Geometry of Li, Chen, Wang, Li (2018), "Sensor-Oriented Path Planning for Multiregion Surveillance with a
Single Lightweight UAV SAR", section 3. With h = 500 m, θ_L = 45°, θ_B = 30° and θ_A = 10° the formulas give
l_s = 123.41 m, l_sw = 577.35 m and a near-end distance of 288.68 m; the paper's Table 1 prints 228.68 m for
the last, a slip of the pen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

Look = Literal["left", "right"]


@dataclass(frozen=True, slots=True)
class SarSensor:
    """A stripmap SAR.

    Parameters
    ----------
    incidence_rad
        θ_L, of the beam centre, from the vertical.
    elevation_beamwidth_rad
        θ_B.
    azimuth_beamwidth_rad
        θ_A.
    looks
        The sides it can look to.
    resolution_m
        Ground resolution it delivers; None where unknown.
    """

    name: str
    incidence_rad: float
    elevation_beamwidth_rad: float
    azimuth_beamwidth_rad: float
    looks: tuple[Look, ...] = ("right",)
    resolution_m: float | None = None

    def near_m(self, height_m: float) -> float:
        """Ground distance from the track to the near edge of the swath, h·tan(θ_L − θ_B/2)."""
        return height_m * math.tan(self.incidence_rad - self.elevation_beamwidth_rad / 2.0)

    def far_m(self, height_m: float) -> float:
        """Ground distance from the track to the far edge of the swath, h·tan(θ_L + θ_B/2)."""
        return height_m * math.tan(self.incidence_rad + self.elevation_beamwidth_rad / 2.0)

    def swath_m(self, height_m: float) -> float:
        """Swath width l_sw on the ground, eq 1."""
        return self.far_m(height_m) - self.near_m(height_m)

    def aperture_m(self, height_m: float) -> float:
        """Synthetic aperture length l_s, eq 5."""
        return height_m / math.cos(self.incidence_rad) * self.azimuth_beamwidth_rad

    def collection_m(self, height_m: float, span_m: float) -> float:
        """Length of a collection segment over an along-track span, eq 6."""
        return span_m + self.aperture_m(height_m)
