"""Builds the flight model that the settings name."""

from __future__ import annotations

from mavlink.sim.dynamics import Dynamics, Wind
from mavlink.sim.jsbsim_model import JsbsimModel
from mavlink.sim.kinematic import KinematicModel
from mavlink.sim.multirotor import MultirotorModel
from mavlink.sim.settings import SimSettings


def build_dynamics(settings: SimSettings) -> Dynamics:
    """The flight model at rest at home."""
    wind = Wind(settings.wind_m_s, settings.wind_from_deg, settings.gust_m_s, settings.seed)
    if settings.hovers:
        return MultirotorModel(
            settings.limits,
            settings.home,
            settings.heading_deg or 0.0,
            wind=wind,
            ground_m=settings.home.altitude_m,
            cruise_power_w=settings.cruise_power_w,
            mass_kg=settings.mass_kg,
        )
    kinematic = KinematicModel(
        settings.limits,
        settings.home,
        settings.heading_deg or 0.0,
        wind=wind,
        ground_m=settings.home.altitude_m,
        cruise_power_w=settings.cruise_power_w,
        mass_kg=settings.mass_kg,
    )
    if settings.flight_model == "kinematic":
        return kinematic
    return JsbsimModel(kinematic, settings.limits, wind, ground_m=settings.home.altitude_m)
