"""Where collects may lie: constraint c4 (eq 9, Li, et al. 2018), hard zones, threats, room for turns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.growth import grown
from planner.airspace.shapes import hard_shapes, soft_shapes
from planner.airspace.zones import TRANSIT_MARGIN_M, inner_area
from planner.coverage.lines import flown_straight, inside
from planner.coverage.merge import GRID_M
from planner.vehicle.model import FlightModel
from planner.wishes import Objective

Floats = NDArray[np.float64]
Grades = NDArray[np.int16]

#: Kept between collects and threats or zones, so that no rounding puts a line inside.
MARGIN_M = 5.0

#: Grade of a line that leaves the operating area or enters a hard zone. Sums of two such stay in int16.
FORBIDDEN = 100

#: What a line may still lack, worst first; grades add up, 0 is best.
NO_ROOM_TO_TURN = 4
CROSSES_THREAT = 2
TURNS_IN_THREAT = 1


@dataclass(frozen=True, slots=True)
class Room:
    """The ground a route has to itself.

    Parameters
    ----------
    area
        Everything flown stays inside; None where not limited.
    hard, soft
        What must not and what should not be entered, ``MARGIN_M`` wider than asked for. ``soft`` is empty
        where the method leaves threats out.
    turn_radius_m, settle_m
        Of the aircraft: radius of its turns, straight flight before a collect.
    """

    area: Polygon | None
    hard: BaseGeometry
    soft: BaseGeometry
    turn_radius_m: float
    settle_m: float

    @classmethod
    def of(
        cls,
        airspace: Airspace,
        level: Level,
        model: FlightModel,
        objective: Objective,
        *,
        threat_aware: bool,
    ) -> Room:
        """The room at a level; soft threats count where ``threat_aware``."""
        hard = [shape.polygon().buffer(MARGIN_M) for shape in hard_shapes(airspace, level)]
        # Threats whose risk has no weight are none.
        minded = {"missile": objective.missile > 0.0, "radar": objective.radar > 0.0}
        models = {threat.name: threat.model for threat in airspace.threats}
        soft = [
            shape.polygon().buffer(MARGIN_M)
            for shape in soft_shapes(airspace, level)
            if threat_aware and minded[models[shape.name]]
        ]
        return cls(
            airspace.area,
            shapely.union_all(hard, grid_size=GRID_M),
            shapely.union_all(soft, grid_size=GRID_M),
            model.turn_radius_m,
            model.settle_m,
        )

    def grade(self, lines: Floats) -> Grades:
        """How well collects can be flown, 0 best, ``FORBIDDEN`` not at all.

        Room to turn means: at the entry (before the straight flight to settle) and at the exit, the whole
        turning circle to the left or the one to the right is free, so the aircraft can come from and leave
        to any direction.

        Parameters
        ----------
        lines
            Shape (..., 2, 2): start and end of the collects in flight direction.

        Returns
        -------
        ndarray
            int16, shape (...).
        """
        flown = flown_straight(lines, self.settle_m)
        entry, exits = flown[..., 0, :], flown[..., 1, :]
        ahead = lines[..., 1, :] - lines[..., 0, :]
        ahead = ahead / np.hypot(ahead[..., 0], ahead[..., 1])[..., None]
        allowed = inside(flown, inner_area(self.area, TRANSIT_MARGIN_M)) & ~_meets(self.hard, flown)
        grades = np.where(allowed, 0, FORBIDDEN).astype(np.int16)
        grades += CROSSES_THREAT * _meets(self.soft, flown)
        left = np.stack([-ahead[..., 1], ahead[..., 0]], axis=-1) * self.turn_radius_m
        circles = np.stack([entry + left, entry - left, exits + left, exits - left], axis=-2)
        free = self._circles_free(circles, self.hard, self.area)
        calm = free & self._circles_free(circles, self.soft, None)
        grades += NO_ROOM_TO_TURN * ~_both_ends(free)
        grades += TURNS_IN_THREAT * (_both_ends(free) & ~_both_ends(calm))
        return np.minimum(grades, FORBIDDEN).astype(np.int16)

    def _circles_free(self, centres: Floats, taken: BaseGeometry, area: Polygon | None) -> NDArray[np.bool_]:
        free = np.ones(centres.shape[:-1], dtype=np.bool_)
        if not taken.is_empty:
            free &= ~_holds(grown(taken, self.turn_radius_m), centres)
        if area is not None:
            free &= _holds(grown(area, -self.turn_radius_m - MARGIN_M), centres)
        return free


def _both_ends(free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    return np.asarray(free[..., :2].any(axis=-1) & free[..., 2:].any(axis=-1), dtype=np.bool_)


def _meets(taken: BaseGeometry, lines: Floats) -> NDArray[np.bool_]:
    if taken.is_empty:
        return np.zeros(lines.shape[:-2], dtype=np.bool_)
    shapely.prepare(taken)
    return np.asarray(shapely.intersects(taken, shapely.linestrings(lines)), dtype=np.bool_)


def _holds(area: BaseGeometry, places: Floats) -> NDArray[np.bool_]:
    shapely.prepare(area)
    return np.asarray(shapely.contains_xy(area, places[..., 0], places[..., 1]), dtype=np.bool_)
