"""One reader a role: a GeoJSON feature to a value of the scenario."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_args

import shapely
from shapely.geometry import LineString, MultiPolygon, Point, Polygon

from planner.airspace.values import NoFlyZone, Obstacle, Threat
from planner.frames import LocalFrame
from planner.geojson import geometry as shapes
from planner.geojson.fields import Fields, Findings, is_finite
from planner.geojson.forbidding import forbidding_areas
from planner.geojson.outlines import EXACT_M, MANY, few_cornered
from planner.route import Terminal
from planner.wishes import HIGHEST_M, Pattern, Region

#: A point target without a radius still has to be inside a footprint, as a disc this large.
POINT_TARGET_RADIUS_M = 1.0
#: Corners of a disc's polygon to a quarter.
DISC_QUADRANT = 32
#: Altitudes below this are a slip of the pen.
LOWEST_M = 1.0
#: Of a corridor: places are rounded to less.
LEAST_WIDTH_M = 0.001
#: Headings that a region may be limited to: each is looked at.
MOST_APPROACHES = 360
#: Where the scale of NIIRS ends.
HIGHEST_NIIRS = 9.0
#: More visits than this are a slip of the pen: each is a stop of the tour.
MOST_REVISITS = 50

#: A MultiLineString, and a MultiPolygon of all but regions, is one line or polygon cut at the antimeridian.
GEOMETRIES = {
    "roi": ("Polygon", "MultiPolygon", "LineString", "MultiLineString", "Point"),
    "threat": ("Point",),
    "no_fly": ("Polygon", "MultiPolygon", "Point"),
    "obstacle": ("Polygon", "MultiPolygon"),
    "area": ("Polygon", "MultiPolygon"),
    "start": ("Point",),
    "end": ("Point",),
    "base": ("Point",),
    "importance": ("Polygon", "MultiPolygon", "Point"),
}


@dataclass(frozen=True, slots=True)
class RawFeature:
    """A feature whose role and geometry type are known to go together."""

    name: str
    role: str
    geometry: Mapping[str, Any]
    fields: Fields


def name_of(index: int, feature: Any) -> str:
    """How findings name a feature: its id, else its name, else its role where there is but one of it."""
    if not isinstance(feature, dict):
        return f"features[{index}]"
    properties = feature.get("properties")
    name = feature.get("id")
    if name is None and isinstance(properties, dict):
        name = properties.get("name")
        if name is None and properties.get("role") in ("area", "start", "end"):
            name = properties["role"]
    return f"features[{index}]" if name is None or isinstance(name, (dict, list, bool)) else str(name)


def read_role(name: str, feature: Mapping[str, Any], findings: Findings) -> RawFeature | None:
    """Check the envelope of one feature: properties, role, geometry type."""
    if isinstance(feature.get("id"), (dict, list, bool)):
        # RFC 7946, 3.2.
        findings.error(
            name,
            "feature-id",
            f"has an id that is neither text nor number: {str(feature['id'])[:80]}",
            "Write text, or leave it out.",
        )
    properties = feature.get("properties")
    if not isinstance(properties, dict):
        findings.error(name, "no-properties", "has no properties", "Add properties with a role.")
        return None
    fields = Fields(name, properties, findings)
    fields.raw("name")
    role = fields.raw("role")
    if not isinstance(role, str) or role not in GEOMETRIES:
        findings.error(
            name,
            "unknown-role",
            f"has the role {role!r}" if role is not None else "has no role",
            f"Use one of: {', '.join(GEOMETRIES)}.",
        )
        return None
    doubt = fields.raw("role_in_doubt")
    if doubt is not None:
        findings.error(
            name,
            "role-in-doubt",
            f"has the role {role}, which is in doubt: {str(doubt)[:200]}",
            "Give it the role that it has, and take role_in_doubt away.",
        )
    geometry = feature.get("geometry")
    kind = geometry.get("type") if isinstance(geometry, dict) else None
    if not isinstance(geometry, dict) or kind not in GEOMETRIES[role]:
        fix = f"A feature of role {role} is a {' or '.join(GEOMETRIES[role])}."
        if role == "obstacle" and kind == "Point":
            fix += " A round place to keep out of is a Point of role no_fly with radius_m."
        findings.error(name, "wrong-geometry", f"has the geometry {kind!r}", fix)
        return None
    return RawFeature(name, role, geometry, fields)


def read_region(raw: RawFeature, frame: LocalFrame, findings: Findings) -> Region | None:
    """Role ``roi``."""
    fields = raw.fields
    kind = raw.geometry["type"]
    area: Polygon | MultiPolygon | None = None
    axis: LineString | None = None
    if kind in ("Polygon", "MultiPolygon"):
        area = shapes.area(raw.name, raw.geometry, frame, findings)
    elif kind in ("LineString", "MultiLineString"):
        width_m = fields.number("width_m", minimum=LEAST_WIDTH_M)
        axis = shapes.line(raw.name, raw.geometry, frame, findings)
        if axis is not None and shapely.get_num_coordinates(axis) > MANY:
            axis = LineString(axis.simplify(EXACT_M[0] / 2.0).coords)
        if axis is not None and width_m is not None:
            area = axis.buffer(width_m / 2.0, cap_style="flat")
    else:
        radius_m = fields.number("radius_m", 0.0, minimum=0.0)
        place = shapes.point(raw.name, raw.geometry, frame, findings)
        if place is not None and radius_m is not None:
            # Drawn round the disc: one in it would leave slivers of the target unseen.
            outer_m = max(radius_m, POINT_TARGET_RADIUS_M) / math.cos(math.pi / (4.0 * DISC_QUADRANT))
            area = Point(place).buffer(outer_m, quad_segs=DISC_QUADRANT)
    area = few_cornered(raw.name, area, findings)
    revisits = int(fields.integer("revisits", 1, minimum=1))
    if revisits > MOST_REVISITS:
        fields.wrong("revisits", f"is {revisits}", f"Give {MOST_REVISITS} at most.", rule="out-of-range")
        revisits = 1
    window_s = _window_s(fields)
    after_s = fields.number("revisit_after_s", 0.0, minimum=0.0)
    if revisits == 1 and after_s:
        fields.unused("revisit_after_s", "is the time between visits, and it is visited once")
        after_s = 0.0
    priority = fields.number("priority", 1.0, minimum=0.0)
    required = fields.flag("required", True)
    sensor = fields.text("sensor", None)
    min_resolution_m = fields.number("min_resolution_m", None, above=0.0)
    gsd_m = fields.number("gsd_m", None, above=0.0)
    min_niirs = fields.number("min_niirs", None, minimum=0.0, maximum=HIGHEST_NIIRS)
    altitude_m = fields.number("altitude_m", None, minimum=LOWEST_M, maximum=HIGHEST_M)
    headings = _headings(fields)
    pattern: Any = fields.choice("pattern", get_args(Pattern), "auto")
    fields.refuse_unknown()
    if area is None or priority is None:
        return None
    approach = None
    if headings is not None:
        centre = area.centroid
        approach = tuple(frame.angle_rad(centre.x, centre.y, heading) for heading in headings)
    return Region(
        raw.name, area, priority, required, sensor, min_resolution_m, approach, revisits, axis, altitude_m,
        gsd_m=gsd_m, min_niirs=min_niirs, pattern=pattern or "auto",
        time_window_s=window_s, revisit_after_s=after_s or 0.0,
    )  # fmt: skip


def _window_s(fields: Fields) -> tuple[float, float] | None:
    value = fields.raw("time_window_s")
    if value is None:
        return None
    if not isinstance(value, list) or len(value) != 2 or not all(is_finite(v) and v >= 0.0 for v in value):
        fields.wrong(
            "time_window_s", f"is {value!r}", "Give [earliest, latest], seconds after the mission's start."
        )
        return None
    first_s, last_s = float(value[0]), float(value[1])
    if last_s <= first_s:
        fields.wrong(
            "time_window_s",
            f"closes at {last_s:g} s, before it opens at {first_s:g} s"
            if last_s < first_s
            else f"opens and closes at {first_s:g} s",
            "Write the earliest time first, the latest behind it.",
            rule="window-empty",
        )
        return None
    return first_s, last_s


def _headings(fields: Fields) -> tuple[float, ...] | None:
    value = fields.raw("approach_deg")
    if value is None:
        return None
    if not isinstance(value, list) or not value or not all(is_finite(v) and 0.0 <= v <= 360.0 for v in value):
        fields.wrong(
            "approach_deg", f"is {repr(value)[:80]}", "Give a list of headings in degrees, 0 to 360."
        )
        return None
    if len(value) > MOST_APPROACHES:
        message = f"has {len(value)} headings, more than {MOST_APPROACHES}"
        fields.wrong("approach_deg", message, "Give fewer, or none for any.", rule="too-many-headings")
        return None
    return tuple(float(v) for v in value)


def read_threat(raw: RawFeature, frame: LocalFrame, findings: Findings) -> Threat | None:
    """Role ``threat``."""
    fields = raw.fields
    model = fields.choice("model", ("missile", "radar"))
    radius_m = fields.number("radius_m", above=0.0)
    intensity_m: float | None = 0.0
    if model == "radar":
        intensity_m = fields.number("intensity_m", above=0.0)
    elif model == "missile":
        fields.unused("intensity_m", "is that of a radar, this is a missile site")
    height_m = fields.number("height_m", math.inf, above=0.0)
    hard = fields.flag("hard", False)
    centre = shapes.point(raw.name, raw.geometry, frame, findings)
    fields.refuse_unknown(also_known=("intensity_m",))
    if model is None or radius_m is None or intensity_m is None or height_m is None or centre is None:
        return None
    kind: Any = model
    return Threat(raw.name, kind, centre, radius_m, intensity_m, height_m, hard)


def read_no_fly(raw: RawFeature, frame: LocalFrame, findings: Findings) -> tuple[NoFlyZone, ...]:
    """Role ``no_fly``: a zone for each of its parts."""
    fields = raw.fields
    floor_m = fields.number("floor_m", -math.inf)
    ceiling_m = fields.number("ceiling_m", math.inf)
    zones: tuple[NoFlyZone, ...] = ()
    if raw.geometry["type"] == "Point":
        radius_m = fields.number("radius_m", above=0.0)
        centre = shapes.point(raw.name, raw.geometry, frame, findings)
        if centre is not None and radius_m is not None:
            zones = (NoFlyZone(raw.name, None, centre, radius_m, floor_m or 0.0, ceiling_m or 0.0),)
    else:
        areas = forbidding_areas(raw.name, raw.geometry, frame, findings)
        zones = tuple(
            NoFlyZone(raw.name, area, None, None, floor_m or 0.0, ceiling_m or 0.0) for area in areas
        )
    fields.refuse_unknown()
    if floor_m is None or ceiling_m is None:
        return ()
    if floor_m >= ceiling_m:
        fields.wrong("floor_m", "is not below ceiling_m", "Swap them or leave one out.", rule="band-empty")
    return zones


def read_obstacle(raw: RawFeature, frame: LocalFrame, findings: Findings) -> tuple[Obstacle, ...]:
    """Role ``obstacle``: one for each of its parts."""
    height_m = raw.fields.number("height_m", above=0.0)
    base_m = raw.fields.number("base_m", 0.0)
    areas = forbidding_areas(raw.name, raw.geometry, frame, findings)
    raw.fields.refuse_unknown()
    if height_m is None or base_m is None:
        return ()
    return tuple(Obstacle(raw.name, area, height_m, base_m) for area in areas)


def read_area(raw: RawFeature, frame: LocalFrame, findings: Findings) -> Polygon | None:
    """Role ``area``."""
    drawn = shapes.polygon(raw.name, raw.geometry, frame, findings)
    area = few_cornered(raw.name, drawn, findings, inward=True)
    raw.fields.refuse_unknown()
    return area if isinstance(area, Polygon) else None


def read_terminal(raw: RawFeature, frame: LocalFrame, findings: Findings) -> Terminal | None:
    """Roles ``start``, ``end`` and ``base``."""
    heading_deg = raw.fields.number("heading_deg", None, minimum=0.0, maximum=360.0)
    place = shapes.point(raw.name, raw.geometry, frame, findings)
    raw.fields.refuse_unknown()
    if place is None:
        return None
    angle = None if heading_deg is None else frame.angle_rad(*place, heading_deg)
    return Terminal(raw.name, place, angle)
