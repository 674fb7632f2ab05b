"""Vehicles, sensors and the other foreign members of a scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from planner.airspace.values import Wind
from planner.angles import angle_from_heading
from planner.geojson.fields import Fields, Findings
from planner.route import Look
from planner.sensors.sar import SarSensor
from planner.sensors.sar_modes import scansar_resolution_m, turned_for_rad
from planner.vehicle.aircraft import (
    DEFAULT_RESERVE,
    Aircraft,
    turn_radius_from_bank_m,
    turn_radius_from_load_factor_m,
)
from planner.wishes import Method, Objective

SPEED_OF_LIGHT_M_S = 299_792_458.0

#: Beyond this the beam runs along the track rather than beside it.
MAX_SQUINT_DEG = 60.0
#: Beyond this there is nothing to call a pointing.
MAX_POINTING_DEG = 15.0
#: A spotlight pass turns no further than this round its place.
MAX_TURNED_DEG = 60.0
#: A multirotor without a stated turn limit rounds its corners with this bank.
MULTIROTOR_BANK_DEG = 25.0

METHODS = {
    "coverage": ("auto", "li2018"),
    "routing": ("auto", "joint", "li2018", "li2018-threat-aware"),
    "transit": ("auto", "ssas", "tangent"),
    "smoothing": ("auto", "fillet", "shortcut"),
    "search": ("auto",),
}


def read_aircraft(raw: Any, index: int, findings: Findings) -> Aircraft | None:
    """One entry of ``vehicles``."""
    if not isinstance(raw, dict):
        findings.error("scenario", "bad-value", f"vehicles[{index}] is not an object", "Give an object.")
        return None
    name = raw.get("name")
    fields = Fields(f"vehicle {name if name else index}", raw, findings)
    name = fields.text("name")
    kind: Any = fields.choice("type", ("fixed_wing", "multirotor", "vtol"), "fixed_wing")
    autopilot: Any = fields.choice("autopilot", ("ardupilot", "px4"), "ardupilot")
    airspeed_m_s = fields.number("airspeed_m_s", above=0.0, maximum=400.0)
    radius_m = _turn_radius_m(fields, airspeed_m_s, kind)
    max_climb_deg = fields.number("max_climb_deg", 8.0, above=0.0, below=90.0)
    energy_wh = fields.number("energy_wh", None, above=0.0)
    power_w = fields.number("cruise_power_w", None, above=0.0)
    reserve = fields.number("reserve", DEFAULT_RESERVE, minimum=0.0, below=1.0)
    range_m = fields.number("max_range_m", None, above=0.0)
    time_s = fields.number("max_flight_time_s", None, above=0.0)
    settle_m = fields.number("settle_m", 0.0, minimum=0.0)
    base = fields.text("base", None)
    if "reserve" in fields and energy_wh is None:
        fields.wrong("reserve", "is a part of energy_wh, which is missing", "Add energy_wh or remove it.")
    if energy_wh is not None and power_w is None:
        fields.wrong(
            "energy_wh",
            "has no power model",
            "Add cruise_power_w, or leave energy_wh out.",
            rule="no-power-model",
        )
    fields.refuse_unknown()
    if name is None or airspeed_m_s is None or radius_m is None or max_climb_deg is None or settle_m is None:
        return None
    if kind is None or autopilot is None or reserve is None:
        return None
    return Aircraft(
        name, kind, autopilot, airspeed_m_s, radius_m, max_climb_deg, energy_wh, power_w, range_m, time_s,
        settle_m, base, reserve=reserve,
    )  # fmt: skip


def _turn_radius_m(fields: Fields, airspeed_m_s: float | None, kind: str | None) -> float | None:
    """The widest of the turn radii that the given limits demand."""
    radius_m = fields.number("min_turn_radius_m", None, above=0.0)
    bank_deg = fields.number("max_bank_deg", None, above=0.0, below=85.0)
    load_factor = fields.number("max_load_factor", None, above=1.0)
    if airspeed_m_s is None:
        return None
    radii = [] if radius_m is None else [radius_m]
    if bank_deg is not None:
        radii.append(turn_radius_from_bank_m(airspeed_m_s, bank_deg))
    if load_factor is not None:
        radii.append(turn_radius_from_load_factor_m(airspeed_m_s, load_factor))
    if not radii and kind == "multirotor":
        radii.append(turn_radius_from_bank_m(airspeed_m_s, MULTIROTOR_BANK_DEG))
    if not radii:
        if not {"min_turn_radius_m", "max_bank_deg", "max_load_factor"} & set(_given(fields)):
            fields.wrong(
                "min_turn_radius_m",
                "is missing",
                "Add min_turn_radius_m, max_bank_deg or max_load_factor.",
                rule="missing-property",
            )
        return None
    return max(radii)


def _given(fields: Fields) -> list[str]:
    return [n for n in ("min_turn_radius_m", "max_bank_deg", "max_load_factor") if n in fields]


def read_sensor(raw: Any, index: int, findings: Findings) -> SarSensor | None:
    """One entry of ``sensors``."""
    if not isinstance(raw, dict):
        findings.error("scenario", "bad-value", f"sensors[{index}] is not an object", "Give an object.")
        return None
    name = raw.get("name")
    fields = Fields(f"sensor {name if name else index}", raw, findings)
    name = fields.text("name")
    kind = fields.choice("type", ("sar", "camera"))
    if kind == "camera":
        findings.error(
            fields.owner, "not-supported", "is a camera, which this version does not plan", "Use a SAR."
        )
        return None
    incidence_deg = fields.number("incidence_deg", above=0.0, below=90.0)
    elevation_deg = fields.number("elevation_beamwidth_deg", above=0.0, below=180.0)
    azimuth_rad = _azimuth_beamwidth_rad(fields)
    resolution_m = fields.number("resolution_m", None, above=0.0)
    look = fields.choice("look", ("left", "right", "both"), "right")
    squint_deg = fields.number("squint_deg", 0.0, minimum=-MAX_SQUINT_DEG, maximum=MAX_SQUINT_DEG)
    mode: Any = fields.choice("mode", ("stripmap", "spotlight", "scansar"), "stripmap")
    sub_swaths = fields.integer("sub_swaths", 3 if mode == "scansar" else 1, minimum=1)
    pointing_deg = fields.number("pointing_margin_deg", 0.0, minimum=0.0, maximum=MAX_POINTING_DEG)
    position_m = fields.number("position_margin_m", 0.0, minimum=0.0)
    stabilised = fields.flag("stabilised", False)
    wavelength_m = _wavelength_m(fields)
    fields.refuse_unknown(
        also_known=("azimuth_beamwidth_deg", "aperture_length_m", "wavelength_m", "frequency_hz")
    )
    if name is None or incidence_deg is None or elevation_deg is None or azimuth_rad is None or look is None:
        return None
    if squint_deg is None or mode is None or pointing_deg is None or position_m is None:
        return None
    if sub_swaths > 1 and mode != "scansar":
        fields.wrong("sub_swaths", "goes with mode scansar", "Leave sub_swaths out, or set mode to scansar.")
        return None
    # Sub-swaths lie side by side, each one elevation beam wide.
    elevation_deg *= sub_swaths
    if incidence_deg - elevation_deg / 2.0 < 0.0 or incidence_deg + elevation_deg / 2.0 >= 90.0:
        fields.wrong(
            "elevation_beamwidth_deg",
            f"is {elevation_deg:g} round an incidence of {incidence_deg:g}: the beam passes the nadir or the "
            "horizon, so the swath is not a positive width on one side",
            "Keep incidence_deg ± elevation_beamwidth_deg / 2 within 0 and 90.",
            rule="swath-not-positive",
        )
        return None
    if 2.0 * pointing_deg >= elevation_deg:
        fields.wrong(
            "pointing_margin_deg",
            f"is {pointing_deg:g} at either edge of a beam of {elevation_deg:g}: nothing is left",
            "Keep it below half the elevation beam.",
            rule="swath-not-positive",
        )
        return None
    looks: tuple[Look, ...] = (
        ("left", "right") if look == "both" else ("left",) if look == "left" else ("right",)
    )
    turned_rad = None
    if mode == "spotlight":
        turned_rad = _turned_rad(fields, wavelength_m, resolution_m, math.radians(squint_deg))
        if turned_rad is None:
            return None
    if mode == "scansar" and resolution_m is not None:
        resolution_m = scansar_resolution_m(resolution_m, sub_swaths)
    return SarSensor(
        name, math.radians(incidence_deg), math.radians(elevation_deg), azimuth_rad, looks, resolution_m,
        math.radians(squint_deg), mode, sub_swaths, turned_rad,
        pointing_margin_rad=math.radians(pointing_deg), position_margin_m=position_m, stabilised=stabilised,
    )  # fmt: skip


def _wavelength_m(fields: Fields) -> float | None:
    """λ, given, or from the frequency."""
    wavelength_m = fields.number("wavelength_m", None, above=0.0)
    frequency_hz = fields.number("frequency_hz", None, above=0.0)
    if wavelength_m is None and frequency_hz is not None:
        return SPEED_OF_LIGHT_M_S / frequency_hz
    return wavelength_m


def _turned_rad(
    fields: Fields, wavelength_m: float | None, resolution_m: float | None, squint_rad: float
) -> float | None:
    """The angle a spotlight pass turns round its place, for the resolution asked of the sensor."""
    if wavelength_m is None or resolution_m is None:
        fields.wrong(
            "mode",
            "spotlight needs resolution_m, which its passes are to give, and the wavelength",
            "Add resolution_m, and wavelength_m or frequency_hz.",
            rule="missing-property",
        )
        return None
    turned_rad = turned_for_rad(wavelength_m, resolution_m, squint_rad)
    if math.isnan(turned_rad) or turned_rad > math.radians(MAX_TURNED_DEG):
        fields.wrong(
            "resolution_m",
            f"of {resolution_m:g} m asks for a turn of more than {MAX_TURNED_DEG:g}° round the place",
            f"Give {wavelength_m / 2.0:.3g} m or more.",
            rule="out-of-range",
        )
        return None
    return turned_rad


def _azimuth_beamwidth_rad(fields: Fields) -> float | None:
    """θ_A, given, or from the real aperture's length by θ_A = λ / D."""
    beamwidth_deg = fields.number("azimuth_beamwidth_deg", None, above=0.0, below=180.0)
    length_m = fields.number("aperture_length_m", None, above=0.0)
    wavelength_m = fields.number("wavelength_m", None, above=0.0)
    if beamwidth_deg is not None:
        return math.radians(beamwidth_deg)
    if length_m is not None and wavelength_m is not None and wavelength_m < length_m * math.pi:
        return wavelength_m / length_m
    if "azimuth_beamwidth_deg" not in fields:
        fields.wrong(
            "azimuth_beamwidth_deg",
            "is missing",
            "Add azimuth_beamwidth_deg, or aperture_length_m with wavelength_m.",
            rule="missing-property",
        )
    return None


