"""Collection segments: eqs 18 and 19 and Definition 2 of Li, Chen, Wang, Li (2018).

In axes rotated by the flight direction θ, x̂ ahead and ŷ to the left, a right-looking sensor on the line ŷ
sees the strip [ŷ − l_far, ŷ − l_near] with l_far = l_near + l_sw. Let the region span [ŷ_min, ŷ_max].

One pass (k_t = 0). Eq 19 puts the line at ŷ_in = ŷ_max + l_near for η = 0, where the strip's near edge lies
on the region's left side, and at ŷ_out = ŷ_min + l_sw + l_near for η = 1, where its far edge lies on the
right side. In between both edges lie outside the region as long as ŷ_max − ŷ_min ≤ l_sw.

Two passes (k_t = 1). With ŷ_out = ŷ_min + 2·l_sw + l_near the slack s = ŷ_out − ŷ_in
= 2·l_sw − (ŷ_max − ŷ_min) is what two strips have to spare. The first pass sees
[ŷ_max + η₁s − l_sw, ŷ_max + η₁s]. The second flies at θ + 180° on the other side; in the first's axes it sees
[ŷ_min − η₂s, ŷ_min − η₂s + l_sw]. They meet when ŷ_min − η₂s + l_sw ≥ ŷ_max + η₁s − l_sw, which is
(η₁ + η₂)·s ≤ s: the paper's η_max = 1 − η₁ of section 4.3.3.

A left-looking sensor is the mirror image: ŷ changes sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage.merge import MergedRegion
from planner.coverage.strips.classify import Spans, fits, hull_points, spans_at
from planner.errors import InfeasibleError
from planner.route import CollectPass, Look
from planner.sensors.sar import SarSensor
from planner.sensors.strip import strip_on, swaths_m
from planner.sensors.view import seen_on_flat
from planner.wishes import HIGHEST_M

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Neighbourhood:
    """The collection segments of one region for one side of view, eq 20.

    Parameters
    ----------
    region, sensor, height_m, look, turns
        What is seen, with what, from which height over the ground, to which side, with k_t turns.
    angles_rad
        Θ of Definition 1, shape (M,).
    spans
        The region's extent at these angles.
    """

    region: MergedRegion
    sensor: SarSensor
    height_m: float
    look: Look
    turns: int
    angles_rad: Floats
    spans: Spans

    def lines(self, etas: Floats, *, opposite: bool = False) -> Floats:
        """Ends of the collection segments of eqs 18 and 19.

        Parameters
        ----------
        etas
            η, shape (K,).
        opposite
            The second passes of a distributed region, flown at θ + 180° on the other side.

        Returns
        -------
        ndarray
            float64, shape (M, K, 2, 2): angle, η, start and end in flight direction, east_m and north_m.
        """
        spans = _turned(self.spans) if opposite else self.spans
        angles_rad = self.angles_rad + (math.pi if opposite else 0.0)
        strip = strip_on(self.sensor, self.height_m, angles_rad, self.look)
        swath_m, near_m = strip.swath_m, strip.near_m
        # Eq 19 for a right-looking sensor, mirrored for a left-looking one.
        inner_m = spans.y_max_m + near_m
        outer_m = spans.y_min_m + (self.turns + 1) * swath_m + near_m
        if self.look == "left":
            inner_m = spans.y_min_m - near_m
            outer_m = spans.y_max_m - (self.turns + 1) * swath_m - near_m
        y_m = inner_m[:, None] + etas[None, :] * (outer_m - inner_m)[:, None]
        x_m = np.stack([spans.x_min_m - strip.run_in_m, spans.x_max_m + strip.run_out_m], axis=1)
        cos, sin = np.cos(angles_rad)[:, None, None], np.sin(angles_rad)[:, None, None]
        east_m = cos * x_m[:, None, :] - sin * y_m[:, :, None]
        north_m = sin * x_m[:, None, :] + cos * y_m[:, :, None]
        lines: Floats = np.stack([east_m, north_m], axis=-1)
        return lines

    def collect(self, index: int, eta: float, *, opposite: bool = False) -> CollectPass:
        """The pass at the angle with this index and η."""
        line = self.lines(np.array([eta]), opposite=opposite)[index, 0]
        angle_rad = float(self.angles_rad[index]) + (math.pi if opposite else 0.0)
        return collect_along(self.region, self.sensor, self.height_m, self.look, line, angle_rad, eta)


def segment(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    angle_rad: float,
    look: Look,
    eta: float,
    turns: int = 0,
) -> CollectPass:
    """One collection segment L(θ, η) of eqs 18 and 19.

    With ``turns`` = 1 it is one of a pair: see ``pair``.

    Raises
    ------
    InfeasibleError
        Where k_t + 1 swaths do not see the region at this angle.
    """
    if not 0.0 <= eta <= 1.0:
        raise ValueError(f"η lies in [0, 1], not {eta}")
    angles_rad = np.array([angle_rad])
    spans = spans_at(hull_points(region.area), angles_rad)
    if not fits(spans.across_m, swaths_m(sensor, height_m, angles_rad), turns)[0]:
        raise too_wide(region, sensor, height_m, float(spans.across_m[0]))
    return Neighbourhood(region, sensor, height_m, look, turns, angles_rad, spans).collect(0, eta)


def pair(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    angle_rad: float,
    look: Look,
    eta_first: float,
    eta_second: float,
) -> tuple[CollectPass, CollectPass]:
    """Both passes of a distributed region: at θ, then at θ + 180° on the other side."""
    if eta_first + eta_second > 1.0 + 1e-12:
        raise ValueError("the two strips leave a gap: η of the second pass is at most 1 − η of the first")
    return (
        segment(region, sensor, height_m, angle_rad, look, eta_first, 1),
        segment(region, sensor, height_m, angle_rad + math.pi, look, eta_second, 1),
    )


def _turned(spans: Spans) -> Spans:
    return Spans(-spans.x_max_m, -spans.x_min_m, -spans.y_max_m, -spans.y_min_m)


def collect_along(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    look: Look,
    line: Floats,
    angle_rad: float,
    eta: float,
) -> CollectPass:
    """The pass along a line, shape (2, 2), flown at an angle; its footprint is what it sees in full."""
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    side = np.array([-ahead[1], ahead[0]]) * (1.0 if look == "left" else -1.0)
    sensor = sensor.whole()
    half_m = sensor.aperture_m(height_m) / 2.0
    near, far = side * sensor.near_m(height_m), side * sensor.far_m(height_m)
    first, last = line[0] + half_m * ahead, line[1] - half_m * ahead
    footprint = Polygon([first + near, last + near, last + far, first + far])
    if sensor.squint_rad != 0.0 or sensor.mode == "spotlight" or sensor.crabs:
        footprint = seen_on_flat(sensor, line, look, height_m)
    start, end = (float(line[0, 0]), float(line[0, 1])), (float(line[1, 0]), float(line[1, 1]))
    return CollectPass(region.names, sensor.name, look, start, end, eta, footprint)


def too_wide(region: MergedRegion, sensor: SarSensor, height_m: float, across_m: float) -> InfeasibleError:
    """The refusal of a region that two swaths cannot see, with the height that would do."""
    swath_m = sensor.swath_m(height_m)
    # Of a swath only the part that the beam gives grows with the height.
    fixed_m = 2.0 * sensor.position_margin_m
    needed_m = height_m * (across_m / 2.0 + fixed_m) / (swath_m + fixed_m)
    higher = f"fly at {needed_m:.0f} m or higher over it, " if needed_m <= HIGHEST_M else ""
    return InfeasibleError(
        "swath",
        region.label,
        f"it is {across_m:.0f} m wide where it is narrowest, more than two swaths of {swath_m:.0f} m",
        f"{higher}widen the elevation beam, or divide the region",
        region.centroid,
    )
