"""Numbers that a role takes: from the shape's own values, or from what the import was told."""

from __future__ import annotations

import math
from typing import Any

from app.imports.buildings import heights, tags_of
from app.imports.options import ImportOptions
from app.imports.shapes import Shape
from planner.errors import Finding

#: Numbers that a role takes from the file's own values.
_NUMBERS = {
    "roi": ("width_m", "radius_m", "priority", "min_resolution_m"),
    "threat": ("radius_m", "intensity_m", "height_m"),
    "no_fly": ("radius_m", "floor_m", "ceiling_m"),
    "obstacle": ("height_m", "base_m"),
    "importance": ("score",),
    "start": ("heading_deg",),
    "end": ("heading_deg",),
}
_NEEDS = {
    ("roi", "line"): "width_m",
    ("threat", "point"): "radius_m",
    ("no_fly", "point"): "radius_m",
    ("obstacle", "polygon"): "height_m",
    ("importance", "polygon"): "score",
}


def add_values(
    properties: dict[str, Any], name: str, role: str, shape: Shape, options: ImportOptions, notes: list[str]
) -> list[Finding]:
    """Put in what the role takes, from the file or the options; what is wrong or missing is found."""
    found: list[Finding] = []
    for key in _NUMBERS.get(role, ()):
        text = shape.properties.get(key, "")
        if text and text.lower() not in ("none", "null", "nan"):
            try:
                value = float(text)
            except ValueError:
                value = math.nan
            if not math.isfinite(value) and key in ("floor_m", "ceiling_m"):
                notes.append(f"{name}: {key} is {text[:40]!r}, so it is forbidden to that side at any height")
            elif not math.isfinite(value):
                found.append(Finding(name, "not-a-number", f"{key} is {text[:40]!r}", "write a number"))
            elif _takes(role, shape.kind, key):
                properties[key] = value
    if role == "obstacle":
        _add_heights(properties, shape)
    needed = _NEEDS.get((role, shape.kind))
    given = getattr(options, needed, None) if needed else None
    if needed and needed not in properties:
        if given is None:
            fix = f"give {needed} with the import, or as a value of the shape"
            found.append(
                Finding(name, f"{needed}-missing", f"is a {role} {shape.kind} without {needed}", fix)
            )
        else:
            properties[needed] = given
    if role == "threat":
        found += _add_model(properties, name, shape, notes)
    return found


def _add_heights(properties: dict[str, Any], shape: Shape) -> None:
    """Top and base by the tags of maps, where the contract's names do not give them."""
    height_m, base_m = heights(tags_of(shape.properties))
    if height_m is None or "height_m" in properties:
        return
    properties["height_m"] = height_m
    if base_m > 0.0:
        properties.setdefault("base_m", base_m)


def _takes(role: str, kind: str, key: str) -> bool:
    if key == "width_m":
        return kind == "line"
    if key == "radius_m":
        return kind == "point"
    return True


def _add_model(properties: dict[str, Any], name: str, shape: Shape, notes: list[str]) -> list[Finding]:
    model = shape.properties.get("model", "").strip().lower()
    if not model:
        words = " ".join((shape.name, *shape.folders)).lower()
        model = "radar" if "radar" in words and "intensity_m" in properties else "missile"
        notes.append(f"{name} is taken for a {model} threat")
    if model not in ("missile", "radar"):
        return [Finding(name, "bad-model", f"model is {model[:40]!r}", "write missile or radar")]
    properties["model"] = model
    if model == "radar" and "intensity_m" not in properties:
        message = "is a radar without intensity_m"
        return [Finding(name, "intensity_m-missing", message, "give it as a value of the shape")]
    return []
