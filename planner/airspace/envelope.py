"""The surface that a flight which follows the ground never comes below."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.airspace.envelope_kernels import LONGER, envelope
from planner.airspace.terrain import Ground
from planner.airspace.terrain_kernels import grounds_at

Floats = NDArray[np.float64]

#: Straights between knots of a height leave what they stand for by no more than this.
SMOOTH_M = 2.0
#: Between posts the surface is bilinear, and steeper there than from post to post.
BETWEEN_POSTS = 0.95


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """The lowest surface that keeps a height over all ground and is nowhere steeper than an aircraft climbs.

    From any place on or over it, flown in any direction at no more than that slope, the ground ahead is kept
    clear: a line that never comes below it never has to turn for the sake of height.

    Parameters
    ----------
    ground
        What it lies over.
    surface_m
        float64, as the ground's heights.
    """

    ground: Ground
    surface_m: Floats

    @classmethod
    def over(cls, ground: Ground, over_ground_m: float, slope: float) -> Envelope:
        """The surface over ground, ``slope`` being metres up for one along."""
        surface_m = envelope(ground.heights_m, ground.step_m, slope * BETWEEN_POSTS / LONGER)
        return cls(ground, surface_m + over_ground_m)

    def at(self, places_m: ArrayLike) -> Floats:
        """Its altitude at local places (..., 2); NaN off the grid."""
        places = np.ascontiguousarray(places_m, dtype=np.float64)
        flat = np.ascontiguousarray(places.reshape(-1, 2))
        ground = self.ground
        found: Floats = grounds_at(self.surface_m, ground.west_m, ground.south_m, ground.step_m, flat)
        return found.reshape(places.shape[:-1])
