"""Energy of a flight: of each of its stretches, by how it is flown."""

from __future__ import annotations

import math

import numpy as np

from planner.profile.flight import Flight, Stretch
from planner.vehicle.atmosphere import true_over_equivalent
from planner.vehicle.energy import STANDARD_GRAVITY_M_S2, FlightState, PowerModel
from planner.vehicle.model import FlightModel

#: Places of a stretch at which it is asked how it is flown.
_LOOKS = (np.arange(8) + 0.5) / 8.0


def flight_wh(flight: Flight, model: FlightModel, datum_amsl_m: float) -> float | None:
    """Energy from the battery for a whole flight; None without a power model.

    Parameters
    ----------
    datum_amsl_m
        Height over mean sea level of the flight's datum.
    """
    power = model.aircraft.power
    if power is None:
        return None
    joules = math.fsum(
        (until_s - from_s) * _power_w(stretch, until_s - from_s, model, power, datum_amsl_m)
        for stretch, from_s, until_s in zip(
            flight.stretches, flight.starts_s, flight.starts_s[1:], strict=False
        )
    )
    return joules / 3600.0


def _power_w(
    stretch: Stretch, time_s: float, model: FlightModel, power: PowerModel, datum_amsl_m: float
) -> float:
    """Mean power of a stretch."""
    if time_s <= 0.0:
        return 0.0
    climb_m_s = (stretch.end_altitude_m - stretch.start_altitude_m) / time_s
    above_sea_m = datum_amsl_m + 0.5 * (stretch.start_altitude_m + stretch.end_altitude_m)
    if stretch.segment is None:
        return power.power_w(FlightState(0.0, climb_m_s, 1.0, above_sea_m))
    segment, wind = stretch.segment, model.wind
    turns = segment.kind != "straight"
    if not turns and not model.aircraft.hovers:
        level_m_s = model.airspeed_m_s * true_over_equivalent(above_sea_m)
        return power.power_w(FlightState(level_m_s, climb_m_s, 1.0, above_sea_m))
    courses_rad = segment.start.angle_rad + segment.turn_rad * (_LOOKS if turns else _LOOKS[:1])
    ground_m_s = np.full(len(courses_rad), segment.length_m / time_s)
    if not model.aircraft.hovers:
        ground_m_s = model.ground_speed_m_s(courses_rad)
    air = np.stack([np.cos(courses_rad), np.sin(courses_rad)]) * ground_m_s
    air -= wind.speed_m_s * np.array([[math.cos(wind.toward_rad)], [math.sin(wind.toward_rad)]])
    true_m_s = np.hypot(*air)
    if not model.aircraft.hovers:
        true_m_s = np.full(len(courses_rad), model.airspeed_m_s * true_over_equivalent(above_sea_m))
    aside_m_s2 = ground_m_s**2 / segment.radius_m if turns else np.zeros(len(courses_rad))
    loads = np.hypot(1.0, aside_m_s2 / STANDARD_GRAVITY_M_S2)
    # Of an arc as much time is flown on a course as it is flown slowly.
    shares = (1.0 / ground_m_s) / (1.0 / ground_m_s).sum()
    return float(
        sum(
            share * power.power_w(FlightState(float(v), climb_m_s, float(n), above_sea_m))
            for share, v, n in zip(shares, true_m_s, loads, strict=True)
        )
    )
