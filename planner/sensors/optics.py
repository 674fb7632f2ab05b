"""A frame camera's lens and chip, and the ground that a pixel of it covers.

Source: W. Stecz, K. Gromada, "Determining UAV Flight Trajectory for Target Recognition Using EO/IR and SAR",
Sensors 20 (2020) 5712, section 2.2, equations 2 to 5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Optics:
    """Lens and chip.

    Parameters
    ----------
    focal_length_m
        Of the lens itself, not its equivalent on 35 mm film.
    pixel_pitch_m
        Between pixels.
    columns, rows
        Pixels across and along the flight direction, as it is mounted.
    """

    focal_length_m: float
    pixel_pitch_m: float
    columns: int
    rows: int

    def __post_init__(self) -> None:
        if not all(
            math.isfinite(value) and value > 0.0 for value in (self.focal_length_m, self.pixel_pitch_m)
        ):
            raise ValueError("focal length and pixel pitch are positive lengths")
        if min(self.columns, self.rows) < 1:
            raise ValueError("an image has a pixel at least either way")

    @property
    def half_width_rad(self) -> float:
        """Half of the angle of view across the flight direction."""
        return math.atan(self.columns * self.pixel_pitch_m / (2.0 * self.focal_length_m))

    @property
    def half_height_rad(self) -> float:
        """Half of the angle of view along the flight direction."""
        return math.atan(self.rows * self.pixel_pitch_m / (2.0 * self.focal_length_m))

    def gsd_m(self, height_m: float) -> float:
        """Ground sampled distance straight down (equation 2)."""
        return self.pixel_pitch_m / self.focal_length_m * height_m

    def height_for_m(self, gsd_m: float) -> float:
        """The height over ground from which a pixel covers this much straight down, by equation 2."""
        return gsd_m * self.focal_length_m / self.pixel_pitch_m

    def footprint_m(self, height_m: float) -> tuple[float, float]:
        """Ground seen straight down, across and along the flight direction."""
        gsd_m = self.gsd_m(height_m)
        return self.columns * gsd_m, self.rows * gsd_m


def gsd_ground_plane_m(straight_down_m: float, look_rad: float) -> float:
    """The distance on the ground plane at a look angle, for angles near a right one (equation 3).

    Parameters
    ----------
    straight_down_m
        Of equation 2.
    look_rad
        ε, between the ground and the line of sight's plane; π/2 straight down.
    """
    return straight_down_m / _positive_sine(look_rad)


def gsd_along_m(pixel_over_focal: float, height_m: float, look_rad: float, down_rad: float) -> float:
    """Along the line of sight (equation 4): the slant range's pixel over the sine of ε + α − 90°.

    The slant range is taken as h / sin α. The equation is printed with h / cos α, which is without end for
    the camera that looks straight down (α = 90°), where equation 2 has to come out.

    Parameters
    ----------
    pixel_over_focal
        Pixel pitch over focal length.
    look_rad
        ε at the place looked at.
    down_rad
        α, how far the camera looks down; π/2 straight down.
    """
    slant_m = height_m / _positive_sine(down_rad)
    return pixel_over_focal * slant_m / _positive_sine(look_rad + down_rad - math.pi / 2.0)


def gsd_across_m(straight_down_m: float, look_rad: float, down_rad: float) -> float:
    """Across the line of sight (equation 5)."""
    return straight_down_m / _positive_sine(look_rad + down_rad - math.pi / 2.0)


def gsd_mean_m(pixel_over_focal: float, height_m: float, look_rad: float, down_rad: float) -> float:
    """The mean of along and across, which stands for both at low angles."""
    along_m = gsd_along_m(pixel_over_focal, height_m, look_rad, down_rad)
    across_m = gsd_across_m(pixel_over_focal * height_m, look_rad, down_rad)
    return (along_m + across_m) / 2.0


def _positive_sine(angle_rad: float) -> float:
    sine = math.sin(angle_rad)
    if not sine > 1e-12:
        raise ValueError(f"at an angle of {math.degrees(angle_rad):g}° no ground is seen")
    return sine
