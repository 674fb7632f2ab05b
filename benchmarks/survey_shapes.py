"""Random regions of the survey benchmarks."""

from __future__ import annotations

import math

import numpy as np
import shapely
from scipy.spatial import ConvexHull
from shapely.geometry import Polygon


def random_convex(rng: np.random.Generator, area_m2: float) -> Polygon:
    """A convex polygon of this area, up to three times as long as wide."""
    points = rng.normal(size=(12, 2)) * [1.0, rng.uniform(0.3, 1.0)]
    hull = Polygon(points[ConvexHull(points).vertices])
    return shapely.transform(hull, lambda p: p * math.sqrt(area_m2 / hull.area))


def random_star(rng: np.random.Generator, area_m2: float) -> Polygon:
    """A polygon of this area whose middle sees all of it, often concave."""
    count = int(rng.integers(5, 14))
    angles_rad = np.sort(rng.uniform(0.0, math.tau, count))
    radii = rng.uniform(0.35, 1.0, count)
    star = Polygon(np.column_stack([radii * np.cos(angles_rad), radii * np.sin(angles_rad)]))
    if not star.is_valid or star.area < 0.2:
        return random_star(rng, area_m2)
    return shapely.transform(star, lambda p: p * math.sqrt(area_m2 / star.area))
