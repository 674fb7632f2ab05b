"""Regions among obstacles by footprint sweeps, in the order of the method that was asked for by name."""

from __future__ import annotations

import math

from shapely.geometry import Point
from shapely.geometry.base import BaseGeometry

from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.urban.regions import camera_of, open_ground, top_over, unseen_m2, urban_passes
from planner.coverage.visible import Seeing
from planner.errors import Finding, InfeasibleError
from planner.progress import Progress, Stop, raise_if
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.tasks.setting import Setting
from planner.tasks.task import NOT_SEEN
from planner.wishes import Region

#: More of a region than this part left unseen is told.
LEFT_PART = 1e-5
#: Less ground than this is none.
LEAST_M2 = 1.0
#: The rule by which it is.
BESIDE = "beside-obstacles"


def swept(
    asked: Seeing, setting: Setting, method: str, seed: int, progress: Progress, stop: Stop
) -> tuple[tuple[CollectPass, ...], tuple[Finding, ...]]:
    """Passes over all regions, the nearest first, and what is to be said of those not seen, or not whole.

    Raises
    ------
    InfeasibleError
        Where a required region cannot be swept, or none can.
    """
    here = setting.ends[0].position
    passes: list[CollectPass] = []
    findings: list[Finding] = []
    refused: InfeasibleError | None = None
    waiting = list(asked.regions)
    while waiting:
        raise_if(stop)
        region = min(waiting, key=lambda each: float(each.area.distance(Point(here))))
        waiting.remove(region)
        level = asked.level.of(region)
        try:
            sensor, height_m = asked.suite.over(region.sensor, region.area, asked.airspace, level)
            camera = camera_of(region, sensor, method)
            where = (asked.airspace, level, asked.model)
            own = urban_passes(region, camera, height_m, *where, method, seed, here)
        except InfeasibleError as error:
            if region.required:
                raise
            refused = error
            rule = f"{NOT_SEEN}{error.constraint}"
            findings.append(Finding(error.feature, rule, error.message, error.relaxation, "warning"))
            continue
        left_m2 = unseen_m2(region, asked.airspace, level, own)
        if left_m2 > LEFT_PART * region.area.area:
            findings.append(_left(region.name, left_m2))
        passes += own
        here = own[-1].end
        progress("routing", 1.0 - len(waiting) / len(asked.regions))
    if not passes and refused is not None:
        raise refused
    return tuple(passes), tuple(findings)


def cut_by_obstacles(asked: Seeing) -> bool:
    """Whether all regions may be swept by cameras from any direction, and obstacles cut or stand in one."""
    if any(each.approach_rad is not None or each.revisits > 1 for each in asked.regions):
        return False
    if any(each.pattern not in ("auto", "lanes") for each in asked.regions):
        return False
    if not all(isinstance(asked.suite.of(each), CameraSensor) for each in asked.regions):
        return False
    hulls = [(each, each.area.convex_hull) for each in asked.regions]
    return any(_open_ground(asked, each, hull).area < hull.area - LEAST_M2 for each, hull in hulls)


def lanes_cut(asked: Seeing) -> bool:
    """Whether obstacles stand in a region that a camera sees in lanes, whatever the other regions ask for."""
    return any(
        _open_ground(asked, each, each.area).area < each.area.area - LEAST_M2
        for each in asked.regions
        if each.pattern in ("auto", "lanes") and isinstance(asked.suite.of(each), CameraSensor)
    )


def refuse_filled(asked: Seeing) -> None:
    """Refuse a required region that obstacles leave no ground of to fly over, turns left aside.

    Raises
    ------
    InfeasibleError
        With the height that passes over them, where there is one.
    """
    for region in asked.regions:
        if not region.required or not isinstance(asked.suite.of(region), CameraSensor):
            continue
        if _open_ground(asked, region, region.area).area >= LEAST_M2:
            continue
        level, clearance_m = asked.level.of(region), asked.airspace.clearance_m
        over_m = top_over(region.area, asked.airspace, level) - level.height_m + level.altitude_m
        raise InfeasibleError(
            "hard-zone",
            region.name,
            f"obstacles and zones, with their clearance of {clearance_m:g} m, fill it at this height",
            "fly elsewhere" if math.isinf(over_m) else f"fly higher: altitude_m of {math.ceil(over_m + 0.1)}",
            (region.area.centroid.x, region.area.centroid.y),
        )


def _open_ground(asked: Seeing, region: Region, area: BaseGeometry) -> BaseGeometry:
    margin_m = asked.airspace.clearance_m + TRANSIT_MARGIN_M
    return open_ground(area, asked.airspace, asked.level.of(region), margin_m)


def left_of(asked: Seeing, passes: tuple[CollectPass, ...]) -> tuple[Finding, ...]:
    """What is to be said of regions that passes leave ground of."""
    found = []
    for region in asked.regions:
        left_m2 = unseen_m2(region, asked.airspace, asked.level.of(region), passes)
        if left_m2 > LEFT_PART * region.area.area:
            found.append(_left(region.name, left_m2))
    return tuple(found)


def leaves_ground(findings: tuple[Finding, ...]) -> bool:
    """Whether findings of sweeps tell of ground or regions not seen."""
    return any(found.rule == BESIDE or found.rule.startswith(NOT_SEEN) for found in findings)


def _left(name: str, left_m2: float) -> Finding:
    return Finding(
        name,
        BESIDE,
        f"{left_m2:.0f} m² of it lie too near obstacles to be seen from free ground at this height",
        "Fly higher, cut what stands there out of it, or lower the clearance.",
        "warning",
    )
