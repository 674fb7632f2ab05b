"""A camera from the properties of an entry of ``sensors``."""

from __future__ import annotations

import math
from typing import Any

from planner.sensors.base import Properties
from planner.sensors.camera import CameraSensor
from planner.sensors.cameras import Camera, find_camera
from planner.sensors.optics import Optics
from planner.sensors.quality import Giqe4, Spectrum

FORWARD_OVERLAP, SIDE_OVERLAP = 0.75, 0.65
#: The far edge of the image stays this far from the vertical at most: beyond it pixels cover no ground to
#: speak of.
MOST_FROM_VERTICAL_DEG = 80.0
#: Beyond this there is nothing to call a pointing.
MAX_POINTING_DEG = 15.0
#: More pixels than this are a slip of the pen.
MOST_PIXELS = 200_000
#: Photos larger than this are a slip of the unit.
LARGEST_PHOTO_MB = 5_000.0
#: Lenses and pixels beyond these are a slip of the unit: lengths are in metres.
LONGEST_M, LARGEST_PIXEL_M = 10.0, 1e-3


def read_camera(fields: Properties) -> CameraSensor | None:
    """The camera; None after a finding."""
    name = fields.text("name")
    known, optics = _optics(fields)
    forward = fields.number("forward_overlap", FORWARD_OVERLAP, minimum=0.0, below=1.0)
    side = fields.number("side_overlap", SIDE_OVERLAP, minimum=0.0, below=1.0)
    tilt_deg = fields.number("tilt_deg", 0.0, minimum=-90.0, maximum=90.0)
    usual_s = 0.0 if known is None else known.min_interval_s
    interval_s = fields.number("min_interval_s", usual_s, minimum=0.0)
    trigger: Any = fields.choice("trigger", ("distance", "time", "video"), "distance")
    usual: Spectrum = "visible" if known is None else known.spectrum
    spectrum: Any = fields.choice("spectrum", ("visible", "infrared"), usual)
    pointing_deg = fields.number("pointing_margin_deg", 0.0, minimum=0.0, maximum=MAX_POINTING_DEG)
    position_m = fields.number("position_margin_m", 0.0, minimum=0.0)
    stabilised = fields.flag("stabilised", False)
    edge_overlap = fields.flag("edge_overlap", True)
    photo_mb = fields.number("photo_mb", None, above=0.0, maximum=LARGEST_PHOTO_MB)
    quality, sound = _quality(fields, spectrum)
    if name is None or optics is None or forward is None or side is None or tilt_deg is None or not sound:
        return None
    if (
        interval_s is None
        or trigger is None
        or spectrum is None
        or pointing_deg is None
        or position_m is None
    ):
        return None
    most_deg = MOST_FROM_VERTICAL_DEG - math.degrees(optics.half_height_rad)
    if abs(tilt_deg) > most_deg:
        fields.wrong(
            "tilt_deg",
            f"is {tilt_deg:g}: half an image of {math.degrees(optics.half_height_rad):.1f}° on, the edge is "
            f"more than {MOST_FROM_VERTICAL_DEG:g}° from straight down, near the horizon or over it",
            f"Give {math.floor(most_deg * 10.0) / 10.0:g} at most.",
            rule="horizon",
        )
        return None
    if trigger == "video":
        fields.unused("min_interval_s", "is that of single photos; a video has none")
    return CameraSensor(
        name, optics, forward, side, math.radians(tilt_deg), interval_s, trigger, spectrum, quality,
        None if known is None else known.name,
        pointing_margin_rad=math.radians(pointing_deg), position_margin_m=position_m,
        steady_overlap="pointing_margin_deg" in fields or "position_margin_m" in fields,
        edge_overlap=edge_overlap, stabilised=stabilised, photo_mb=photo_mb,
    )  # fmt: skip


def _optics(fields: Properties) -> tuple[Camera | None, Optics | None]:
    """What the database knows of the model, and lens and chip."""
    model = fields.text("model", None)
    focal_m = fields.number("focal_length_m", None, above=0.0, maximum=LONGEST_M)
    pitch_m = fields.number("pixel_pitch_m", None, above=0.0, maximum=LARGEST_PIXEL_M)
    image = _image(fields)
    figures = ("focal_length_m", "pixel_pitch_m", "image_px")
    given = [name for name in figures if name in fields]
    if model is not None:
        try:
            known = find_camera(model)
        except KeyError as error:
            fields.wrong("model", f"is unknown: {error.args[0]}", "Name one of them, or give its figures.")
            return None, None
        if given:
            fields.wrong(
                given[0],
                f"goes with no model: that of {known.name} is known",
                f"Leave {' and '.join(given)} out, or model.",
            )
            return known, None
        return known, known.optics
    for name in figures:
        if name not in fields:
            fields.wrong(
                name,
                "is missing",
                f"Add model, a name of the camera database, or {', '.join(figures)}.",
                rule="missing-property",
            )
    if focal_m is None or pitch_m is None or image is None:
        return None, None
    return None, Optics(focal_m, pitch_m, *image)


def _image(fields: Properties) -> tuple[int, int] | None:
    """Pixels across and along the flight direction."""
    value = fields.raw("image_px")
    if value is None:
        return None
    whole = isinstance(value, list) and all(
        isinstance(each, (int, float)) and not isinstance(each, bool)
        and 1 <= each <= MOST_PIXELS and each == int(each)
        for each in value
    )  # fmt: skip
    if not whole or len(value) != 2:
        fields.wrong(
            "image_px",
            f"must be two whole numbers of pixels up to {MOST_PIXELS}",
            "Write [across, along] the flight direction, e.g. [6000, 4000].",
        )
        return None
    return int(value[0]), int(value[1])


def _quality(fields: Properties, spectrum: Spectrum | None) -> tuple[Giqe4 | None, bool]:
    """The terms of GIQE 4, None without; and whether nothing is wrong with them."""
    rer = fields.number("rer", None, above=0.0, maximum=2.0)
    snr = fields.number("snr", None, above=0.0, maximum=1e6)
    gain = fields.number("noise_gain", 1.0, minimum=0.0, maximum=1e3)
    overshoot = fields.number("overshoot", 0.0, minimum=0.0, maximum=10.0)
    if "rer" not in fields and "snr" not in fields:
        for name in ("noise_gain", "overshoot"):
            fields.unused(name, "goes with rer and snr, which are missing")
        return None, gain is not None and overshoot is not None
    for name, other in (("rer", "snr"), ("snr", "rer")):
        if name not in fields:
            fields.wrong(
                name, f"is missing beside {other}", f"Give both, or leave {other} out.", "missing-property"
            )
    if rer is None or snr is None or gain is None or overshoot is None or spectrum is None:
        return None, False
    return Giqe4(spectrum, rer, snr, gain, overshoot), True
