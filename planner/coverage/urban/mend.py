"""What sweeps laid in columns really see, with more of them where slanted walls leave something unseen."""

from __future__ import annotations

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.frontier import Frontier, Laid, Manner, turned
from planner.coverage.urban.layout import Layout, each_m
from planner.coverage.urban.visibility import edges_of

Floats = NDArray[np.float64]

#: Sweeps are laid over what is left unseen so often, then it is looked at piece by piece; less is nothing.
LAID_MENDINGS, MOST_MENDINGS, LEAST_M2 = 3, 12, 1e-3
#: Lines this far outside of the ground run along its edge.
EDGE_M = 1e-5
#: Overlays snap to this grid.
GRID_M = 1e-6


def mended(layout: Layout, urban: UrbanArea, ground: BaseGeometry, edges: Floats) -> Layout:
    """A layout's lines where they can be flown, and more for what those leave unseen."""
    grown = edges_of(ground.buffer(EDGE_M, join_style="mitre"))
    across_m, along_m = urban.width_m, urban.length_m
    angle_rad = layout.laid[0].angle_rad
    found = []
    missed: list[NDArray[np.object_]] = []
    for each in layout.laid:
        laid, lost = each.within(grown, across_m, along_m)
        found.append(laid)
        missed.append(lost)
    lost = np.concatenate(missed)
    if len(lost) == 0:
        return Layout(tuple(found), layout.cost_m)
    left = shapely.intersection(shapely.disjoint_subset_union_all(lost), ground)
    seen = np.concatenate([each.strips(across_m, along_m) for each in found])
    for tries in range(MOST_MENDINGS):
        parts = _left(left, seen)
        if not parts:
            break
        left = shapely.MultiPolygon(parts)
        if tries < LAID_MENDINGS:
            frontier = Frontier.of(edges, angle_rad, False, across_m, edges_of(left))
            more = frontier.laid(across_m, along_m, Manner())
        else:
            places = np.array([part.representative_point().coords[0] for part in parts])
            there = turned(places, -angle_rad)
            more = Laid(angle_rad, there[:, [0, 0, 1]])
        laid, _ = more.within(grown, across_m, along_m)
        found.append(laid)
        seen = laid.strips(across_m, along_m)
    more_m = each_m(urban)
    cost_m = sum(float(laid.lengths_m.sum()) + more_m * len(laid.rows) for laid in found)
    return Layout(tuple(found), cost_m)


def _left(left: BaseGeometry, seen: NDArray[np.object_]) -> list[Polygon]:
    """What of ground is in no strip."""
    shapely.prepare(left)
    near = seen[shapely.intersects(left, seen)]
    rest = shapely.difference(left, shapely.disjoint_subset_union_all(near), grid_size=GRID_M)
    return [part for part in shapely.get_parts(rest) if isinstance(part, Polygon) and part.area > LEAST_M2]
