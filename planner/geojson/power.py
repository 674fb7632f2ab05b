"""A vehicle's member ``power``: which model its energy is reckoned by."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

from planner.geojson.fields import Fields, Findings
from planner.vehicle.energy import ConstantPower, DragPolar, PowerModel, PowerTable, Rotors

MODELS = ("constant", "drag_polar", "multirotor")
_EXAMPLES = {
    "constant": '{"model": "constant", "power_w": 180}',
    "drag_polar": '{"model": "drag_polar", "mass_kg": 9, "wing_area_m2": 1, "aspect_ratio": 8, "cd0": 0.03}',
    "multirotor": '{"model": "multirotor", "mass_kg": 1.4, "rotors": 4, "rotor_diameter_m": 0.24}',
}


def read_power(fields: Fields, findings: Findings, kind: str | None) -> PowerModel | None:
    """The model of one entry of ``vehicles``: its ``power``, or ``cruise_power_w`` for a constant one."""
    cruise_w = fields.number("cruise_power_w", None, above=0.0)
    raw: Any = fields.raw("power")
    if raw is None:
        return None if cruise_w is None else ConstantPower(cruise_w)
    if not isinstance(raw, Mapping):
        fields.wrong("power", "is not an object", f"Write {_EXAMPLES['constant']}.")
        return None
    if cruise_w is not None:
        fields.wrong("cruise_power_w", "is given beside power, which says it too", "Keep one of them.")
        return None
    own = Fields(f"power of {fields.owner}", raw, findings)
    model = own.choice("model", MODELS)
    found: PowerModel | None = None
    if model == "constant":
        power_w = own.number("power_w", above=0.0)
        found = None if power_w is None else ConstantPower(power_w)
    elif model == "drag_polar":
        found = _wing(own, fields, kind)
    elif model == "multirotor":
        found = _table(own) if "table" in own else _rotors(own)
        if kind == "fixed_wing":
            fields.wrong("power", "is that of a multirotor", f"Write {_EXAMPLES['drag_polar']}.")
    if model is not None:
        own.refuse_unknown()
    return found


def _wing(own: Fields, vehicle: Fields, kind: str | None) -> PowerModel | None:
    if kind == "multirotor":
        vehicle.wrong("power", "is that of a wing", f"Write {_EXAMPLES['multirotor']}.")
    mass_kg, area_m2 = own.number("mass_kg", above=0.0), own.number("wing_area_m2", above=0.0)
    aspect, cd0 = own.number("aspect_ratio", above=0.0), own.number("cd0", above=0.0, maximum=1.0)
    oswald = own.number("oswald", 0.8, above=0.0, maximum=1.0)
    efficiency = own.number("efficiency", 0.6, above=0.0, maximum=1.0)
    avionics_w = own.number("avionics_w", 0.0, minimum=0.0)
    hover_w = own.number("hover_w", None, above=0.0)
    if kind == "vtol" and hover_w is None:
        own.wrong("hover_w", "is missing: it takes off and lands on its rotors", "Add hover_w, in watts.")
        return None
    if kind == "fixed_wing" and hover_w is not None:
        own.unused("hover_w", "is for what hovers, and a fixed wing does not")
    if mass_kg is None or area_m2 is None or aspect is None or cd0 is None:
        return None
    if oswald is None or efficiency is None or avionics_w is None:
        return None
    return DragPolar(mass_kg, area_m2, aspect, cd0, oswald, efficiency, avionics_w, hover_w)


def _rotors(own: Fields) -> PowerModel | None:
    mass_kg = own.number("mass_kg", above=0.0)
    disc_m2 = own.number("disc_area_m2", None, above=0.0)
    if disc_m2 is None:
        count, wide_m = own.integer("rotors", 4, minimum=1), own.number("rotor_diameter_m", None, above=0.0)
        if wide_m is None:
            own.wrong(
                "rotor_diameter_m",
                "is missing, and so is disc_area_m2",
                "Add rotor_diameter_m and rotors, or disc_area_m2.",
                "missing-property",
            )
        else:
            disc_m2 = count * math.pi * wide_m**2 / 4.0
    merit = own.number("figure_of_merit", 0.65, above=0.0, maximum=1.0)
    efficiency = own.number("efficiency", 0.8, above=0.0, maximum=1.0)
    drag_m2 = own.number("drag_area_m2", 0.0, minimum=0.0)
    avionics_w = own.number("avionics_w", 0.0, minimum=0.0)
    if mass_kg is None or disc_m2 is None or merit is None or efficiency is None:
        return None
    return (
        None
        if drag_m2 is None or avionics_w is None
        else Rotors(mass_kg, disc_m2, merit, efficiency, drag_m2, avionics_w)
    )


def _table(own: Fields) -> PowerModel | None:
    raw: Any = own.raw("table")
    mass_kg = own.number("mass_kg", None, above=0.0)
    efficiency = own.number("efficiency", 0.6, above=0.0, maximum=1.0)
    if mass_kg is None and "efficiency" in own:
        own.unused("efficiency", "is that of climbs, which mass_kg is needed for")
    rows: list[tuple[float, float]] = []
    for row in raw if isinstance(raw, list) else []:
        if not (isinstance(row, list) and len(row) == 2 and all(_is_number(value) for value in row)):
            rows = []
            break
        rows.append((float(row[0]), float(row[1])))
    rising = all(a[0] < b[0] for a, b in pairwise(rows))
    if not rows or not rising or min(w for _, w in rows) <= 0.0 or rows[0][0] < 0.0:
        own.wrong(
            "table",
            "is no list of [airspeed in m/s, power in W] with rising airspeeds and positive powers",
            "Write [[0, 320], [8, 270], [15, 390]].",
        )
        return None
    return None if efficiency is None else PowerTable(tuple(rows), mass_kg, efficiency)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
