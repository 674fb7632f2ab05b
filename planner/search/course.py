"""What a disc under the aircraft sees of ground along a line with flyable turns, within an energy.

The disc looks straight down whatever the bank, as a camera on a gimbal does, so that it sees in turns, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.search.course_kernels import disc_worth, rounded
from planner.search.values import Worth
from planner.vehicle.energy import STANDARD_GRAVITY_M_S2, FlightState, PowerModel

Floats = NDArray[np.float64]
Place = tuple[float, float]

#: Vertices on arcs are no farther apart than this, and circles have so many to a quarter.
CHORD_M, QUADRANT = 4.0, 64


@dataclass(frozen=True, slots=True)
class Glider:
    """An aircraft as the energy of a search sees it: level, at one airspeed in still air.

    Parameters
    ----------
    max_load_factor
        n of its tightest turn.
    energy_j
        Stored, what is kept already taken off.
    """

    power: PowerModel
    airspeed_m_s: float
    max_load_factor: float
    energy_j: float

    @staticmethod
    def load_of(airspeed_m_s: float, radius_m: float) -> float:
        """n of a level turn of a radius."""
        return math.hypot(1.0, airspeed_m_s**2 / (STANDARD_GRAVITY_M_S2 * radius_m))

    @property
    def max_turn_rad_s(self) -> float:
        """ψ̇ of the tightest turn, g √(n² − 1) / V."""
        return STANDARD_GRAVITY_M_S2 * math.sqrt(self.max_load_factor**2 - 1.0) / self.airspeed_m_s

    @property
    def radius_m(self) -> float:
        """Of the tightest turn."""
        return self.airspeed_m_s / self.max_turn_rad_s

    def power_w(self, turn_rad_s: float) -> float:
        """From the battery in a turn."""
        load = math.hypot(1.0, self.airspeed_m_s * turn_rad_s / STANDARD_GRAVITY_M_S2)
        return self.power.power_w(FlightState(self.airspeed_m_s, load_factor=load))

    def energy_of_j(self, straight_m: float, turned_m: float) -> float:
        """For so much of straights, and of tightest turns."""
        straight_w, turning_w = self.power_w(0.0), self.power_w(self.max_turn_rad_s)
        return (straight_m * straight_w + turned_m * turning_w) / self.airspeed_m_s

    @property
    def straight_m(self) -> float:
        """How far it flies straight on all its energy."""
        return self.energy_j / self.power_w(0.0) * self.airspeed_m_s


@dataclass(frozen=True, slots=True, eq=False)
class DiscSearch:
    """Ground to be seen with a disc from a place to another.

    Parameters
    ----------
    reach_m
        Radius of the disc.
    """

    ground: Polygon | MultiPolygon
    worth: Worth
    reach_m: float
    start: Place
    end: Place
    glider: Glider

    def line(self, waypoints: Floats, chord_m: float = CHORD_M) -> tuple[Floats, float]:
        """The line through waypoints between start and end, and its energy; inf where none is flyable."""
        points, straight_m, turned_m = rounded(self._whole(waypoints), self.glider.radius_m, chord_m)
        if not math.isfinite(straight_m):
            return points, math.inf
        return points, self.glider.energy_of_j(straight_m, turned_m)

    def seen(self, points: Floats) -> float:
        """Worth of what is seen along a line, by cells."""
        worth = self.worth
        total = disc_worth(points, self.reach_m, worth.scores, worth.west_m, worth.south_m, worth.cell_m)
        return float(total) * worth.cell_m**2

    def seen_m2(self, points: Floats) -> float:
        """Ground seen along a line, as polygons."""
        return float(swept(points, self.reach_m).intersection(self.ground).area)

    def _whole(self, waypoints: Floats) -> Floats:
        return np.vstack([self.start, waypoints, self.end])


def swept(points: Floats, reach_m: float) -> BaseGeometry:
    """What a disc sees along a line; its circles are drawn inside themselves."""
    shape: BaseGeometry = shapely.buffer(LineString(points), reach_m, quad_segs=QUADRANT)
    return shape
