"""Outlines of more corners than planning can bear, with fewer: on the side on which nothing is lost.

What is computed of a polygon grows with the square of its corners. A circle drawn with a hundred thousand
says no more than one with a few hundred; a comb with thousands of teeth is another thing, and is refused by
name where it is to be seen or stayed in, and forbidden as a whole where it forbids.
"""

from __future__ import annotations

import shapely
from shapely.geometry import MultiPolygon, Polygon

from planner.geojson.fields import Findings
from planner.geojson.geometry import areal

#: Outlines up to this many corners are left alone.
MANY = 2_000
#: More are not planned with.
MOST = 4_000
#: How far from its edge an outline may be: of what is to be seen or stayed in, and of what forbids.
EXACT_M = (0.04,)
FORBIDDING_M = (0.04, 1.0, 10.0)
#: A mitred corner is so many times as far away as the edges are.
MITRE = 1.5
RULE, FIX = "outline-thinned", "Draw it with fewer corners."

Areal = Polygon | MultiPolygon


def few_cornered(
    owner: str, shape: Areal | None, findings: Findings, *, inward: bool = False, forbids: bool = False
) -> Areal | None:
    """The shape, or one with fewer corners round it (``inward``: in it, of one part) and a warning.

    None after a finding where that cannot be done; what ``forbids`` becomes its hull at worst.
    """
    if shape is None:
        return None
    corners = int(shapely.get_num_coordinates(shape))
    if corners <= MANY:
        return shape
    for by_m in FORBIDDING_M if forbids else EXACT_M:
        found = _thinned(shape, by_m, inward=inward)
        left = int(shapely.get_num_coordinates(found))
        if found.is_empty or left > MOST or (inward and not isinstance(found, Polygon)):
            continue
        if left < corners:
            away_m = by_m * MITRE
            said = (
                f"has {corners} corners: read as {left}, nowhere more than {away_m:g} m from the drawn edge"
            )
            findings.warning(owner, RULE, said, FIX)
        return found
    if forbids:
        said = f"has {corners} corners: more than {MOST} are not planned with, its hull is forbidden"
        findings.warning(owner, RULE, said, FIX)
        return areal(shape.convex_hull)
    findings.error(
        owner,
        "too-many-corners",
        f"has {corners} corners; {MOST} are planned with at most",
        "Simplify its outline, or cut it into several.",
    )
    return None


def _thinned(shape: Areal, by_m: float, *, inward: bool) -> Areal:
    """The edge straightened by less than it is moved to the safe side."""
    moved_m = 0.55 * by_m * (-1.0 if inward else 1.0)
    return areal(shape.simplify(0.5 * by_m).buffer(moved_m, join_style="mitre", mitre_limit=MITRE))
