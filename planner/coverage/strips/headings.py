"""Headings worth trying for a region, all of them the shape's own: turning the region turns them with it.

A grid laid out from the edge across which the region is narrowest; the directions of all its edges, among
which are those of least width (a convex outline is narrowest along one of its edges) and those along which
lanes of parts end together; and where one lane more or less does: between two edges the width changes without
a jump, so that there is a heading at which a number of swaths just holds it.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage.strips.classify import ROUNDING_M, angles_around, hull_points, spans_at

Floats = NDArray[np.float64]

#: Swath at each of some headings; and lanes that each takes, not rounded up.
Swaths = Callable[[Floats], Floats]
Held = Callable[[Floats], Floats]

#: Headings closer than this are one.
SAME_RAD = 1e-7
#: Widths that differ by less than this part of them are equally narrow: the longer edge decides.
AS_NARROW = 1e-6
#: Regions so many times as long as wide have a long side.
LONG = 1.2
#: Steps in which the width is looked at between edges, and halvings that find a break of the lane count.
BREAK_STEP_RAD = math.radians(1.0)
HALVINGS = 40
#: Breaks between this many lanes and the fewest times this.
MOST_LANES_FACTOR = 1.5


def anchor_rad(area: Polygon) -> float:
    """Direction of the hull's edge across which the region is narrowest."""
    edges = _edges(hull_points(area))
    directions_rad = np.arctan2(edges[:, 1], edges[:, 0])
    across_m = spans_at(hull_points(area), directions_rad).across_m
    narrow = across_m <= across_m.min() * (1.0 + AS_NARROW)
    longest = int(np.argmax(np.where(narrow, np.hypot(*edges.T), 0.0)))
    return float(directions_rad[longest])


def first_visit_rad(area: Polygon) -> float:
    """The heading that the share of a region's first visit is centred on, of headings shared among visits.

    Along its long side; where it is about as wide, as a place is, towards the middle of the scenario, which
    is where the frame has its origin: the same whatever is north, and whatever hand all is drawn by.
    """
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(area))[:3]
    edges = np.diff(corners, axis=0)
    lengths_m = np.hypot(*edges.T)
    inward_m = -shapely.get_coordinates(area.centroid)[0]
    heading_m = inward_m
    if lengths_m.max() > LONG * lengths_m.min() or np.hypot(*inward_m) < lengths_m.max():
        longest_m = edges[int(np.argmax(lengths_m))]
        heading_m = longest_m if longest_m @ inward_m >= 0.0 else -longest_m
    return math.atan2(heading_m[1], heading_m[0])


def grid(area: Polygon, step_rad: float) -> Floats:
    """Angles all round in equal steps from the region's narrowest edge."""
    return np.mod(angles_around(step_rad) + anchor_rad(area), math.tau)


def telling(area: Polygon, swaths: Swaths) -> Floats:
    """Directions of edges, and where the number of lanes changes, over the whole circle, ascending."""
    points_m = hull_points(area)

    def held(angles_rad: Floats) -> Floats:
        """Swaths that hold the region, not rounded up."""
        swath_m = swaths(angles_rad)
        across_m = spans_at(points_m, angles_rad).across_m - ROUNDING_M / 2.0
        count = np.full(len(across_m), np.inf)
        np.divide(across_m, swath_m, out=count, where=swath_m > 0.0)
        return count

    return singled_out(area, held)


def singled_out(area: Polygon, held: Held) -> Floats:
    """The same where something else than a swath's width decides how many lanes there are."""
    edges = np.concatenate(
        [_edges(np.asarray(ring.coords)[:, :2]) for ring in (area.exterior, *area.interiors)]
    )
    along = edges[np.hypot(*edges.T) > ROUNDING_M]
    hull = _edges(hull_points(area))
    both = np.concatenate([along, hull])
    directions_rad = np.arctan2(both[:, 1], both[:, 0])
    directions_rad = np.concatenate([directions_rad, directions_rad + math.pi])
    return _distinct(np.concatenate([directions_rad, _breaks(area, held, directions_rad)]))


def _breaks(area: Polygon, held: Held, edges_rad: Floats) -> Floats:
    """Headings just on the side of fewer lanes of where the number of lanes that hold the region changes."""
    looked_rad = _distinct(np.concatenate([grid(area, BREAK_STEP_RAD), edges_rad]))
    after_rad = np.append(looked_rad[1:], looked_rad[0] + math.tau)
    here, there = held(looked_rad), held(after_rad)
    low, high = np.minimum(here, there), np.maximum(here, there)
    fewest = max(1, math.ceil(low.min()))
    counts = np.arange(fewest, math.ceil(MOST_LANES_FACTOR * fewest) + 1)
    row, column = np.nonzero((low[:, None] < counts) & (counts < high[:, None]))
    good_rad = np.where(here < there, looked_rad, after_rad)[row]
    bad_rad = np.where(here < there, after_rad, looked_rad)[row]
    for _ in range(HALVINGS):
        middle_rad = (good_rad + bad_rad) / 2.0
        fits = held(middle_rad) <= counts[column]
        good_rad, bad_rad = np.where(fits, middle_rad, good_rad), np.where(fits, bad_rad, middle_rad)
    return np.asarray(good_rad, dtype=np.float64)


def _edges(ring: Floats) -> Floats:
    return np.diff(ring, axis=0)


def _distinct(angles_rad: Floats) -> Floats:
    """The angles in [0, 2π), ascending, each once."""
    ordered = np.sort(np.mod(angles_rad, math.tau))
    apart = np.diff(ordered, prepend=ordered[-1] - math.tau) if len(ordered) > 1 else np.full(1, math.inf)
    return np.asarray(ordered[apart > SAME_RAD], dtype=np.float64)
