"""What is to be covered among obstacles: an area, its buildings, a footprint and an aircraft."""

from __future__ import annotations

import math
from dataclasses import dataclass

from shapely.geometry import Polygon

from planner.errors import InfeasibleError

#: Metres east and north.
Place = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Building:
    """An obstacle: its outline and how high it stands over the ground."""

    outline: Polygon
    height_m: float


@dataclass(frozen=True, slots=True)
class UrbanArea:
    """An area to be seen whole by one aircraft at one height, in local metres.

    Parameters
    ----------
    area
        What is to be seen, and where it is flown. It may have holes.
    buildings
        What stands in it, or near it.
    width_m, length_m
        Of the ground that one photo sees, across and along the flight (F_w and F_l of Majeed and Lee 2019).
    height_m
        Over the ground, of all sweeps (their H_min): what is low enough below it is flown over.
    max_height_m
        How high obstacles may be flown over (their H_max).
    clearance_m
        From obstacles, to the side and above them (their D_safe).
    start, end
        Where the flight begins and ends.
    span_m
        Of the aircraft. What is narrower is not entered; the area's edge is kept clear of by half of it.
    turn_radius_m
        0 for an aircraft that stops and turns on the spot.
    speed_m_s, stop_s
        Of flight, and what such a stop with its turn takes.
    max_climb_rad
        Steepest climb and descent where obstacles are flown over.
    """

    area: Polygon
    buildings: tuple[Building, ...]
    width_m: float
    length_m: float
    height_m: float
    max_height_m: float
    clearance_m: float
    start: Place
    end: Place
    span_m: float = 1.0
    turn_radius_m: float = 0.0
    speed_m_s: float = 10.0
    stop_s: float = 4.0
    max_climb_rad: float = math.pi / 2.0

    def __post_init__(self) -> None:
        positive = {
            "width_m": self.width_m,
            "length_m": self.length_m,
            "height_m": self.height_m,
            "speed_m_s": self.speed_m_s,
            "max_climb_rad": self.max_climb_rad,
        }
        for name, value in positive.items():
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} is {value}, not above 0")
        if not self.max_height_m >= self.height_m:
            raise InfeasibleError(
                "height",
                "area",
                f"flight at {self.height_m:g} m is above the highest allowed, {self.max_height_m:g} m",
                f"a highest height of {self.height_m:g} m or more",
            )

    def passes_over(self, building: Building) -> bool:
        """Whether sweeps pass over a building with the clearance: it is no obstacle (section 3.2.2)."""
        return building.height_m + self.clearance_m <= self.height_m

    def may_climb_over(self, top_m: float) -> bool:
        """Whether an obstacle of this height may be flown over, below the highest height (d_top, eq. 7)."""
        return top_m + self.clearance_m <= self.max_height_m
