"""Airframes in use, by published figures: what an entry of ``vehicles`` that names its ``model`` begins with.

Multirotors: mass, rotors and their diameter, charge and voltage, and the hover or flight time that the maker
publishes. The last decides how much more than ideal power its rotors take (momentum theory), motors at 80 %;
drag, which no maker publishes, counts as ``DRAG_M2`` by the mass to 2/3. Wings: geometry and drag polar as
published; or, where the maker publishes a flight time alone, its mean power. An entry's own figures go before
those of its model.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from planner.named import named
from planner.vehicle.energy import SEA_LEVEL_DENSITY_KG_M3, STANDARD_GRAVITY_M_S2

#: Drag over dynamic pressure of a multirotor of a kilogram, and efficiency of its motors and controllers.
DRAG_M2, MOTORS = 0.012, 0.8


@dataclass(frozen=True, slots=True)
class Airframe:
    """One airframe.

    Parameters
    ----------
    name
        Maker and model.
    members
        As an entry of ``vehicles`` would give them.
    source
        Where its figures are published.
    """

    name: str
    members: Mapping[str, Any]
    source: str


def _rotors(
    name: str,
    mass_kg: float,
    rotors: int,
    diameter_m: float,
    energy_wh: float,
    minutes: float,
    airspeed_m_s: float,
    source: str,
) -> Airframe:
    """A multirotor whose battery lasts so long in a hover."""
    disc_m2 = rotors * math.pi * diameter_m**2 / 4.0
    ideal_w = (mass_kg * STANDARD_GRAVITY_M_S2) ** 1.5 / math.sqrt(2.0 * SEA_LEVEL_DENSITY_KG_M3 * disc_m2)
    merit = ideal_w / (energy_wh / minutes * 60.0) / MOTORS
    power = {
        "model": "multirotor",
        "mass_kg": mass_kg,
        "rotors": rotors,
        "rotor_diameter_m": diameter_m,
        "figure_of_merit": round(merit, 4),
        "efficiency": MOTORS,
        "drag_area_m2": round(DRAG_M2 * mass_kg ** (2.0 / 3.0), 5),
    }
    members = {
        "type": "multirotor",
        "airspeed_m_s": airspeed_m_s,
        "max_bank_deg": 25.0,
        "energy_wh": energy_wh,
        "power": power,
    }
    return Airframe(name, members, source)


def _wing(
    name: str,
    mass_kg: float,
    area_m2: float,
    span_m: float,
    cd0: float,
    oswald: float,
    airspeed_m_s: float,
    source: str,
) -> Airframe:
    """A wing whose drag polar is published, and its battery not."""
    power = {
        "model": "drag_polar",
        "mass_kg": mass_kg,
        "wing_area_m2": area_m2,
        "aspect_ratio": round(span_m**2 / area_m2, 4),
        "cd0": cd0,
        "oswald": oswald,
    }
    members = {"type": "fixed_wing", "airspeed_m_s": airspeed_m_s, "max_bank_deg": 35.0, "power": power}
    return Airframe(name, members, source)


_ALL = (
    _rotors("DJI Matrice 300 RTK", 6.3, 4, 0.533, 548.0, 55.0, 15.0,
            "DJI: Matrice 300 RTK: 2 TB60 of 274 Wh, 55 min, 2110 propellers"),
    _rotors("DJI Matrice 30", 3.77, 4, 0.406, 263.2, 36.0, 15.0,
            "DJI: Matrice 30 series: 2 TB30 of 131.6 Wh, 36 min of hover, 1671 propellers"),
    _rotors("DJI Matrice 600 Pro", 9.5, 6, 0.533, 599.4, 32.0, 12.0,
            "DJI: Matrice 600 Pro: 6 TB47S of 99.9 Wh, 32 min of hover, 2170R propellers"),
    _rotors("DJI Inspire 2", 3.44, 4, 0.381, 195.2, 27.0, 12.0,
            "DJI: Inspire 2: 2 TB50 of 97.58 Wh, 27 min, 1550T propellers"),
    _rotors("DJI Phantom 4 Pro", 1.388, 4, 0.239, 89.2, 30.0, 10.0,
            "DJI: Phantom 4 Pro: 89.2 Wh, 30 min, 9455S propellers"),
    _rotors("DJI Mavic 3 Enterprise", 0.915, 4, 0.239, 77.0, 38.0, 12.0,
            "DJI: Mavic 3 Enterprise: 77 Wh, 38 min of hover, 9453F propellers"),
    _rotors("DJI Mavic 2 Pro", 0.907, 4, 0.221, 59.29, 29.0, 10.0,
            "DJI: Mavic 2 Pro: 59.29 Wh, 29 min of hover, 8743 propellers"),
    Airframe("WingtraOne GEN II", {
        "type": "vtol", "airspeed_m_s": 16.0, "max_bank_deg": 30.0, "energy_wh": 198.0,
        "power": {"model": "constant", "power_w": 201.4},
    }, "Wingtra: WingtraOne GEN II: 2 batteries of 99 Wh, 59 min, 16 m/s; its mean power"),
    _wing("Skywalker X8", 3.364, 0.75, 2.1, 0.0197, 0.9, 18.0,
          "K. Gryte et al., Aerodynamic modeling of the Skywalker X8 (ICUAS 2018)"),
    _wing("Aerosonde", 13.5, 0.55, 2.8956, 0.0437, 0.9, 30.0,
          "R. W. Beard, T. W. McLain, Small Unmanned Aircraft (2012), appendix E.2"),
    _wing("Zagi", 1.56, 0.2589, 1.4224, 0.0254, 0.9, 15.0,
          "R. W. Beard, T. W. McLain, Small Unmanned Aircraft (2012), appendix E.1"),
)  # fmt: skip

AIRFRAMES = {airframe.name: airframe for airframe in _ALL}

#: Members that say the same in several ways: where an entry has one of them, those of its model do not count.
SAME = (
    ("min_turn_radius_m", "max_bank_deg", "max_load_factor"),
    ("energy_wh", "charge_mah", "voltage_v"),
    ("power", "cruise_power_w"),
)


def is_airframe(name: str) -> bool:
    """Whether an airframe is called so, case aside."""
    return name.casefold() in {each.casefold() for each in AIRFRAMES}


def find_airframe(name: str) -> Airframe:
    """An airframe by its name, case aside.

    Raises
    ------
    KeyError
        None is called so; its argument says which come near.
    """
    return named(AIRFRAMES, name, "airframe", "swathplan aircraft")


def completed(entry: Mapping[str, Any], airframe: Airframe) -> dict[str, Any]:
    """An entry of ``vehicles`` with what it leaves to its model."""
    own = {name: value for name, value in entry.items() if value is not None}
    said = {name for same in SAME if any(name in own for name in same) for name in same}
    left = {name: value for name, value in airframe.members.items() if name not in said}
    return {**left, **own}
