"""Where a finding is, as the plan says it: longitude and latitude."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from shapely import line_merge
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry

from planner.plan import LonLat
from planner.scenario import Scenario

#: Coordinates are rounded, and lines are drawn with chords for arcs: so far apart two places count as one.
PLACE_TOLERANCE_M = 0.05


def lonlat(scenario: Scenario, place_m: NDArray[np.float64] | tuple[float, float]) -> LonLat:
    """A place of the local frame in WGS 84."""
    lon_deg, lat_deg = scenario.frame.to_wgs84(place_m)
    return (float(lon_deg), float(lat_deg))


def middle(scenario: Scenario, shape: BaseGeometry) -> LonLat:
    """A place on the largest part of a shape."""
    if shape.geom_type == "MultiLineString":
        shape = line_merge(shape)
    largest = max(getattr(shape, "geoms", [shape]), key=lambda part: (part.area, part.length))
    place: Point = (
        largest.interpolate(0.5, normalized=True)
        if isinstance(largest, LineString)
        else largest.representative_point()
    )
    return lonlat(scenario, (place.x, place.y))
