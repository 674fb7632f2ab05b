"""Shapes of a file as features of a scenario: each gets a role, its own name, and what the role needs."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from shapely.geometry import Polygon
from shapely.geometry.polygon import orient

from app.imports.errors import RegionFileError, file_error
from app.imports.shapes import MAX_POSITIONS, MAX_SHAPES, LonLat, Rings, Shape
from planner.errors import Finding
from planner.geojson.sheet import MOST_LONGITUDE_DEG, continued, wrapped_deg

ROLES = ("roi", "threat", "no_fly", "area", "obstacle", "start", "end", "base", "importance")
KINDS: dict[str, tuple[str, ...]] = {
    "roi": ("polygon", "line", "point"),
    "threat": ("point",),
    "no_fly": ("polygon", "point"),
    "obstacle": ("polygon",),
    "area": ("polygon",),
    "start": ("point",),
    "end": ("point",),
    "base": ("point",),
    "importance": ("polygon",),
}
#: What a folder, or a name, is called to mean a role; spaces for - and _, without a number behind.
_WORDS = {
    "roi": ("roi", "rois", "region", "regions", "region of interest", "regions of interest", "targets"),
    "threat": ("threat", "threats", "missile", "missiles", "radar", "radars", "sam"),
    "no_fly": ("no fly", "nofly", "no fly zone", "no fly zones", "nfz", "restricted", "prohibited"),
    "obstacle": ("obstacle", "obstacles", "building", "buildings"),
    "area": ("area", "operating area", "area of operations"),
    "start": ("start", "take off", "takeoff", "launch"),
    "end": ("end", "landing"),
    "base": ("base", "bases"),
    "importance": ("importance",),
}
ROLE_OF_WORD = {word: role for role, words in _WORDS.items() for word in words}
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
_LIMIT_FINDINGS = 20


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """What the file does not say.

    Parameters
    ----------
    role
        Role of the shapes that no folder, name or value gives one; None: polygons and lines are ``roi``,
        points are ``threat``.
    width_m
        Width of corridors.
    radius_m
        Radius of threats and no-fly circles.
    height_m
        Height of obstacles.
    crs
        Reference system of a shapefile, ``EPSG:32611``; None for the one its ``.prj`` names.
    """

    role: str | None = None
    width_m: float | None = None
    radius_m: float | None = None
    height_m: float | None = None
    crs: str | None = None


@dataclass(frozen=True, slots=True)
class Imported:
    """A FeatureCollection of scenario features, the format it came in, and what is worth knowing."""

    collection: dict[str, Any]
    format: str
    notes: tuple[str, ...]


def check_options(options: ImportOptions) -> None:
    """Refuse an unknown role and lengths that are none (rule ``bad-option``)."""
    if options.role is not None and options.role not in ROLES:
        raise file_error("bad-option", f"there is no role {options.role[:40]!r}", f"use {', '.join(ROLES)}")
    for name in ("width_m", "radius_m", "height_m"):
        value = getattr(options, name)
        if value is not None and not 0.0 < value < math.inf:
            raise file_error("bad-option", f"{name} is {value}", "give a positive number of metres")


def features(shapes: Iterable[Shape], options: ImportOptions, notes: list[str]) -> list[dict[str, Any]]:
    """The features, in the file's order.

    Raises
    ------
    RegionFileError
        With a finding for each shape that can take no part.
    """
    shapes = list(shapes)
    if not shapes:
        raise file_error("no-shapes", "the file holds no polygon, line or point", "draw some")
    if len(shapes) > MAX_SHAPES or sum(shape.positions for shape in shapes) > MAX_POSITIONS:
        raise file_error(
            "too-many-shapes",
            f"the file holds {len(shapes)} shapes with {sum(s.positions for s in shapes)} positions",
            f"keep to {MAX_SHAPES} shapes and {MAX_POSITIONS} positions",
        )
    found: list[dict[str, Any]] = []
    taken: set[str] = set()
    findings: list[Finding] = []
    for shape in shapes:
        role = _role(shape, options)
        shape = _closed_line(shape, role)
        pieces = [shape] if role == "roi" else _split(shape)
        for piece in pieces:
            name = _free_name(piece.name or role, taken, numbered=not piece.name)
            wrong = _judge(name, role, piece)
            properties: dict[str, Any] = {"role": role, "name": name}
            wrong += _add_values(properties, name, role, piece, options, notes)
            findings += wrong
            if not wrong:
                found.append(
                    {"type": "Feature", "id": name, "geometry": _geometry(piece), "properties": properties}
                )
    if findings:
        more = len(findings) - _LIMIT_FINDINGS
        detail = str(findings[0].feature) + ": " + findings[0].message
        if more > 0:
            findings = findings[:_LIMIT_FINDINGS]
            detail += f" (and {more} findings more than listed)"
        raise RegionFileError(detail, tuple(findings))
    return found


def _role(shape: Shape, options: ImportOptions) -> str:
    """The file's own role; else that of the name, of the folders from within; else the wish; else by kind."""
    own = shape.properties.get("role", "").strip().lower()
    if own in ROLES:
        return own
    for text in (shape.name, *reversed(shape.folders)):
        role = ROLE_OF_WORD.get(_word(text))
        if role is not None and shape.kind in KINDS[role]:
            return role
    if options.role is not None:
        return options.role
    return "threat" if shape.kind == "point" else "roi"