_WRITTEN = {
    "wind": '{"speed_m_s": 8, "from_deg": 270}',
    "objective": '{"missile": 2000}',
    "method": '{"routing": "auto"}',
}


def _object(name: str, raw: Any, findings: Findings) -> dict[str, Any]:
    """A member that has to be an object; another value is found, never ignored."""
    if isinstance(raw, dict):
        return raw
    findings.error("scenario", "bad-value", f"{name} is not an object", f"Write {name}: {_WRITTEN[name]}.")
    return {}


def read_wind(raw: Any, findings: Findings) -> Wind:
    """Member ``wind``."""
    if raw is None:
        return Wind()
    fields = Fields("wind", _object("wind", raw, findings), findings)
    speed_m_s = fields.number("speed_m_s", minimum=0.0, maximum=100.0) or 0.0
    from_deg = fields.number(
        "from_deg", 0.0 if not speed_m_s else fields.raw("from_deg"), minimum=0.0, maximum=360.0
    )
    fields.refuse_unknown()
    return Wind(speed_m_s, angle_from_heading((from_deg or 0.0) + 180.0))


def read_objective(raw: Any, findings: Findings) -> Objective:
    """Member ``objective``."""
    if raw is None:
        return Objective()
    fields = Fields("objective", _object("objective", raw, findings), findings)
    defaults = Objective()
    weights = {
        name: fields.number(name, getattr(defaults, name), minimum=0.0)
        for name in ("length", "missile", "radar", "energy", "turns")
    }
    fields.refuse_unknown()
    return Objective(**{name: getattr(defaults, name) if w is None else w for name, w in weights.items()})


def read_method(raw: Any, findings: Findings) -> Method:
    """Member ``method``."""
    if raw is None:
        return Method()
    fields = Fields("method", _object("method", raw, findings), findings)
    chosen = {stage: fields.choice(stage, names, "auto") or "auto" for stage, names in METHODS.items()}
    fields.refuse_unknown()
    return Method(**chosen)


def listed(document: Mapping[str, Any], name: str, findings: Findings) -> list[Any]:
    """A member that must be a non-empty list."""
    value = document.get(name)
    if not isinstance(value, list) or not value:
        findings.error("scenario", "missing-member", f"{name} is missing or empty", f"Add {name}: a list.")
        return []
    return value
