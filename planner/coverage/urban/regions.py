"""Regions as areas among obstacles for cameras that look down, and the passes that methods by name give."""

from __future__ import annotations

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from planner.airspace.airspace import Airspace, Level
from planner.airspace.built import bare_ground
from planner.airspace.shapes import banded_shapes
from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.merge import polygons_of
from planner.coverage.survey.frame import lengthened_m
from planner.coverage.urban.area import Building, Place, UrbanArea
from planner.coverage.urban.free import FreeSpace, enlarged, free_space
from planner.coverage.urban.handed import Hand
from planner.coverage.urban.measures import Sweep
from planner.coverage.urban.methods import SEQUENCES
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.sensors.base import Sensor
from planner.sensors.camera import CameraSensor
from planner.sensors.camera_view import seen_on_flat
from planner.vehicle.model import FlightModel
from planner.wishes import Region

#: Courses at which the footprint is looked at: the narrowest counts.
COURSES_RAD = np.radians(np.arange(0.0, 360.0, 10.0))
#: Sweeps shorter than this are flown this long, by half of the difference at either end.
LEAST_PASS_M = 1.0
#: Sweeps this far outside of the ground run along its edge.
EDGE_M = 1e-3

Floats = NDArray[np.float64]


def camera_of(region: Region, sensor: Sensor, method: str) -> CameraSensor:
    """The camera of a region.

    Raises
    ------
    InfeasibleError
        Where it is none.
    """
    if not isinstance(sensor, CameraSensor):
        raise InfeasibleError(
            "coverage",
            region.name,
            f"coverage {method} sweeps the ground below; {sensor.name} is no camera",
            "see it with a camera, or leave method.coverage out",
        )
    return sensor


def urban_passes(
    region: Region,
    camera: CameraSensor,
    height_m: float,
    airspace: Airspace,
    level: Level,
    model: FlightModel,
    method: str,
    seed: int,
    here: Place,
) -> tuple[CollectPass, ...]:
    """Passes over a region, part by part, in the order and direction that a method gives.

    Joins are the house's: the passes alone are of the method, with its order.

    Raises
    ------
    InfeasibleError
        Where obstacles leave no free ground in a part, or the overlaps leave no width.
    """
    found: list[CollectPass] = []
    parts = sorted(polygons_of(region.area), key=lambda part: float(part.distance(Point(here))))
    for part in parts:
        urban, free = _posed(region, part, camera, height_m, airspace, level, model, here)
        hand = Hand.of(urban)
        if hand.sign != 1.0:
            urban = hand.there(urban)
        laid = free if hand.sign == 1.0 else free_space(urban)
        sweeps = [hand.back(sweep) for sweep in SEQUENCES[method](urban, laid, seed)]
        ground = free.ground.buffer(EDGE_M)
        found += [pass_of(region, camera, height_m, sweep, ground) for sweep in sweeps]
        here = found[-1].end
    return tuple(found)


def open_ground(area: BaseGeometry, airspace: Airspace, level: Level, margin_m: float) -> BaseGeometry:
    """What of an area keeps a margin from all that may not be entered at a level."""
    blocked = [
        banded.shape.polygon().buffer(margin_m)
        for banded in banded_shapes(airspace, level.amsl_m - level.height_m)
        if banded.hard and banded.counts(*level.counted_m)
    ]
    ground: BaseGeometry = shapely.difference(area, shapely.union_all(blocked), grid_size=1e-6)
    return ground


def top_over(area: BaseGeometry, airspace: Airspace, level: Level) -> float:
    """How high over home what may not be entered at a level reaches over an area, clearance included."""
    tops_m = [
        banded.high_m + banded.kept_m
        for banded in banded_shapes(airspace, level.amsl_m - level.height_m)
        if banded.hard and banded.counts(*level.counted_m) and banded.shape.polygon().intersects(area)
    ]
    return max(tops_m, default=-math.inf)


def unseen_m2(region: Region, airspace: Airspace, level: Level, passes: tuple[CollectPass, ...]) -> float:
    """How much of a region's bare ground no pass sees."""
    return float(unseen_of(region, airspace, level, passes).area)


def unseen_of(
    region: Region, airspace: Airspace, level: Level, passes: tuple[CollectPass, ...]
) -> BaseGeometry:
    """What of a region's bare ground no pass sees."""
    seen = shapely.union_all([each.footprint for each in passes], grid_size=1e-6)
    ground = bare_ground(region.area, airspace, level)
    left: BaseGeometry = shapely.difference(ground, seen, grid_size=1e-6)
    return left


