"""Regions among obstacles by footprint sweeps, in the order of the method that was asked for by name."""

from __future__ import annotations

import math

import shapely
from shapely.geometry import Point
from shapely.geometry.base import BaseGeometry

from planner.airspace.built import bare_ground
from planner.airspace.shapes import banded_shapes
from planner.airspace.zones import TRANSIT_MARGIN_M
from planner.coverage.merge import polygons_of
from planner.coverage.urban.regions import (
    camera_of,
    open_ground,
    top_over,
    unseen_m2,
    unseen_of,
    urban_passes,
)
from planner.coverage.visible import Seeing
from planner.errors import Finding, InfeasibleError
from planner.progress import Progress, Stop, raise_if
from planner.route import CollectPass
from planner.sensors.camera import CameraSensor
from planner.tasks.hidden import Sight
from planner.tasks.setting import Setting
from planner.tasks.task import NOT_SEEN
from planner.wishes import Region

#: More of a region than this part left unseen is told.
LEFT_PART = 1e-5
#: Less ground than this is none.
LEAST_M2 = 1.0
#: Ground unseen no farther from a zone than this is its own.
LEAST_AROUND_M = 0.5
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
        clearance_m = asked.airspace.clearance_m
        raise InfeasibleError(
            "hard-zone",
            region.name,
            f"obstacles and zones, with their clearance of {clearance_m:g} m, fill it at this height",
            _higher(asked, region) or "fly elsewhere",
            (region.area.centroid.x, region.area.centroid.y),
        )


def _higher(asked: Seeing, region: Region) -> str | None:
    """At which altitude all in the way is passed over, and what ceiling that takes; None where at none."""
    level = asked.level.of(region)
    over_m = top_over(region.area, asked.airspace, level)
    if math.isinf(over_m):
        return None
    said = f"fly higher: altitude_m of {math.ceil(over_m - level.height_m + level.altitude_m + 0.1)}"
    if asked.max_height_m is not None and over_m > asked.max_height_m:
        said += f", with max_height_m raised to {math.ceil(over_m + 1.1)}"
    return said


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


def unflown(asked: Seeing, passes: tuple[CollectPass, ...]) -> tuple[Finding, ...]:
    """What is to be said of regions that no pass is over."""
    over = {name for each in passes for name in each.regions}
    return tuple(
        Finding(
            region.name,
            f"{NOT_SEEN}hard-zone",
            "lies too near obstacles for any pass that sees some of it at this height",
            "Fly higher, or lower the clearance.",
            "warning",
        )
        for region in asked.regions
        if region.name not in over
    )


def refuse_unseen(
    asked: Seeing, passes: tuple[CollectPass, ...], findings: tuple[Finding, ...], sight: Sight | None
) -> None:
    """Refuse a required region of which sweeps leave ground beside what may not be flown over.

    What can be seen of others is flown; a warning tells the rest.

    Raises
    ------
    InfeasibleError
        With the zones, the share unseen, and what would work.
    """
    told = {found.feature for found in findings if found.rule == BESIDE}
    for region in asked.regions:
        if not region.required or region.name not in told:
            continue
        if sight is not None and region.over_ground_m is None and region.name not in sight.unseen(passes):
            # Laid for the highest ground, photos see more of the real one.
            continue
        raise _unseen(asked, region, unseen_of(region, asked.airspace, asked.level.of(region), passes))


def refuse_out_of_sight(asked: Seeing) -> None:
    """Refuse a required region of which ground lies farther from where one may fly than any photo reaches.

    What sweeps leave besides, planning finds.

    Raises
    ------
    InfeasibleError
        As ``refuse_unseen``, of what is unseen at least.
    """
    for region in asked.regions:
        camera = asked.suite.of(region)
        if not region.required or not isinstance(camera, CameraSensor):
            continue
        level = asked.level.of(region)
        sensor, height_m = asked.suite.over(region.sensor, region.area, asked.airspace, level)
        assert isinstance(sensor, CameraSensor)
        optics = sensor.optics
        ahead_rad = min(optics.half_height_rad + abs(sensor.tilt_rad), math.radians(89.0))
        # Turned by crab or not: no corner of a photo is farther.
        reach_m = (height_m + sensor.relief_m) * math.hypot(
            math.tan(ahead_rad), math.tan(optics.half_width_rad) / math.cos(ahead_rad)
        )
        beside: BaseGeometry = region.area.convex_hull.buffer(reach_m)
        if asked.airspace.area is not None:
            beside = shapely.intersection(beside, asked.airspace.area, grid_size=1e-6)
        room = open_ground(beside, asked.airspace, level, asked.airspace.clearance_m)
        ground = bare_ground(region.area, asked.airspace, level)
        left: BaseGeometry = shapely.difference(ground, room.buffer(reach_m), grid_size=1e-6)
        if left.area > max(LEFT_PART * region.area.area, LEAST_M2):
            raise _unseen(asked, region, left, least=True)


def _unseen(asked: Seeing, region: Region, left: BaseGeometry, *, least: bool = False) -> InfeasibleError:
    """What is said of ground that is left, which is not all of it where it is the ``least``."""
    airspace, level = asked.airspace, asked.level.of(region)
    solid = {
        banded.shape.name: banded.shape.polygon()
        for banded in banded_shapes(airspace, level.amsl_m - level.height_m)
        if banded.hard and banded.counts(*level.counted_m)
    }
    names, around_m = [], 0.0
    for part in sorted(polygons_of(left), key=lambda each: -each.area):
        name = min(solid, key=lambda each: float(solid[each].distance(part)))
        names += [name] if name not in names else []
        corners = shapely.points(shapely.get_coordinates(part))
        around_m = max(around_m, float(shapely.distance(corners, solid[name]).max()))
    share = left.area / bare_ground(region.area, airspace, level).area
    which = " and ".join(names) if len(names) < 3 else f"{', '.join(names[:2])} and {len(names) - 2} more"
    higher = _higher(asked, region)
    fixes = [] if higher is None else [higher]
    those = "it" if len(names) == 1 else "them"
    ring = f" with {math.ceil(around_m)} m round {those}" if around_m > LEAST_AROUND_M else ""
    # How much that is the flight decides: some sweeps have no room for the turns between them.
    fixes += [f"cut {which}{ring} out of it", "set required: false, and what can be flown is seen"]
    middle = left.representative_point()
    most = "at least " if least else ""
    return InfeasibleError(
        "hard-zone",
        region.name,
        f"{most}{_percent(share)} of it ({left.area:.0f} m²) is seen by no pass that keeps out of hard "
        f"{'zone' if len(names) == 1 else 'zones'} {which} with {airspace.clearance_m:g} m of clearance "
        f"and {TRANSIT_MARGIN_M:g} m that lines keep besides",
        ", or ".join(fixes),
        (middle.x, middle.y),
    )


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %" if share >= 0.001 else f"{100.0 * share:.3f} %"


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
