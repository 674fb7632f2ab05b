"""Power that an aircraft needs: constant, by its drag polar, or of rotors by momentum theory.

Sources: for wings C_D = C_D0 + k C_L² with C_L = n W / (q S) and k = 1 / (π e AR) (J. Anderson, "Aircraft
Performance and Design", 1999, ch. 2 and 5); for rotors the induced velocity of H. Glauert's momentum theory
(J. G. Leishman, "Principles of Helicopter Aerodynamics", 2006, ch. 2). Power from the battery is that of
flight by the efficiency, and what the electronics take.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from planner.vehicle.atmosphere import density_ratio

STANDARD_GRAVITY_M_S2 = 9.80665
SEA_LEVEL_DENSITY_KG_M3 = 1.225
#: Rounds in which the induced velocity settles, halving.
HALVINGS = 60


@dataclass(frozen=True, slots=True)
class FlightState:
    """How an aircraft flies for a while.

    Parameters
    ----------
    airspeed_m_s
        Through the air, true; 0 for a hover.
    climb_m_s
        Upwards; falling where negative.
    load_factor
        Lift over weight; more than 1 in turns.
    above_sea_m
        Of the air's density.
    """

    airspeed_m_s: float
    climb_m_s: float = 0.0
    load_factor: float = 1.0
    above_sea_m: float = 0.0

    @property
    def density_kg_m3(self) -> float:
        """Of the air (ISO 2533)."""
        return SEA_LEVEL_DENSITY_KG_M3 * density_ratio(self.above_sea_m)


class PowerModel(Protocol):
    """Power from the battery in flight."""

    def power_w(self, state: FlightState) -> float:
        """What it takes to fly so."""


@dataclass(frozen=True, slots=True)
class ConstantPower:
    """The same however it flies."""

    cruise_w: float

    def power_w(self, state: FlightState) -> float:
        """What it takes to fly so."""
        return self.cruise_w


@dataclass(frozen=True, slots=True)
class DragPolar:
    """A wing.

    Parameters
    ----------
    mass_kg, wing_area_m2, aspect_ratio
        Of the aircraft.
    zero_lift_drag
        C_D0.
    oswald
        e of the induced drag.
    efficiency
        Of motor and propeller together.
    avionics_w
        What is taken besides.
    hover_w
        Of a VTOL on its rotors; None for one that does not hover.
    """

    mass_kg: float
    wing_area_m2: float
    aspect_ratio: float
    zero_lift_drag: float
    oswald: float = 0.8
    efficiency: float = 0.6
    avionics_w: float = 0.0
    hover_w: float | None = None

    @property
    def induced(self) -> float:
        """k of C_D = C_D0 + k C_L²."""
        return 1.0 / (math.pi * self.oswald * self.aspect_ratio)

    def drag_n(self, state: FlightState) -> float:
        """Drag, in newtons."""
        dynamic_pa = 0.5 * state.density_kg_m3 * state.airspeed_m_s**2
        weight_n = self.mass_kg * STANDARD_GRAVITY_M_S2
        lift = state.load_factor * weight_n / (dynamic_pa * self.wing_area_m2)
        return dynamic_pa * self.wing_area_m2 * (self.zero_lift_drag + self.induced * lift**2)

    def power_w(self, state: FlightState) -> float:
        """What it takes to fly so; in a descent no less than the electronics take: nothing is won back."""
        if state.airspeed_m_s <= 0.0:
            if self.hover_w is None:
                raise ValueError("a wing without hover_w does not hover")
            return self.hover_w + self.avionics_w
        weight_n = self.mass_kg * STANDARD_GRAVITY_M_S2
        flown_w = self.drag_n(state) * state.airspeed_m_s + weight_n * state.climb_m_s
        return max(flown_w, 0.0) / self.efficiency + self.avionics_w


@dataclass(frozen=True, slots=True)
class Rotors:
    """What flies on rotors alone.

    Parameters
    ----------
    mass_kg
        Of the aircraft.
    disc_area_m2
        That all rotors sweep together.
    figure_of_merit
        Of the rotors: ideal over real power.
    efficiency
        Of motors and controllers.
    drag_area_m2
        Drag of the airframe over dynamic pressure.
    avionics_w
        What is taken besides.
    """

    mass_kg: float
    disc_area_m2: float
    figure_of_merit: float = 0.65
    efficiency: float = 0.8
    drag_area_m2: float = 0.0
    avionics_w: float = 0.0

    def power_w(self, state: FlightState) -> float:
        """What it takes to fly so; a descent takes a hover's power: in its own wake a rotor saves none."""
        density = state.density_kg_m3
        drag_n = 0.5 * density * self.drag_area_m2 * state.airspeed_m_s**2
        lift_n = state.load_factor * self.mass_kg * STANDARD_GRAVITY_M_S2
        thrust_n, tilt_rad = math.hypot(lift_n, drag_n), math.atan2(drag_n, lift_n)
        beside_m_s = state.airspeed_m_s * math.cos(tilt_rad)
        through_m_s = state.airspeed_m_s * math.sin(tilt_rad) + max(state.climb_m_s, 0.0) * math.cos(tilt_rad)
        induced_m_s = _induced_m_s(thrust_n / (2.0 * density * self.disc_area_m2), beside_m_s, through_m_s)
        ideal_w = thrust_n * (through_m_s + induced_m_s)
        return ideal_w / (self.figure_of_merit * self.efficiency) + self.avionics_w


@dataclass(frozen=True, slots=True)
class PowerTable:
    """Measured power by airspeed, straight between its rows, the ends' beyond them.

    Parameters
    ----------
    rows
        Airspeed in m/s, rising, and power in W.
    mass_kg
        For the power of climbs, by ``efficiency``; None where they are left out.
    """

    rows: tuple[tuple[float, float], ...]
    mass_kg: float | None = None
    efficiency: float = 0.6

    def power_w(self, state: FlightState) -> float:
        """What it takes to fly so; what is climbed besides."""
        climb_w = 0.0
        if self.mass_kg is not None:
            weight_n = self.mass_kg * STANDARD_GRAVITY_M_S2
            climb_w = weight_n * max(state.climb_m_s, 0.0) / self.efficiency
        (first_m_s, level_w), *rest = self.rows
        for next_m_s, next_w in rest:
            if state.airspeed_m_s <= first_m_s:
                break
            if state.airspeed_m_s <= next_m_s:
                part = (state.airspeed_m_s - first_m_s) / (next_m_s - first_m_s)
                return level_w + part * (next_w - level_w) + climb_w
            first_m_s, level_w = next_m_s, next_w
        return level_w + climb_w


def _induced_m_s(hover_squared: float, beside_m_s: float, through_m_s: float) -> float:
    """The root of v √(V∥² + (V⊥ + v)²) = T / (2 ρ A), which rises with v."""
    low, high = 0.0, math.sqrt(hover_squared)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if middle * math.hypot(beside_m_s, through_m_s + middle) < hover_squared:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)
