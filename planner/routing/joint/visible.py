"""What a scenario asks to be seen, where, and among what: regions, their ways to be seen, zones."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.shapes import DiscShape, hard_shapes
from planner.airspace.zones import inner_area
from planner.coverage.merge import MergedRegion, merge_regions
from planner.coverage.neighbourhood import check_sensor
from planner.coverage.sweeps import Side
from planner.errors import Finding, InfeasibleError
from planner.routing.joint.barriers import polygon_rows
from planner.routing.joint.options import Surroundings
from planner.routing.joint.prices import INSIDE_FACTOR, soft_prices
from planner.routing.joint.relaxation import explained
from planner.routing.joint.targets import can_be_flown, targets
from planner.routing.legs import TRANSIT_MARGIN_M
from planner.scenario import Scenario
from planner.sensors.view import sensing
from planner.vehicle.aircraft import Aircraft

Floats = NDArray[np.float64]

#: Zones are kept this much larger, room for the chords of arcs and the margin of transits.
MARGIN_M = 10.0


def surroundings(scenario: Scenario, aircraft: Aircraft) -> Surroundings:
    """Area, discs and polygons, with the margin transits keep."""
    hard = list(hard_shapes(scenario.airspace, scenario.level))
    radius_m = aircraft.planned_turn_radius_m
    area = inner_area(scenario.area, TRANSIT_MARGIN_M)
    priced = soft_prices(scenario)
    soft = priced[:, :3] + np.array([0.0, 0.0, MARGIN_M])
    polygons = tuple(
        shape.area.buffer(MARGIN_M, join_style="mitre") for shape in hard if not isinstance(shape, DiscShape)
    )
    return Surroundings(
        area=area,
        room=None if scenario.area is None else scenario.area.buffer(-radius_m),
        hard=_discs([shape for shape in hard if isinstance(shape, DiscShape)]),
        soft=soft,
        hard_polygons=polygons,
        radius_m=radius_m,
        settle_m=aircraft.settle_m,
        airspeed_m_s=aircraft.airspeed_m_s,
        wind=scenario.wind,
        ground=scenario.terrain,
        level_m=scenario.altitude_amsl_m,
        prices=priced[:, 3],
        yields=priced[:, 3] < INSIDE_FACTOR,
        barriers=polygon_rows(polygons),
        cramped=shapely.union_all([polygon.buffer(radius_m) for polygon in polygons]) if polygons else None,
    )


def sides_of(scenario: Scenario, aircraft: Aircraft) -> tuple[tuple[Side, ...], ...]:
    """The ways to see each region, part of one or visit to one that is not left out."""
    return visible(scenario, surroundings(scenario, aircraft)).sides


@dataclass(frozen=True, slots=True)
class Visible:
    """What can be seen, and how.

    Parameters
    ----------
    regions, sides
        Each region, part of one or visit to one with the families of passes that see it.
    divided
        Which of the merged regions are divided.
    dropped
        Those that cannot be seen and need not be.
    """

    regions: tuple[MergedRegion, ...]
    sides: tuple[tuple[Side, ...], ...]
    divided: tuple[int, ...]
    dropped: tuple[Finding, ...]


def visible(scenario: Scenario, around: Surroundings, whole: Collection[int] = ()) -> Visible:
    """Parts of regions with the families of passes that see them.

    Regions that are not required and not to be seen are named and left out. The paper's coverage, asked for
    by name, has two passes at most and divides nothing.

    Parameters
    ----------
    whole
        Merged regions not to divide.
    """
    regions: list[MergedRegion] = []
    sides: list[tuple[Side, ...]] = []
    divided: list[int] = []
    dropped: list[Finding] = []
    wide = scenario.method.coverage != "li2018"
    by_name = {region.name: region for region in scenario.regions}
    merged = merge_regions(scenario.regions, default_sensor=scenario.sensors[0].name)
    for index, region in enumerate(merged):
        first = by_name[region.names[0]]
        sensor = scenario.sensor_for(first)
        try:
            sensor, height_m = sensing(scenario, sensor, region.area)
            for name in region.names:
                check_sensor(by_name[name], sensor, height_m)
            found = targets(region, sensor, height_m, around, wide=wide, whole=index in whole)
        except InfeasibleError as refused:
            error = refused
            if error.constraint == "area":
                error = explained(scenario, region, refused, partial(_some_pass, region=region, wide=wide))
            if region.required:
                raise error from refused
            dropped.append(
                Finding(
                    error.feature, f"not-seen-{error.constraint}", error.message, error.relaxation, "warning"
                )
            )
            continue
        regions.extend(target.region for target in found)
        sides.extend(target.sides for target in found)
        if len(found) > region.revisits:
            divided.append(index)
    return Visible(tuple(regions), tuple(sides), tuple(divided), tuple(dropped))


def _some_pass(scenario: Scenario, *, region: MergedRegion, wide: bool) -> bool:
    """Whether a region can be seen in a scenario with other zones or at another altitude."""
    around = surroundings(scenario, scenario.aircraft[0])
    asked = next((s for s in scenario.sensors if s.name == region.sensor), scenario.sensors[0])
    try:
        sensor, height_m = sensing(scenario, asked, region.area)
        return can_be_flown(region, sensor, height_m, around, wide=wide)
    except InfeasibleError:
        return False


def _discs(shapes: list[DiscShape]) -> Floats:
    rows = [(*shape.centre, shape.radius_m + MARGIN_M) for shape in shapes]
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
