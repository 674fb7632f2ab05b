"""What a search is asked, and what it answers with: the worth of ground, a budget, what a pass sees."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.route import Anchor

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Worth:
    """What seeing ground is worth, by square cells of it.

    Parameters
    ----------
    scores
        Per square metre, float64, shape (rows, columns): the first row is the southernmost, the first column
        the westernmost; 0 where nothing is searched. Finite, none negative.
    west_m, south_m
        Corner of the first cell, in the local frame.
    cell_m
        Length of a cell's edge.
    """

    scores: Floats
    west_m: float
    south_m: float
    cell_m: float

    def __post_init__(self) -> None:
        if self.scores.ndim != 2 or not np.isfinite(self.scores).all() or (self.scores < 0.0).any():
            raise ValueError("scores are finite, not negative, and have rows and columns")

    @property
    def centres_m(self) -> Floats:
        """Middles of the cells, shape (rows, columns, 2): east and north."""
        rows, columns = self.scores.shape
        east_m = self.west_m + (np.arange(columns) + 0.5) * self.cell_m
        north_m = self.south_m + (np.arange(rows) + 0.5) * self.cell_m
        return np.stack(np.meshgrid(east_m, north_m), axis=-1)

    @property
    def total(self) -> float:
        """Of all ground."""
        return float(self.scores.sum()) * self.cell_m**2


@dataclass(frozen=True, slots=True)
class Budget:
    """What a flight may use, the reserve taken off; inf where not limited."""

    energy_wh: float = math.inf
    length_m: float = math.inf
    time_s: float = math.inf


@dataclass(frozen=True, slots=True)
class Swath:
    """Ground that is seen on a straight course, beside it and along it.

    Parameters
    ----------
    right_m, left_m
        Edges of the strip, beside the course, to the left positive: −w and w for what looks straight down.
    run_in_m, run_out_m
        How far before ground the sensor is on, and beyond it; negative where it sees ahead, or behind.
    nominal
        What is seen where none of the margins are used up; None where that is the same.
    """

    right_m: float
    left_m: float
    run_in_m: float
    run_out_m: float
    nominal: Swath | None = None

    @property
    def width_m(self) -> float:
        """Of the strip."""
        return self.left_m - self.right_m

    @property
    def middle_m(self) -> float:
        """Beside the course, to the left positive."""
        return 0.5 * (self.left_m + self.right_m)


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """One search by one aircraft, at one height with one sensor.

    Parameters
    ----------
    ground
        What is searched.
    free
        Where the aircraft may be, margins taken off.
    worth
        Of the ground.
    start, end
        Where the search begins and where it has to end.
    budget
        For all between.
    turn_radius_m
        Tightest turn over the ground.
    half_width_m
        Half of what is seen across the course.
    """

    ground: Polygon | MultiPolygon
    free: BaseGeometry
    worth: Worth
    start: Anchor
    end: Anchor
    budget: Budget
    turn_radius_m: float
    half_width_m: float


def worth_of_ground(
    ground: Polygon | MultiPolygon, cell_m: float, scores: NDArray[np.float64] | None = None
) -> Worth:
    """Ground as cells, those whose middle lies in it, all worth the same or as given for the same cells."""
    west_m, south_m, east_m, north_m = ground.bounds
    columns = max(1, math.ceil((east_m - west_m) / cell_m - 1e-9))
    rows = max(1, math.ceil((north_m - south_m) / cell_m - 1e-9))
    empty = Worth(np.zeros((rows, columns)), west_m, south_m, cell_m)
    shapely.prepare(ground)
    inside = shapely.contains_xy(ground, empty.centres_m[..., 0], empty.centres_m[..., 1])
    worth = np.ones((rows, columns)) if scores is None else scores
    return Worth(np.where(inside, worth, 0.0), west_m, south_m, cell_m)
