"""A SAR from the properties of an entry of ``sensors``."""

from __future__ import annotations

import math
from typing import Any

from planner.route import Look
from planner.sensors.base import Properties
from planner.sensors.sar import SarSensor
from planner.sensors.sar_modes import scansar_resolution_m, turned_for_rad

SPEED_OF_LIGHT_M_S = 299_792_458.0

#: Beyond this the beam runs along the track rather than beside it.
MAX_SQUINT_DEG = 60.0
#: Beyond this there is nothing to call a pointing.
MAX_POINTING_DEG = 15.0
#: Margins that nobody asked for take no more than this part of the beam at either edge.
UNASKED_PART = 0.125
#: A spotlight pass turns no further than this round its place.
MAX_TURNED_DEG = 60.0
#: Two ways to say one thing may differ by this part.
SAME_PART = 0.01


def read_sar(fields: Properties) -> SarSensor | None:
    """The sensor; None after a finding."""
    name = fields.text("name")
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
    wavelength_m = _wavelength_m(fields, mode)
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
    if "pointing_margin_deg" not in fields:
        pointing_deg = min(pointing_deg, UNASKED_PART * elevation_deg)
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


def _wavelength_m(fields: Properties, mode: str | None) -> float | None:
    """λ, given, or from the frequency; found where nothing asks for it, or where the two differ."""
    wavelength_m = fields.number("wavelength_m", None, above=0.0)
    frequency_hz = fields.number("frequency_hz", None, above=0.0)
    for_aperture = "azimuth_beamwidth_deg" not in fields or "aperture_length_m" in fields
    if mode != "spotlight" and not for_aperture:
        for name in ("wavelength_m", "frequency_hz"):
            fields.unused(name, "is asked for by spotlight and aperture_length_m alone")
    if frequency_hz is None:
        return wavelength_m
    of_frequency_m = SPEED_OF_LIGHT_M_S / frequency_hz
    if wavelength_m is not None and abs(of_frequency_m - wavelength_m) > SAME_PART * wavelength_m:
        fields.wrong(
            "frequency_hz", f"is that of {of_frequency_m:.4g} m, not of wavelength_m", "Give one of the two."
        )
    return of_frequency_m if wavelength_m is None else wavelength_m


def _turned_rad(
    fields: Properties, wavelength_m: float | None, resolution_m: float | None, squint_rad: float
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


def _azimuth_beamwidth_rad(fields: Properties) -> float | None:
    """θ_A, given, or from the real aperture's length by θ_A = λ / D."""
    beamwidth_deg = fields.number("azimuth_beamwidth_deg", None, above=0.0, below=180.0)
    length_m = fields.number("aperture_length_m", None, above=0.0)
    wavelength_m = fields.number("wavelength_m", None, above=0.0)
    frequency_hz = fields.number("frequency_hz", None, above=0.0)
    if wavelength_m is None and frequency_hz is not None:
        wavelength_m = SPEED_OF_LIGHT_M_S / frequency_hz
    if beamwidth_deg is not None:
        beamwidth_rad = math.radians(beamwidth_deg)
        if length_m is not None and (
            wavelength_m is None or abs(wavelength_m / length_m - beamwidth_rad) > SAME_PART * beamwidth_rad
        ):
            fields.wrong(
                "aperture_length_m", "does not give azimuth_beamwidth_deg, λ / D", "Give one of the two."
            )
        return beamwidth_rad
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
