"""Regions for the tests: random ones, the paper's sensor, the sample scenarios."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from pathlib import Path

import shapely
from hypothesis import strategies as st
from shapely import affinity
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.coverage.merge import MergedRegion
from planner.geojson import read_scenario
from planner.route import Look
from planner.scenario import Scenario
from planner.sensors.sar import SarSensor

HEIGHT_M = 500.0
EXAMPLES = Path(__file__).parents[3] / "examples"


def paper_sensor(*looks: Look) -> SarSensor:
    """Table 1 of Li, Chen, Wang, Li (2018)."""
    return SarSensor("sar", math.radians(45.0), math.radians(30.0), math.radians(10.0), looks or ("right",))


def sample(number: int) -> Scenario:
    """One of the four cases of the paper."""
    return read_scenario(json.loads((EXAMPLES / f"sar-case-{number}.geojson").read_text()))


def as_merged(area: Polygon, approach_rad: tuple[float, ...] | None = None) -> MergedRegion:
    """A region that stands alone."""
    return MergedRegion(("R",), area, (area,), ("R",), None, approach_rad)


def box(width_m: float, depth_m: float, angle_rad: float = 0.0) -> Polygon:
    """A rectangle round (1000, −2000)."""
    flat = shapely.box(-width_m / 2, -depth_m / 2, width_m / 2, depth_m / 2)
    return affinity.translate(affinity.rotate(flat, angle_rad, use_radians=True), 1000.0, -2000.0)


def unseen_m2(area: BaseGeometry, footprints: Iterable[Polygon]) -> float:
    """Area that no footprint covers, overlaid on a grid of 1 µm.

    Without the grid GEOS 3.14 loses polygons whose edges agree but for the last digits.
    """
    seen = shapely.union_all(list(footprints), grid_size=1e-6)
    return float(shapely.difference(area, seen, grid_size=1e-6).area)


@st.composite
def polygons(draw: st.DrawFn, size_m: tuple[float, float] = (50.0, 550.0)) -> Polygon:
    """Simple polygons, star-shaped round their middle: convex and concave, at most ``size_m`` from it."""
    count = draw(st.integers(3, 12))
    scale_m = draw(st.floats(*size_m))
    radii = draw(st.lists(st.floats(0.15, 1.0), min_size=count, max_size=count))
    turn_rad = draw(st.floats(0.0, 2.0 * math.pi))
    stretch = draw(st.floats(0.2, 1.0))
    east_m, north_m = draw(st.tuples(st.floats(-5e3, 5e3), st.floats(-5e3, 5e3)))
    ring = [
        (
            scale_m * radius * math.cos(2.0 * math.pi * k / count),
            scale_m * radius * stretch * math.sin(2.0 * math.pi * k / count),
        )
        for k, radius in enumerate(radii)
    ]
    turned = affinity.rotate(Polygon(ring), turn_rad, origin=(0.0, 0.0), use_radians=True)
    return affinity.translate(turned, east_m, north_m)