def _word(text: str) -> str:
    """``No-Fly_Zone 3: airport`` as ``no fly zone``."""
    head = text.split(":", 1)[0]
    plain = re.sub(r"[-_\s]+", " ", head).strip().lower()
    return re.sub(r" ?#?\d+$", "", plain)


def _closed_line(shape: Shape, role: str) -> Shape:
    """A line that comes back to its start, where the role wants a polygon."""
    if shape.kind != "line" or "line" in KINDS[role]:
        return shape
    line = shape.parts[0][0]
    if len(line) < 4 or line[0] != line[-1]:
        return shape
    return Shape("polygon", shape.parts, shape.name, shape.folders, shape.properties)


def _split(shape: Shape) -> list[Shape]:
    return [Shape(shape.kind, (part,), shape.name, shape.folders, shape.properties) for part in shape.parts]


def _free_name(name: str, taken: set[str], *, numbered: bool) -> str:
    candidate, count = (f"{name} 1" if numbered else name), 1
    while candidate in taken:
        count += 1
        candidate = f"{name} {count}"
    taken.add(candidate)
    return candidate


def _judge(name: str, role: str, shape: Shape) -> list[Finding]:
    found: list[Finding] = []
    if shape.kind not in KINDS[role]:
        message = f"is a {shape.kind}, which cannot be a {role}"
        fix = f"draw a {' or '.join(KINDS[role])}, or choose another role"
        found.append(Finding(name, "wrong-geometry", message, fix))
    for part in shape.parts:
        for positions in part:
            wrong = next((p for p in positions if not _on_earth(p)), None)
            if wrong is not None:
                lon, lat = wrong
                message = f"has longitude {lon:g}, latitude {lat:g}"
                swapped = abs(lat) <= 180.0 and abs(lon) <= 90.0
                fix = (
                    "the two seem to be swapped"
                    if swapped
                    else "give degrees, or the file's reference system"
                )
                found.append(Finding(name, "latitude-out-of-range", message, fix))
                return found
            if shape.kind == "polygon" and len(set(positions)) < 3:
                message = f"has a ring of {len(set(positions))} corners"
                found.append(Finding(name, "ring-too-short", message, "give three or more"))
            if shape.kind == "line" and len(set(positions)) < 2:
                found.append(Finding(name, "line-too-short", "has no length", "give two places"))
    return found


def _on_earth(place: LonLat) -> bool:
    return abs(place[0]) <= MOST_LONGITUDE_DEG and abs(place[1]) <= 90.0


def _add_values(
    properties: dict[str, Any], name: str, role: str, shape: Shape, options: ImportOptions, notes: list[str]
) -> list[Finding]:
    found: list[Finding] = []
    for key in _NUMBERS.get(role, ()):
        text = shape.properties.get(key, "")
        if text and text.lower() not in ("none", "null", "nan"):
            try:
                value = float(text)
            except ValueError:
                value = math.nan
            if not math.isfinite(value):
                found.append(Finding(name, "not-a-number", f"{key} is {text[:40]!r}", "write a number"))
            elif _takes(role, shape.kind, key):
                properties[key] = value
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


def _geometry(shape: Shape) -> dict[str, Any]:
    if shape.kind == "point":
        return {"type": "Point", "coordinates": _place(shape.parts[0][0][0])}
    if shape.kind == "line":
        return {"type": "LineString", "coordinates": [_place(place) for place in shape.parts[0][0]]}
    polygons = [_rings(part) for part in shape.parts]
    if len(polygons) == 1:
        return {"type": "Polygon", "coordinates": polygons[0]}
    return {"type": "MultiPolygon", "coordinates": polygons}


def _rings(part: Rings) -> list[list[list[float]]]:
    """Closed rings, the outer counter-clockwise and holes clockwise (RFC 7946)."""
    near_deg = part[0][0][0]
    polygon = orient(Polygon(continued(part[0], near_deg), [continued(ring, near_deg) for ring in part[1:]]))
    return [[_place((x, y)) for x, y in ring.coords] for ring in (polygon.exterior, *polygon.interiors)]


def _place(place: LonLat) -> list[float]:
    """Within ±180°; what crosses there jumps to the other side, as the scenario's reader takes it."""
    return [wrapped_deg(float(place[0])), float(place[1])]
