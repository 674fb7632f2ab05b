"""What photos really give of each region: overlaps, ground sampled distance, NIIRS; wishes not kept."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.airspace.built import bare_ground
from planner.airspace.shapes import hard_shapes
from planner.check.camera_print import nose_off_rad, photo_corners
from planner.check.coverage import UNSEEN_FRACTION, counts
from planner.check.photo_grid import Lane, Seen, look
from planner.check.photo_places import grid_over, subdivided
from planner.check.places import lonlat
from planner.plan import Collect, Photos, Plan, Surveyed, Violation
from planner.scenario import Scenario
from planner.sensors.camera import CameraSensor
from planner.wishes import Region

Floats = NDArray[np.float64]

#: Overlaps are kept to this part of a photo, quality to this part of itself: what places are rounded by.
OVERLAP_TOLERANCE, QUALITY_TOLERANCE = 0.002, 1e-4
#: Ways to see a region whose photos are no lanes beside each other: overlaps are not asked of them.
FIGURES = ("orbit", "spiral", "look")
#: More unseen places than this are no slivers of ground.
MOST_SLIVERS = 50
#: Photos may come this much sooner than the camera takes them: times are rounded.
INTERVAL_TOLERANCE = 0.01


def surveyed(scenario: Scenario, plan: Plan) -> tuple[dict[str, Surveyed], list[Violation]]:
    """Each region that a camera sees, and what of it is not as asked for."""
    photos = {(each.vehicle, each.seq): each for each in plan.photos}
    found: dict[str, Surveyed] = {}
    violations: list[Violation] = []
    for region in scenario.regions:
        sensor = scenario.sensor_for(region)
        if not isinstance(sensor, CameraSensor):
            continue
        collects = [each for each in plan.collects if counts(scenario, region, each)]
        lanes, others = (
            [
                _lane(scenario, sensor, each, photos.get((each.vehicle, each.seq)))
                for each in collects
                if (region.name in each.regions) == own
            ]
            for own in (True, False)
        )
        if not lanes:
            continue
        places_m = grid_over(bare_ground(region.area, scenario.airspace, scenario.level.of(region)))
        ground_m, flown_over_m = _ground(scenario, places_m)
        lanes, others = (
            [replace(lane, altitudes_m=lane.altitudes_m + flown_over_m) for lane in some]
            for some in (lanes, others)
        )
        seen = look(places_m, ground_m, lanes, sensor)
        unseen = seen.photos == 0
        if unseen.any() and others:
            # Where a region borders on another, photos of that one show its edge.
            lanes += others
            seen = seen.where(unseen, look(places_m[unseen], ground_m[unseen], lanes, sensor))
        slivers = _slivers(scenario, region, sensor, places_m, seen, lanes)
        places_m, seen = places_m[~slivers], seen.only(~slivers)
        found[region.name] = _measured(seen, sensor)
        violations += _violations(scenario, region, sensor, places_m, seen)
    violations += _too_soon(scenario, plan)
    return found, violations


def _lane(scenario: Scenario, sensor: CameraSensor, collect: Collect, photos: Photos | None) -> Lane:
    """The photos of a collect; between its ends a video."""
    places = collect.line if photos is None else photos.places
    places_m = scenario.frame.to_local([place[:2] for place in places])
    aircraft = next(a for a in scenario.aircraft if a.name == collect.vehicle)
    (east0, north0), (east1, north1) = places_m[0], places_m[-1]
    course_rad = math.atan2(north1 - north0, east1 - east0)
    off_rad = (
        0.0 if aircraft.hovers else nose_off_rad(sensor, course_rad, aircraft.airspeed_m_s, scenario.wind)
    )
    altitudes_m = np.array([place[2] for place in places])
    return Lane(places_m, altitudes_m, photo_corners(sensor, off_rad), photos is None)


def _ground(scenario: Scenario, places_m: Floats) -> tuple[Floats, float]:
    """Height of the ground at places, and what to add to the plan's altitudes to count over the same datum.

    Ground whose height is unknown lies as low as nothing is seen of it.
    """
    if scenario.terrain is None:
        return np.full(len(places_m), scenario.level.altitude_m - scenario.level.height_m), 0.0
    ground_m = scenario.terrain.at(places_m)
    return np.where(np.isnan(ground_m), np.inf, ground_m), scenario.level.amsl_m - scenario.level.altitude_m


def _slivers(
    scenario: Scenario,
    region: Region,
    sensor: CameraSensor,
    places_m: Floats,
    seen: Seen,
    lanes: list[Lane],
) -> NDArray[np.bool_]:
    """Places of the grid that no photo sees, if they lie in less ground than a region may leave unseen.

    A place stands for a square of the grid, which can be nearly all of it in view.
    """
    unseen = seen.photos == 0
    area = bare_ground(region.area, scenario.airspace, scenario.level.of(region))
    if not 0 < unseen.sum() <= MOST_SLIVERS:
        return np.zeros(len(places_m), dtype=np.bool_)
    fine_m, each_m2 = subdivided(area, places_m[unseen])
    if len(fine_m):
        finer = look(fine_m, _ground(scenario, fine_m)[0], lanes, sensor)
        if each_m2 * float((finer.photos == 0).sum()) > UNSEEN_FRACTION * area.area:
            return np.zeros(len(places_m), dtype=np.bool_)
    return np.asarray(unseen, dtype=np.bool_)


def _measured(seen: Seen, sensor: CameraSensor) -> Surveyed:
    held = seen.photos > 0
    if not held.any():
        return Surveyed(0.0, 0.0, 0, 0.0)
    worst_m, mean_m = float(np.nanmax(seen.worst_gsd_m)), float(np.nanmean(seen.gsd_m))
    niirs = niirs_mean = None
    if sensor.quality is not None:
        quality = sensor.quality
        niirs = quality.niirs(worst_m)
        # Linear in the logarithm of the distance.
        niirs_mean = quality.niirs(math.exp(float(np.nanmean(np.log(seen.gsd_m)))))
    return Surveyed(
        max(float(seen.forward.min()), 0.0),
        max(float(seen.side.min()), 0.0),
        int(seen.photos.min()),
        float(seen.photos.mean()),
        worst_m,
        mean_m,
        niirs,
        niirs_mean,
    )


def _violations(
    scenario: Scenario, region: Region, sensor: CameraSensor, places_m: Floats, seen: Seen
) -> Iterator[Violation]:
    def violation(
        constraint: str, message: str, amount: float, unit: str, at: int, *, hard: bool = True
    ) -> Violation:
        where = lonlat(scenario, places_m[at])
        return Violation(constraint, region.name, message, amount, unit, where, hard=hard and region.required)

    unseen = np.flatnonzero(seen.photos == 0)
    if len(unseen):
        share = len(unseen) / len(places_m)
        said = f"no photo sees {100.0 * share:.2f} % of {region.name}"
        yield violation("photo-coverage", said, share * region.area.area, "m2", int(unseen[0]))
    free = _free_of_obstacles(scenario, region, sensor, places_m)
    overlaps = (
        ("forward", sensor.forward_overlap, seen.forward),
        ("side", sensor.side_overlap, seen.side),
    )
    for word, asked, reached in () if region.pattern in FIGURES else overlaps:
        # Beside what may not be flown over no flight overlaps as asked: that is told, and no refusal.
        for where, hard in ((free, True), (~free, False)):
            worst = int(np.argmin(np.where((seen.photos > 0) & where, reached, np.inf)))
            short = asked - float(reached[worst])
            if not (seen.photos[worst] > 0 and where[worst] and short > OVERLAP_TOLERANCE):
                continue
            got = max(float(reached[worst]), 0.0)
            place = region.name if hard else f"ground of {region.name} beside obstacles"
            said = f"the {word} overlap over {place} comes down to {100.0 * got:.1f} %, asked for are"
            message = f"{said} {100.0 * asked:g} %"
            yield violation("overlap", message, min(short, asked), "", worst, hard=hard)
    if not (seen.photos > 0).any():
        return
    worst = int(np.nanargmax(seen.worst_gsd_m))
    gsd_m = float(seen.worst_gsd_m[worst])
    for wish, asked_m in (("gsd_m", region.gsd_m), ("min_resolution_m", region.min_resolution_m)):
        if asked_m is not None and gsd_m > asked_m * (1.0 + QUALITY_TOLERANCE):
            message = f"a pixel covers up to {100.0 * gsd_m:.2f} cm of {region.name}, {wish} is {asked_m:g}"
            yield violation("quality", message, gsd_m - asked_m, "m", worst)
    if region.min_niirs is not None and sensor.quality is not None:
        niirs = sensor.quality.niirs(gsd_m)
        if niirs < region.min_niirs - QUALITY_TOLERANCE:
            message = f"NIIRS over {region.name} comes down to {niirs:.2f}, min_niirs is {region.min_niirs:g}"
            yield violation("quality", message, region.min_niirs - niirs, "NIIRS", worst)


def _free_of_obstacles(
    scenario: Scenario, region: Region, sensor: CameraSensor, places_m: Floats
) -> NDArray[np.bool_]:
    """Which places lie so far from what may not be entered that lanes on all sides of them can be flown.

    A photo reaches half its diagonal; lanes end, or are turned from, as far from obstacles as clearance, a
    turn and the straight flight behind it take.
    """
    level = scenario.level.of(region)
    shapes = [shape.polygon() for shape in hard_shapes(scenario.airspace, level)]
    if not shapes:
        return np.ones(len(places_m), dtype=np.bool_)
    fleet = [aircraft.in_wind(scenario.wind.speed_m_s) for aircraft in scenario.aircraft]
    half_m = level.height_m * math.hypot(
        math.tan(sensor.optics.half_width_rad),
        math.tan(sensor.optics.half_height_rad) + math.tan(abs(sensor.tilt_rad)),
    )
    kept_m = half_m + max(each.ground_turn_radius_m + each.settle_m for each in fleet)
    beside, _ = shapely.STRtree(shapes).query(shapely.points(places_m), predicate="dwithin", distance=kept_m)
    free = np.ones(len(places_m), dtype=np.bool_)
    free[beside] = False
    return free


def _too_soon(scenario: Scenario, plan: Plan) -> Iterator[Violation]:
    """Photos that come sooner than the camera takes them, the worst of each camera."""
    collects = {(each.vehicle, each.seq): each for each in plan.collects}
    worst: dict[str, tuple[float, Collect]] = {}
    for photos in plan.photos:
        collect = collects[photos.vehicle, photos.seq]
        if len(photos.places) > 1:
            between_s = (collect.end_s - collect.start_s) / (len(photos.places) - 1)
            if between_s < worst.get(photos.sensor, (math.inf, collect))[0]:
                worst[photos.sensor] = (between_s, collect)
    for name, (between_s, collect) in worst.items():
        sensor = scenario.suite.named(name)
        if not isinstance(sensor, CameraSensor) or sensor.trigger == "video":
            continue
        if between_s < sensor.min_interval_s * (1.0 - INTERVAL_TOLERANCE):
            yield Violation(
                "photo-interval",
                name,
                f"collect {collect.seq} has a photo every {between_s:.2f} s, {name} takes one every "
                f"{sensor.min_interval_s:g} s at most",
                sensor.min_interval_s - between_s,
                "s",
                collect.line[0][:2],
            )
