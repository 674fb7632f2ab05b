"""Chooses the flight model."""

from __future__ import annotations

from importlib.util import find_spec

from mavlink.sim.dynamics import Dynamics, Wind
from mavlink.sim.jsbsim_model import FASTEST_M_S, SLOWEST_M_S, JsbsimModel
from mavlink.sim.kinematic import KinematicModel
from mavlink.sim.settings import SimSettings


def chosen_dynamics(settings: SimSettings) -> str:
    """``jsbsim`` or ``kinematic``, as ``auto`` decides.

    ``auto`` is JSBSim where its package is installed and the airspeed is one its light aircraft flies (38 to
    60 m/s); below that, at the 20 m/s of a small UAV for instance, it is the kinematic model: JSBSim ships no
    powered aircraft of that size.
    """
    if settings.dynamics != "auto":
        return settings.dynamics
    suits = SLOWEST_M_S <= settings.airspeed_m_s <= FASTEST_M_S
    return "jsbsim" if suits and find_spec("jsbsim") is not None else "kinematic"


def build_dynamics(settings: SimSettings) -> Dynamics:
    """The flight model at rest at home."""
    wind = Wind(settings.wind_m_s, settings.wind_from_deg, settings.gust_m_s, settings.seed)
    ground_model = KinematicModel(
        settings.limits,
        settings.home,
        settings.heading_deg,
        wind=wind,
        ground_m=settings.home.altitude_m,
        cruise_power_w=settings.cruise_power_w,
        mass_kg=settings.mass_kg,
    )
    if chosen_dynamics(settings) == "kinematic":
        return ground_model
    return JsbsimModel(ground_model, settings.limits, wind, ground_m=settings.home.altitude_m)
