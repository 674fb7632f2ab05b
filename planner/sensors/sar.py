"""Side-looking synthetic aperture radar: stripmap, spotlight and ScanSAR, with or without squint.

Geometry of Li, Chen, Wang, Li (2018), "Sensor-Oriented Path Planning for Multiregion Surveillance with a
Single Lightweight UAV SAR", section 3. With h = 500 m, θ_L = 45°, θ_B = 30° and θ_A = 10° the formulas give
l_s = 123.41 m, l_sw = 577.35 m and a near-end distance of 288.68 m; the paper's Table 1 prints 228.68 m for
the last, a slip of the pen. Squint and the modes besides stripmap are in ``sar_modes``, what a crab in the
wind does to the strip in ``strip``; lengths here are those without.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.route import Look
from planner.sensors import sar_modes, spot
from planner.sensors.sar_modes import Mode

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SarSensor:
    """A SAR.

    Parameters
    ----------
    incidence_rad
        θ_L, of the beam centre, from the vertical.
    elevation_beamwidth_rad
        θ_B, of the whole swath: of all sub-swaths together in ScanSAR.
    azimuth_beamwidth_rad
        θ_A.
    looks
        The sides it can look to.
    resolution_m
        Ground resolution it delivers in its mode; None where unknown.
    squint_rad
        From the plane abeam, forward positive: ground at slant range R is seen R·tan ahead of the aircraft.
    mode, sub_swaths
        Mode, and the sub-swaths of ScanSAR.
    turned_rad
        Spotlight: the angle the line turns round the place, for the wanted resolution.
    relief_m
        The ground's height above and below the mean, to either side: the swath is then what the beam holds of
        every ground between, the aperture that of the lowest.
    pointing_margin_rad
        Planning leaves out this much of the beam at either edge, so that it may roll by as much, and begins
        and ends each pass so much further out that it may turn by as much from abeam.
    position_margin_m
        Planning leaves out this much of the swath at either edge, and begins and ends each pass so much
        further out, so that the aircraft may be off its place by as much.
    stabilised
        Whether the antenna is kept abeam of the course; otherwise it is fixed to the aircraft.
    drift, toward_rad
        Of the wind it is flown in: its speed by the airspeed, and where the air moves to.
    """

    name: str
    incidence_rad: float
    elevation_beamwidth_rad: float
    azimuth_beamwidth_rad: float
    looks: tuple[Look, ...] = ("right",)
    resolution_m: float | None = None
    squint_rad: float = 0.0
    mode: Mode = "stripmap"
    sub_swaths: int = 1
    turned_rad: float | None = None
    relief_m: float = 0.0
    pointing_margin_rad: float = 0.0
    position_margin_m: float = 0.0
    stabilised: bool = False
    drift: float = 0.0
    toward_rad: float = 0.0

    @property
    def kind(self) -> str:
        """``sar``."""
        return "sar"

    def in_wind(self, drift: float, toward_rad: float) -> Self:
        """The same sensor on an aircraft in a steady wind."""
        return replace(self, drift=drift, toward_rad=toward_rad)

    @property
    def crabs(self) -> bool:
        """Whether the beam turns with the nose: no antenna that is steered, to stay abeam or on its place."""
        return self.drift != 0.0 and not self.stabilised and self.mode != "spotlight"

    def yaw_rad(self, course_rad: ArrayLike, look: Look) -> Floats:
        """How far the beam of an antenna fixed to the aircraft turns forward, on courses given.

        The nose points off the course by asin(W sin δ / V) to the left, δ from the wind's direction to the
        course (``planner.vehicle.wind``): forward for a beam to the right, backward for one to the left.
        """
        course = np.asarray(course_rad, dtype=np.float64)
        if not self.crabs:
            return np.zeros(course.shape)
        crab = np.arcsin(np.clip(self.drift * np.sin(course - self.toward_rad), -1.0, 1.0))
        return np.asarray(crab if look == "right" else -crab, dtype=np.float64)

    def over_relief(self, relief_m: float) -> Self:
        """The same sensor over ground this much above and below its mean height."""
        return replace(self, relief_m=relief_m)

    def whole(self) -> Self:
        """The same sensor without margins: what it really sees."""
        return replace(self, pointing_margin_rad=0.0, position_margin_m=0.0)

    @property
    def steepest_rad(self) -> float:
        """Of the beam's edges that nearer the vertical, without the margin: θ_L − θ_B/2."""
        return self.incidence_rad - self.elevation_beamwidth_rad / 2.0 + self.pointing_margin_rad

    @property
    def flattest_rad(self) -> float:
        """Of the beam's edges that nearer the horizon, without the margin: θ_L + θ_B/2."""
        return self.incidence_rad + self.elevation_beamwidth_rad / 2.0 - self.pointing_margin_rad

    def near_m(self, height_m: float) -> float:
        """Ground distance from the track to the near edge of the swath, h·tan(θ_L − θ_B/2)."""
        return (height_m + self.relief_m) * math.tan(self.steepest_rad) + self.position_margin_m

    def far_m(self, height_m: float) -> float:
        """Ground distance from the track to the far edge of the swath, h·tan(θ_L + θ_B/2)."""
        return (height_m - self.relief_m) * math.tan(self.flattest_rad) - self.position_margin_m

    def swath_m(self, height_m: float) -> float:
        """Swath width l_sw on the ground, eq 1."""
        return self.far_m(height_m) - self.near_m(height_m)

    def aperture_m(self, height_m: float) -> float:
        """Synthetic aperture length l_s, eq 5; with squint by ``sar_modes``, in spotlight by ``spot``."""
        if self.turned_rad is not None:
            return self._spot_line_m(height_m, self.turned_rad)
        range_m = (height_m + self.relief_m) / math.cos(self.incidence_rad)
        return sar_modes.stripmap_aperture_m(range_m, self.azimuth_beamwidth_rad, self.squint_rad)

    def _spot_line_m(self, height_m: float, turned_rad: float) -> float:
        """The line from which all of the spot is resolved as at the beam's centre, margins or none."""
        half_rad = self.elevation_beamwidth_rad / 2.0
        near, far = (1.0 / math.cos(self.incidence_rad + off) for off in (-half_rad, half_rad))
        high_m, low_m = height_m - self.relief_m, height_m + self.relief_m
        ahead = math.tan(self.squint_rad) * (near + far) / 2.0
        reach_m = sar_modes.spot_m(near * low_m, self.azimuth_beamwidth_rad) / 2.0
        return spot.line_for_m(
            spot.sine_wanted(turned_rad, self.squint_rad),
            near * high_m,
            far * low_m,
            min(ahead * high_m, ahead * low_m) - reach_m,
            max(ahead * high_m, ahead * low_m) + reach_m,
        )

    def leads_m(self, height_m: float) -> tuple[float, float]:
        """How far ahead of the aircraft the swath's ground is seen, R·tan θ_sq: least and most, with margin.

        In spotlight the beam is kept on its place and has no margin along the track.
        """
        margin_rad = 0.0 if self.turned_rad is not None else self.pointing_margin_rad
        least, most = math.tan(self.squint_rad - margin_rad), math.tan(self.squint_rad + margin_rad)
        nearest_m = math.hypot(self.near_m(height_m), max(height_m - self.relief_m, 0.0))
        farthest_m = math.hypot(self.far_m(height_m), height_m + self.relief_m)
        return (
            min(nearest_m * least, farthest_m * least),
            max(nearest_m * most, farthest_m * most),
        )

    def run_in_m(self, height_m: float) -> float:
        """How far before the ground the sensor must be on: half an aperture, squint's lead, margin."""
        return self.aperture_m(height_m) / 2.0 + self.leads_m(height_m)[1] + self.position_margin_m

    def run_out_m(self, height_m: float) -> float:
        """How far beyond the ground the sensor must be on."""
        return self.aperture_m(height_m) / 2.0 - self.leads_m(height_m)[0] + self.position_margin_m

    def spot_m(self, height_m: float) -> float:
        """Length along track of what one pass can see: of the spot in spotlight, else without limit."""
        if self.turned_rad is None:
            return math.inf
        whole_rad = self.incidence_rad - self.elevation_beamwidth_rad / 2.0
        near, far = (1.0 / math.cos(angle) for angle in (whole_rad, 2.0 * self.incidence_rad - whole_rad))
        spot_m = sar_modes.spot_m((height_m - self.relief_m) * near, self.azimuth_beamwidth_rad)
        # Squinted, the spot of higher or lower ground lies nearer or farther ahead.
        moved_m = self.relief_m * abs(math.tan(self.squint_rad)) * (near + far) / 2.0
        return spot_m - 2.0 * moved_m - 2.0 * self.position_margin_m

    def collection_m(self, height_m: float, span_m: float) -> float:
        """Length of a collection segment over an along-track span, eq 6."""
        return self.run_in_m(height_m) + span_m + self.run_out_m(height_m)
