"""Ground that a search was begun on before: looks had, and what of the ground they leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import shapely
from shapely.geometry import MultiPolygon, Polygon

from planner.frames import LocalFrame
from planner.geojson import geometry as shapes
from planner.geojson.fields import Fields, Findings
from planner.geojson.outlines import few_cornered
from planner.wishes import Importance, Region, Seen

#: So many looks are read; more are no record of flights.
MOST_LOOKS = 2_000
#: A look longer ago is a slip of the pen.
MOST_AGO_S = 7 * 86_400.0
#: What is left of ground beside a look, narrower than twice this, is the rounding of coordinates.
ROUNDED_M = 0.25
EXAMPLE = (
    'Write {"type": "Feature", "geometry": {"type": "Polygon", …}, '
    '"properties": {"ago_s": [90, 60], "heading_deg": 45}}.'
)


def read_seen(search: Fields, frame: LocalFrame, findings: Findings) -> tuple[Seen, ...]:
    """``seen`` of the member ``search``: each entry an area, or a Feature of one that says when."""
    raw = search.raw("seen", [])
    if not isinstance(raw, list):
        search.wrong("seen", "is not a list", f"Give areas. {EXAMPLE}")
        return ()
    if len(raw) > MOST_LOOKS:
        search.wrong("seen", f"lists {len(raw)} looks", f"Give {MOST_LOOKS} at most.", rule="too-many")
        return ()
    found = (_look(f"look {k} of search.seen", entry, frame, findings) for k, entry in enumerate(raw))
    return tuple(look for look in found if look is not None)


def _look(owner: str, raw: Any, frame: LocalFrame, findings: Findings) -> Seen | None:
    told: Any = {}
    geometry = raw
    if isinstance(raw, dict) and raw.get("type") == "Feature":
        geometry, told = raw.get("geometry"), raw.get("properties") or {}
    if not isinstance(geometry, dict) or geometry.get("type") not in ("Polygon", "MultiPolygon"):
        findings.error(owner, "bad-geometry", "is no Polygon or MultiPolygon", EXAMPLE)
        return None
    if not isinstance(told, dict):
        findings.error(owner, "bad-value", "has properties that are no object", EXAMPLE)
        return None
    fields = Fields(owner, told, findings)
    ago_s = _ago_s(fields)
    heading_deg = fields.number("heading_deg", None, minimum=0.0, maximum=360.0)
    fields.refuse_unknown()
    area = few_cornered(owner, shapes.area(owner, geometry, frame, findings), findings)
    if area is None or ago_s is None:
        return None
    course_rad = None
    if heading_deg is not None:
        middle = area.representative_point()
        course_rad = frame.angle_rad(middle.x, middle.y, heading_deg)
    return Seen(area, -ago_s[0], -ago_s[1], course_rad)


def _ago_s(fields: Fields) -> tuple[float, float] | None:
    """When it was begun and ended, in seconds before the search's start; None after a finding."""
    raw = fields.raw("ago_s", [0.0, 0.0])
    numbers = isinstance(raw, list) and all(
        isinstance(one, (int, float)) and not isinstance(one, bool) for one in raw
    )
    if not numbers or len(raw) != 2 or not MOST_AGO_S >= raw[0] >= raw[1] >= 0.0:
        fields.wrong(
            "ago_s",
            f"is {raw!r}"[:80],
            f"Give two numbers of seconds before the search's start, the earlier first: from "
            f"{MOST_AGO_S:.0f} down to 0.",
        )
        return None
    return float(raw[0]), float(raw[1])


def unseen_of(regions: Sequence[Region], importance: Importance, findings: Findings) -> list[Region]:
    """Regions without what was seen, where a look finds all that is there and stays there."""
    if not importance.seen or importance.detection < 1.0 or importance.drift is not None:
        return list(regions)
    seen = shapely.union_all([look.area for look in importance.seen])
    left = []
    for region in regions:
        parts = shapely.get_parts(shapely.difference(region.area, seen)).tolist()
        kept = [p for p in parts if isinstance(p, Polygon) and not p.buffer(-ROUNDED_M).is_empty]
        if kept:
            area = kept[0] if len(kept) == 1 else MultiPolygon(kept)
            left.append(replace(region, area=area))
    if regions and not left:
        findings.error(
            "search",
            "nothing-left",
            "has seen all of its ground already (seen)",
            "Leave out of seen what is to be looked at again, or add ground.",
        )
    return left