def _posed(
    region: Region,
    part: Polygon,
    camera: CameraSensor,
    height_m: float,
    airspace: Airspace,
    level: Level,
    model: FlightModel,
    here: Place,
) -> tuple[UrbanArea, FreeSpace]:
    """The problem that methods are given.

    D_safe is the clearance, the margin of transits and what a turn takes at the end of a sweep that runs up
    to an obstacle: its radius and the straight flight before the next. What stands below the flight by the
    clearance is no obstacle; of what is left no height matters, for transits are flown level.
    """
    width_m = min(camera.lane_spacing_m(height_m, float(course)) for course in COURSES_RAD)
    if width_m <= 0.0:
        raise InfeasibleError(
            "overlap",
            region.name,
            f"from {height_m:.0f} m photos of {camera.name} leave no width between lanes",
            "less side_overlap, a greater height or a wider lens",
        )
    runs_m = [
        max(camera.run_in_m(height_m, float(course)), camera.run_out_m(height_m, float(course)))
        for course in COURSES_RAD
    ]
    if max(runs_m) >= 0.0:
        raise InfeasibleError(
            "overlap",
            region.name,
            f"from {height_m:.0f} m sweeps with {camera.name} begin before what they see, for its overlap",
            "less forward_overlap, a greater height or a smaller tilt_deg",
        )
    turn_m = model.turn_radius_m + model.settle_m
    safe_m = airspace.clearance_m + TRANSIT_MARGIN_M + turn_m
    area: BaseGeometry = part
    if airspace.area is not None:
        area = shapely.intersection(part, airspace.area.buffer(-TRANSIT_MARGIN_M - turn_m), grid_size=1e-6)
    buildings = tuple(
        Building(banded.shape.polygon(), math.inf)
        for banded in banded_shapes(airspace, level.amsl_m - level.height_m)
        if banded.hard and banded.counts(*level.counted_m)
    )
    blocked = shapely.union_all([enlarged(each.outline, safe_m) for each in buildings])
    room = [
        piece
        for piece in shapely.get_parts(shapely.difference(area, blocked, grid_size=1e-6))
        if isinstance(piece, Polygon) and not piece.is_empty
    ]
    if not room:
        raise InfeasibleError(
            "hard-zone",
            region.name,
            f"obstacles, each with {safe_m:.0f} m for clearance and turns, leave no free ground in it",
            "fly higher, lower the clearance, or take an aircraft that turns tighter",
            (part.centroid.x, part.centroid.y),
        )
    nearest = min(room, key=lambda piece: float(piece.distance(Point(here))))
    start, _ = nearest_points(nearest, Point(here))
    outlines = [piece for piece in shapely.get_parts(area) if isinstance(piece, Polygon)]
    urban = UrbanArea(
        max(outlines, key=lambda piece: piece.area),
        buildings,
        width_m,
        -2.0 * max(runs_m),
        height_m,
        math.inf,
        safe_m,
        (start.x, start.y),
        (start.x, start.y),
        span_m=0.0,
        turn_radius_m=0.0 if model.aircraft.turns_on_the_spot else model.turn_radius_m,
        speed_m_s=model.airspeed_m_s,
        stop_s=model.stop_s,
    )
    return urban, free_space(urban)


def pass_of(
    region: Region, camera: CameraSensor, height_m: float, sweep: Sweep, ground: BaseGeometry
) -> CollectPass:
    """The pass of a sweep, longer within the ground where the camera could not take its photos in time.

    Parameters
    ----------
    height_m
        Over the ground seen.
    ground
        What may be flown over, a little wider than it is.
    """
    ends = np.array([sweep.start, sweep.end])
    ahead = (ends[1] - ends[0]) / sweep.length_m
    length_m = max(sweep.length_m, LEAST_PASS_M)
    ends += np.outer([-0.5, 0.5], (length_m - sweep.length_m) * ahead)
    course_rad = math.atan2(ahead[1], ahead[0])
    apart_m = camera.photo_spacing_m(height_m, course_rad)
    spacings = np.array([[length_m], [apart_m], [camera.least_spacing_m(course_rad)]])
    more_m = float(lengthened_m(*spacings)[0])
    before_m, after_m = _room_m(ends[0], -ahead, more_m, ground), _room_m(ends[1], ahead, more_m, ground)
    before_m = min(before_m, max(more_m / 2.0, more_m - after_m))
    after_m = min(after_m, more_m - before_m)
    start, end = (tuple(place) for place in (ends + np.outer([-before_m, after_m], ahead)).tolist())
    seen = seen_on_flat(camera, (start, end), height_m)
    return CollectPass((region.name,), camera.name, "down", start, end, 0.5, seen, apart_m)


def _room_m(place: Floats, ahead: Floats, most_m: float, ground: BaseGeometry) -> float:
    """How far it goes on from a place within the ground."""
    if most_m <= 0.0:
        return 0.0
    onward = shapely.intersection(shapely.linestrings([place, place + most_m * ahead]), ground)
    here = Point(place)
    return max(
        (float(part.length) for part in shapely.get_parts(onward) if part.distance(here) < EDGE_M),
        default=0.0,
    )
