"""What one aircraft can do in this wind: how tight it turns, how long a line takes and what energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.airspace.values import STILL_AIR, Wind
from planner.route import Line
from planner.vehicle.aircraft import Aircraft
from planner.vehicle.atmosphere import true_over_equivalent
from planner.vehicle.jerks import change_s
from planner.vehicle.manners import manners_of
from planner.vehicle.wind import (
    duration_s,
    ground_speed_m_s,
    held_speed_m_s,
    no_headway,
    still_air_costs,
    still_air_factor,
)

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class FlightModel:
    """One aircraft in a steady wind.

    Parameters
    ----------
    aircraft
        As it flies in this wind: see ``of``.
    wind
        Slower than its airspeed.
    """

    aircraft: Aircraft
    wind: Wind = STILL_AIR

    @classmethod
    def of(cls, aircraft: Aircraft, wind: Wind, lowest_amsl_m: float = 0.0) -> FlightModel:
        """The model of an aircraft in a wind.

        Parameters
        ----------
        lowest_amsl_m
            Where it flies lowest: in denser air than that at sea level wings are slower than their airspeed.

        Raises
        ------
        InfeasibleError
            ``"wind"``: it is not faster than the wind, so some courses cannot be flown.
        """
        slowest_m_s = aircraft.airspeed_m_s
        if not aircraft.hovers:
            slowest_m_s *= min(true_over_equivalent(lowest_amsl_m), 1.0)
        if 0.0 < wind.speed_m_s >= slowest_m_s:
            raise no_headway(aircraft.name, wind, slowest_m_s)
        return cls(aircraft.in_wind(wind.speed_m_s), wind)

    @property
    def name(self) -> str:
        """Of the aircraft."""
        return self.aircraft.name

    @property
    def airspeed_m_s(self) -> float:
        """Cruise airspeed."""
        return self.aircraft.airspeed_m_s

    @property
    def turn_radius_m(self) -> float:
        """Radius of planned arcs over the ground, whatever the direction."""
        return self.aircraft.planned_turn_radius_m

    @property
    def stop_s(self) -> float:
        """What stopping for a corner takes longer than flying on; 0 for what flies round its corners."""
        if not self.aircraft.turns_on_the_spot:
            return 0.0
        manners = manners_of(self.aircraft)
        return change_s(0.0, self.airspeed_m_s, manners.accel_m_s2, manners.jerk_m_s3)

    @property
    def stops_m(self) -> float:
        """Metres at cruise that the corners before and behind a pass cost; 0 for what flies round them."""
        return 2.0 * self.airspeed_m_s * self.stop_s

    @property
    def settle_m(self) -> float:
        """Straight flight wanted before each collect, over the ground."""
        return self.aircraft.settle_m

    @property
    def max_climb_deg(self) -> float:
        """Steepest climb or descent."""
        return self.aircraft.max_climb_deg

    @property
    def drift(self) -> float:
        """Speed of the wind by the airspeed, for an aircraft that crabs; 0 for what hovers."""
        if self.aircraft.hovers:
            return 0.0
        return self.wind.speed_m_s / self.aircraft.airspeed_m_s

    def ground_speed_m_s(self, course_rad: ArrayLike) -> Array:
        """Speed over the ground on the courses given."""
        if self.aircraft.hovers:
            return held_speed_m_s(course_rad, self.airspeed_m_s, self.wind, manners_of(self.aircraft).sharing)
        return ground_speed_m_s(course_rad, self.airspeed_m_s, self.wind)

    def duration_s(self, line: Line) -> float:
        """Time to fly a line."""
        return duration_s(line, self.airspeed_m_s, self.wind)

    def air_factor(self, course_rad: ArrayLike) -> Array:
        """Metres through the air for one over the ground, on the courses given."""
        return still_air_factor(course_rad, self.airspeed_m_s, self.wind)

    def air_costs_m(self, lengths_m: Array, begins: Array, ends: Array) -> Array:
        """Lengths of transits as metres through the air, about; see ``wind.still_air_costs``."""
        return still_air_costs(lengths_m, begins, ends, self.airspeed_m_s, self.wind)
