"""What one aircraft flies among at one level, as arrays: zones with margins, room for turns, prices, wind."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.airspace import Airspace, Level
from planner.airspace.barriers import COLUMNS, polygon_rows, rows_of
from planner.airspace.growth import grown
from planner.airspace.prices import INSIDE_FACTOR, soft_prices
from planner.airspace.shapes import DiscShape, hard_shapes
from planner.airspace.terrain import Ground
from planner.airspace.values import STILL_AIR, Wind
from planner.airspace.zones import TRANSIT_MARGIN_M, inner_area
from planner.vehicle.model import FlightModel
from planner.wishes import Objective

Floats = NDArray[np.float64]

#: Zones are kept this much larger, room for the chords of arcs and the margin of transits.
MARGIN_M = 10.0


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What one aircraft flies among at one level: what the ways to see all regions have in common.

    Parameters
    ----------
    area, room
        Where passes may be of the operating area, and where the centre of a full turn may be; None without an
        area.
    hard, soft
        Discs that may not, and should not, be entered, shape (K, 3).
    prices, yields
        Of the soft discs: what a metre inside costs besides, and whether they may be crossed to save way,
        (K,); where not given all cost ``INSIDE_FACTOR`` and none is crossed where there is a way round.
    barriers
        The polygons as rows of ``barriers.polygon_rows``.
    cramped
        Where the centre of a full turn may not be for the polygons' sake; None without any.
    hard_polygons
        Polygons that may not be entered.
    radius_m, settle_m
        Turn radius, and straight flight before each collect.
    stops_m
        What each pass costs besides, of what brakes for its corners.
    airspeed_m_s, wind
        In a wind, metres over the ground count as metres through the air: time by airspeed.
    ground, level_m
        Terrain, and the flight's level over its datum: ground that a pass leaves in shadow or layover costs.
    """

    area: Polygon | MultiPolygon | None
    room: BaseGeometry | None
    hard: Floats
    soft: Floats
    hard_polygons: tuple[Polygon, ...]
    radius_m: float
    settle_m: float
    airspeed_m_s: float = 1.0
    wind: Wind = STILL_AIR
    ground: Ground | None = None
    level_m: float = 0.0
    prices: Floats | None = None
    yields: NDArray[np.bool_] | None = None
    barriers: Floats = field(default_factory=lambda: np.empty((0, COLUMNS)))
    cramped: BaseGeometry | None = None
    stops_m: float = 0.0

    @property
    def discs(self) -> Floats:
        """All zones between poses, for the kernels: see ``barriers``."""
        if self.prices is None or self.yields is None:
            return rows_of(self.hard, self.soft, np.full(len(self.soft), np.inf), self.barriers)
        return rows_of(self.hard, self.soft, np.where(self.yields, self.prices, np.inf), self.barriers)

    @property
    def priced(self) -> Floats:
        """Soft discs with what a metre inside costs besides, (K, 4)."""
        prices = np.full(len(self.soft), INSIDE_FACTOR) if self.prices is None else self.prices
        return np.column_stack([self.soft, prices])


def surroundings(airspace: Airspace, level: Level, model: FlightModel, objective: Objective) -> Surroundings:
    """Area, discs and polygons, with the margin transits keep."""
    hard = list(hard_shapes(airspace, level))
    radius_m = model.turn_radius_m
    area = inner_area(airspace.area, TRANSIT_MARGIN_M)
    priced = soft_prices(airspace, level, objective)
    soft = priced[:, :3] + np.array([0.0, 0.0, MARGIN_M])
    polygons = tuple(
        shape.area.buffer(MARGIN_M, join_style="mitre") for shape in hard if not isinstance(shape, DiscShape)
    )
    return Surroundings(
        area=area,
        room=None if airspace.area is None else grown(airspace.area, -radius_m),
        hard=_discs([shape for shape in hard if isinstance(shape, DiscShape)]),
        soft=soft,
        hard_polygons=polygons,
        radius_m=radius_m,
        settle_m=model.settle_m,
        airspeed_m_s=model.airspeed_m_s,
        wind=model.wind,
        ground=airspace.terrain,
        level_m=level.amsl_m,
        prices=priced[:, 3],
        yields=priced[:, 3] < INSIDE_FACTOR,
        barriers=polygon_rows(polygons),
        cramped=shapely.union_all([grown(polygon, radius_m) for polygon in polygons]) if polygons else None,
        stops_m=model.stops_m,
    )


def _discs(shapes: list[DiscShape]) -> Floats:
    rows = [(*shape.centre, shape.radius_m + MARGIN_M) for shape in shapes]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
