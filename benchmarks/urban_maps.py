"""Twenty pinned maps of areas with obstacles, after section 4 of Majeed and Lee 2019.

What the paper says of its maps: five sizes (table 1), three densities of obstacles placed at random on areas
of regular shape (4.1), five shapes (table 3), boxes of any width, length and height, flight between 25 and
150 m, D_safe 10 m, a footprint 20 m wide and 30 m long. It gives no count of obstacles. Its lengths over
area / 20 m say that half to two thirds of the area was swept; the densities here leave as much.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import shapely
from shapely.affinity import rotate
from shapely.geometry import Point, Polygon, box
from shapely.ops import nearest_points

from planner.coverage.urban.area import Building, UrbanArea
from planner.coverage.urban.free import enlarged, free_space

#: Section 4: F_w and F_l, h_min and h_max, D_safe, wing span.
WIDTH_M, LENGTH_M = 20.0, 30.0
MIN_HEIGHT_M, MAX_HEIGHT_M = 25.0, 150.0
CLEARANCE_M, SPAN_M = 10.0, 1.0

#: Part of the area that is traversable, by density.
DENSITIES = {"low": 0.74, "medium": 0.62, "high": 0.53}

#: Lowest and highest side of a box, and its height: the paper's own example is 80 x 99 x 252 m.
SIDES_M = (25.0, 110.0)
HEIGHTS_M = (5.0, 300.0)


@dataclass(frozen=True)
class UrbanMap:
    """One map.

    Parameters
    ----------
    name, shape, density
        What it is called and of what kind it is.
    urban
        The problem.
    paper_m
        Length that the paper's algorithm flew on its map of this kind; None where it has none.
    """

    name: str
    shape: str
    density: str
    urban: UrbanArea
    paper_m: float | None = None


def boxes(area: Polygon, density: str, seed: int, *, turned: bool = False) -> tuple[Building, ...]:
    """Boxes at random places until as much of an area is blocked as its density says."""
    rng = np.random.default_rng(seed)
    west, south, east, north = area.bounds
    inner = area.buffer(-SPAN_M / 2.0, join_style="mitre")
    target_m2 = DENSITIES[density] * area.area
    blocked = Polygon()
    found: list[Building] = []
    while inner.area - inner.intersection(blocked).area > target_m2:
        wide_m, deep_m = rng.uniform(*SIDES_M, 2)
        x, y = rng.uniform(west, east), rng.uniform(south, north)
        height_m = round(float(rng.uniform(*HEIGHTS_M)), 1)
        outline = box(x - wide_m / 2.0, y - deep_m / 2.0, x + wide_m / 2.0, y + deep_m / 2.0)
        if turned:
            outline = rotate(outline, float(rng.uniform(0.0, 90.0)), origin=(x, y))
        if not area.covers(Point(x, y)):
            continue
        found.append(Building(outline, height_m))
        if height_m + CLEARANCE_M > MIN_HEIGHT_M:
            blocked = shapely.union(blocked, enlarged(outline, CLEARANCE_M))
    return tuple(found)


def blocks(area: Polygon, seed: int, turn_deg: float) -> tuple[Building, ...]:
    """Streets at right angles with courtyards, L-shaped and plain buildings of unequal heights between."""
    rng = np.random.default_rng(seed)
    west, south, east, north = area.bounds
    found = []
    for x in np.arange(west + 60.0, east - 60.0, 150.0):
        for y in np.arange(south + 55.0, north - 55.0, 130.0):
            wide_m, deep_m = rng.uniform(45.0, 100.0), rng.uniform(40.0, 85.0)
            plain = box(x, y, x + wide_m, y + deep_m)
            kind = rng.integers(4)
            if kind == 0:
                plain = plain.difference(box(x + 0.4 * wide_m, y + 0.4 * deep_m, x + wide_m, y + deep_m))
            elif kind == 1:
                plain = plain.difference(plain.buffer(-12.0, join_style="mitre"))
            centre = (x + wide_m / 2.0, y + deep_m / 2.0)
            outline = rotate(plain, turn_deg + float(rng.normal(0.0, 3.0)), origin=centre)
            height_m = round(float(rng.choice([6.0, 9.0, 12.0, 18.0, 24.0, 36.0, 60.0, 180.0])), 1)
            found.append(Building(outline, height_m))
    return tuple(found)


def problem(area: Polygon, buildings: tuple[Building, ...]) -> UrbanArea:
    """The paper's aircraft over an area: from the free place nearest the south-west, and back."""
    west, south, _, _ = area.bounds
    corner = (west, south)
    urban = UrbanArea(
        area, buildings, WIDTH_M, LENGTH_M, MIN_HEIGHT_M, MAX_HEIGHT_M, CLEARANCE_M, corner, corner, SPAN_M
    )
    inner = area.buffer(-SPAN_M / 2.0, join_style="mitre")
    standing = [b.outline for b in buildings if not urban.passes_over(b)]
    blocked = shapely.union_all([enlarged(outline, CLEARANCE_M + SPAN_M) for outline in standing])
    pieces = shapely.get_parts(inner.difference(blocked))
    largest = max(pieces, key=lambda piece: piece.area)
    near, _ = nearest_points(largest, Point(corner))
    return replace(urban, start=(near.x, near.y), end=(near.x, near.y))


