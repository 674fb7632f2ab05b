"""Stacks of short sweeps laid anew across, where that costs less: narrow ground is swept along, not across.

A layout at one heading crosses a street that runs the other way in as many short sweeps as it is long. What
only short sweeps see falls into pieces; each is seen by sweeps at the heading across where those cost less.
"""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.area import UrbanArea
from planner.coverage.urban.frontier import Frontier, Laid, Manner
from planner.coverage.urban.layout import Layout, each_m
from planner.coverage.urban.visibility import edges_of

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Sweeps that see less than this are laid anew, in widths of the footprint: one length after the other.
SHORT = (4.0, 8.0)
#: How sweeps across are laid.
MANNERS = (Manner(None, 0.0, 0.5), Manner(None, 2.0, 0.25))
#: Less of a piece is nothing; strips that share no more than this of their edge are apart.
LEAST_M2, APART_M = 1e-2, 1e-3


def relaid(layout: Layout, urban: UrbanArea, ground: BaseGeometry, edges: Floats) -> Layout:
    """A layout at one heading that costs no more, with pieces at the heading across where those cost less."""
    (base,) = layout.laid
    more: list[Laid] = []
    saved_m = 0.0
    for short in SHORT:
        want = _seen_alone(base, short * urban.width_m, urban, ground)
        if not want[1]:
            continue
        angle_rad = (base.angle_rad + math.pi / 2.0) % math.pi
        frontier = Frontier.of(
            edges, angle_rad, False, urban.width_m, edges_of(shapely.MultiPolygon(want[1]))
        )
        laid = [frontier.laid(urban.width_m, urban.length_m, manner) for manner in MANNERS]
        ways = [_chosen(base, *want, across, urban) for across in laid]
        gain_m, kept, across = max(ways, key=lambda way: way[0])
        if gain_m > 0.0:
            saved_m += gain_m
            base = base.only(kept)
            more.append(across)
    return Layout((base, *more), layout.cost_m - saved_m)


def _seen_alone(
    base: Laid, short_m: float, urban: UrbanArea, ground: BaseGeometry
) -> tuple[NDArray[np.bool_], list[Polygon]]:
    """Which sweeps are short, and the pieces of ground that these alone see."""
    short = base.lengths_m + urban.length_m < short_m
    if not short.any():
        return short, []
    shapes = base.strips(urban.width_m, urban.length_m)
    want = shapely.intersection(shapely.disjoint_subset_union_all(shapes[short]), ground)
    shapely.prepare(want)
    others = shapes[~short & shapely.intersects(want, _inner(base, urban))]
    left = shapely.difference(want, shapely.disjoint_subset_union_all(others)) if len(others) else want
    return short, [p for p in shapely.get_parts(left) if isinstance(p, Polygon) and p.area > LEAST_M2]


def _chosen(
    base: Laid, short: NDArray[np.bool_], pieces: list[Polygon], across: Laid, urban: UrbanArea
) -> tuple[float, NDArray[np.bool_], Laid]:
    """What sweeps across save over pieces where they do, which of the others stay, and those sweeps."""
    before, after = base.only(short), across
    tree = shapely.STRtree(pieces)
    rows = [_touched(tree, laid, urban) for laid in (before, after)]
    counts = (len(pieces), len(before.rows), len(after.rows))
    groups = _groups(counts, rows)
    costs_m = [laid.lengths_m + each_m(urban) for laid in (before, after)]
    gains_m = np.bincount(groups[1], costs_m[0], groups[3]) - np.bincount(groups[2], costs_m[1], groups[3])
    better = gains_m > 1e-6
    kept = np.ones(len(base.rows), dtype=np.bool_)
    kept[np.flatnonzero(short)[better[groups[1]]]] = False
    return float(gains_m[better].sum()), kept, after.only(better[groups[2]])


def _touched(tree: shapely.STRtree, laid: Laid, urban: UrbanArea) -> Ints:
    """Pairs of a sweep and a piece that it sees of, (2, M)."""
    found: Ints = tree.query(_inner(laid, urban), predicate="intersects")
    return found


def _inner(laid: Laid, urban: UrbanArea) -> NDArray[np.object_]:
    """Strips a little smaller, that do not touch what lies beside them."""
    return laid.strips(urban.width_m - 2.0 * APART_M, urban.length_m - 2.0 * APART_M)


def _groups(counts: tuple[int, int, int], rows: list[Ints]) -> tuple[Ints, Ints, Ints, int]:
    """Groups of pieces, sweeps before and sweeps after that hang together, and how many there are."""
    pieces, before, after = counts
    sweeps = np.concatenate([rows[0][0] + pieces, rows[1][0] + pieces + before])
    seen = np.concatenate([rows[0][1], rows[1][1]])
    total = pieces + before + after
    graph = coo_array((np.ones(len(seen)), (sweeps, seen)), shape=(total, total))
    count, labels = connected_components(graph, directed=False)
    group: Ints = np.asarray(labels, dtype=np.int64)
    return group[:pieces], group[pieces : pieces + before], group[pieces + before :], int(count)
