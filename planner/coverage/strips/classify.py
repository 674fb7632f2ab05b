"""Point, quasi-point or distributed: eq 16, eq 17 and Algorithm 2 of Li, Chen, Wang, Li (2018)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

RegionKind = Literal["point", "quasi-point", "distributed"]

#: Algorithm 2 steps the approach angle by one degree.
STEP_RAD = math.radians(1.0)

#: Spans are sums of rounded products, and coordinates of a region are known to no more than a billionth of a
#: degree: half a millimetre never decides. The judge counts ground a millimetre beside a footprint as seen.
ROUNDING_M = 5e-4


@dataclass(frozen=True, slots=True)
class Spans:
    """Extent of a region in rotated axes, one entry an angle; all float64, shape (M,).

    ``x`` runs along the flight direction, ``y`` to its left.
    """

    x_min_m: NDArray[np.float64]
    x_max_m: NDArray[np.float64]
    y_min_m: NDArray[np.float64]
    y_max_m: NDArray[np.float64]

    @property
    def along_m(self) -> NDArray[np.float64]:
        """ΔX̂ of Algorithm 2, the span along the flight direction."""
        return self.x_max_m - self.x_min_m

    @property
    def across_m(self) -> NDArray[np.float64]:
        """ΔŶ of Algorithm 2, the span across it."""
        return self.y_max_m - self.y_min_m


@dataclass(frozen=True, slots=True)
class Classification:
    """The category of a region and what it rests on.

    Parameters
    ----------
    kind
        Eq 16.
    turns
        k_t of eq 19, the fewest turns that see all of it: 0, or 1 for a distributed region.
    angles_rad, long_m, short_m
        float64, shape (K,): θ_k over 0–90°, and the side lengths a and b of the bounding rectangle there.
    feasible_rad
        float64, shape (M,): Θ of Definition 1 over 0–360°, the flight directions that see all of the region
        with ``turns`` turns; empty where even two swaths are too narrow at every angle.
    """

    kind: RegionKind
    turns: Literal[0, 1]
    angles_rad: NDArray[np.float64]
    long_m: NDArray[np.float64]
    short_m: NDArray[np.float64]
    feasible_rad: NDArray[np.float64]


def angles_around(step_rad: float = STEP_RAD) -> NDArray[np.float64]:
    """Angles from 0 to below 2π in equal steps no larger than ``step_rad``, each quarter turn among them."""
    quarter = max(1, math.ceil(math.pi / 2.0 / step_rad - 1e-9))
    return np.arange(4 * quarter, dtype=np.float64) * (math.pi / 2.0 / quarter)


def spans_at(points_m: NDArray[np.float64], angles_rad: NDArray[np.float64]) -> Spans:
    """Eq 17 and lines 5–6 of Algorithm 2, exact on vertices instead of edge pixels.

    Parameters
    ----------
    points_m
        Shape (N, 2): the hull's vertices, east_m and north_m.
    angles_rad
        Shape (M,).
    """
    cos, sin = np.cos(angles_rad)[:, None], np.sin(angles_rad)[:, None]
    x = cos * points_m[:, 0] + sin * points_m[:, 1]
    y = -sin * points_m[:, 0] + cos * points_m[:, 1]
    return Spans(x.min(axis=1), x.max(axis=1), y.min(axis=1), y.max(axis=1))


def hull_points(area: BaseGeometry) -> NDArray[np.float64]:
    """Vertices of the convex hull, shape (N, 2): they alone decide spans."""
    return np.asarray(shapely.get_coordinates(area.convex_hull), dtype=np.float64)


def classify(area: BaseGeometry, swath_m: float, step_rad: float = STEP_RAD) -> Classification:
    """Category of a region (Algorithm 2).

    Eq 16 and Algorithm 2 differ where a side equals the swath. A span equal to the swath is still seen whole
    by one pass, so here, as in eq 16: a point region has a < l_sw at every angle, a distributed one has
    b > l_sw at every angle, every other one is quasi-point; and an angle is feasible when the span across
    the flight direction is ≤ (k_t + 1)·l_sw.

    Parameters
    ----------
    area
        The region, or the closed shape of merged ones.
    swath_m
        l_sw of eq 1, > 0.
    step_rad
        Step of the approach angle.
    """
    points_m = hull_points(area)
    around_rad = angles_around(step_rad)
    spans = spans_at(points_m, around_rad)
    # The other three quarters repeat the first with the sides swapped.
    quarter = slice(0, len(around_rad) // 4)
    angles_rad = around_rad[quarter]
    long_m = np.maximum(spans.along_m, spans.across_m)[quarter]
    short_m = np.minimum(spans.along_m, spans.across_m)[quarter]
    kind: RegionKind = "quasi-point"
    if bool(np.all(long_m < swath_m)):
        kind = "point"
    elif bool(np.all(short_m > swath_m + ROUNDING_M)):
        kind = "distributed"
    turns: Literal[0, 1] = 1 if kind == "distributed" else 0
    feasible_rad = around_rad[fits(spans.across_m, swath_m, turns)]
    return Classification(kind, turns, angles_rad, long_m, short_m, feasible_rad)


def fits(
    across_m: NDArray[np.float64], swath_m: float | NDArray[np.float64], turns: int
) -> NDArray[np.bool_]:
    """Which spans across the flight direction k_t + 1 swaths see whole (Definition 1)."""
    return across_m <= (turns + 1) * swath_m + ROUNDING_M