def maps() -> tuple[UrbanMap, ...]:
    """The twenty."""
    return tuple(named(name) for name in NAMES)


def named(name: str) -> UrbanMap:
    """One of them."""
    kind = _KINDS[name]
    buildings = kind.placed(kind.area)
    return UrbanMap(name, kind.shape, kind.density, problem(kind.area, buildings), kind.paper_m)


def traversable(urban: UrbanArea) -> float:
    """Part of the area that is free ground, reached or not."""
    free = free_space(urban)
    return float(free.ground.area + free.unreached_m2) / urban.area.area


def _convex() -> Polygon:
    return Polygon([(200, 0), (1150, 60), (1450, 620), (1180, 1270), (430, 1330), (0, 700)])


def _non_convex() -> Polygon:
    return Polygon(
        [(0, 0), (1500, 0), (1500, 1400), (1040, 1400), (1040, 620), (520, 620), (520, 1400), (0, 1400)]
    )


def _irregular() -> Polygon:
    rng = np.random.default_rng(10)
    angles = np.linspace(0.0, math.tau, 15, endpoint=False)
    radii_m = 700.0 * rng.uniform(0.72, 1.18, len(angles))
    return Polygon(np.column_stack([750.0 + radii_m * np.cos(angles), 750.0 + radii_m * np.sin(angles)]))


@dataclass(frozen=True)
class _Kind:
    shape: str
    density: str
    area: Polygon
    placed: Callable[[Polygon], tuple[Building, ...]]
    paper_m: float | None = None


def _random(
    shape: str, area: Polygon, density: str, seed: int, paper_m: float | None = None, *, turned: bool = False
) -> _Kind:
    placed = partial(boxes, density=density, seed=seed, turned=turned)
    return _Kind(shape, density, area, placed, paper_m)


def _kinds() -> dict[str, _Kind]:
    table = (
        (500.0, 600.0, "low", 8201.56),
        (1000.0, 1200.0, "low", 35417.67),
        (1200.0, 1400.0, "medium", 53120.09),
        (1500.0, 1500.0, "high", 71030.42),
        (2000.0, 2000.0, "high", 122367.15),
    )
    shapes = (
        ("square", box(0.0, 0.0, 1500.0, 1500.0), 68730.42),
        ("rectangle", box(0.0, 0.0, 600.0, 500.0), 8001.96),
        ("convex", _convex(), 50300.32),
        ("non-convex", _non_convex(), 54605.21),
        ("irregular", _irregular(), 47410.89),
    )
    wide, square = box(0.0, 0.0, 1200.0, 1000.0), box(0.0, 0.0, 1000.0, 1000.0)
    found = {
        f"table-{k}": _random("rectangle", box(0.0, 0.0, wide_m, deep_m), density, k, paper_m)
        for k, (wide_m, deep_m, density, paper_m) in enumerate(table, 1)
    }
    for k, (shape, area, paper_m) in enumerate(shapes, 11):
        found[f"shape-{shape}"] = _random(shape, area, "medium", k, paper_m)
    for k, density in enumerate(DENSITIES):
        found[f"boxes-{density}"] = _random("rectangle", wide, density, 21 + k)
        found[f"turned-{density}"] = _random("square", square, density, 31 + k, turned=True)
    for k, (shape, area) in enumerate((("non-convex", _non_convex()), ("irregular", _irregular())), 41):
        found[f"turned-{shape}"] = _random(shape, area, "high", k, turned=True)
    for seed, turn_deg in ((51, 0.0), (52, 17.0)):
        area = rotate(box(0.0, 0.0, 1050.0, 900.0), turn_deg)
        placed = partial(blocks, seed=seed, turn_deg=turn_deg)
        found[f"blocks-{turn_deg:.0f}"] = _Kind("rectangle", "blocks", area, placed)
    return found


_KINDS = _kinds()
NAMES = tuple(_KINDS)
