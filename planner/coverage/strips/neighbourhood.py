"""Collection neighbourhoods (Definition 1, eq 20 of Li, Chen, Wang, Li 2018): every way to see a region."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage import decompose
from planner.coverage.lines import flown_straight, inside
from planner.coverage.merge import MergedRegion, split_region
from planner.coverage.strips.classify import STEP_RAD, Spans, angles_around, fits, hull_points, spans_at
from planner.coverage.strips.flyable import is_flyable
from planner.coverage.strips.headings import grid
from planner.coverage.strips.segments import Floats, Neighbourhood, too_wide
from planner.coverage.strips.sweeps import Sweep
from planner.errors import InfeasibleError
from planner.route import CollectPass
from planner.sensors.sar import SarSensor
from planner.sensors.strip import swaths_m
from planner.wishes import Region

#: η of the options when nobody asks for others: innermost, middle, outermost.
ETAS = (0.0, 0.5, 1.0)

_SAME_ANGLE_RAD = math.radians(0.01)


def neighbourhoods(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    step_rad: float = STEP_RAD,
    turns: Literal[0, 1] | None = None,
    *,
    anchored: bool = False,
) -> tuple[Neighbourhood, ...]:
    """N of eq 20, one a side the sensor can look to.

    Where approach directions are limited, Θ holds just these, and a region none of them sees in one pass is
    given two; the second needs the opposite direction allowed too.

    Parameters
    ----------
    turns
        k_t; by default the fewest turns possible (Definition 1).
    anchored
        Whether angles are counted from the region's narrowest edge, as the planner's own choice does, and not
        from the map's east, as in the paper.

    Raises
    ------
    InfeasibleError
        ``"swath"`` where no pair of passes sees the region at any angle, ``"approach"`` where only the limits
        on the direction forbid it.
    """
    points_m = hull_points(region.area)
    wanted = (turns,) if turns is not None else (0, 1)
    for count in wanted:
        angles_rad = _angles(region, step_rad, count, anchored)
        spans = spans_at(points_m, angles_rad)
        good = fits(spans.across_m, swaths_m(sensor, height_m, angles_rad), count)
        if good.any():
            chosen = Spans(spans.x_min_m[good], spans.x_max_m[good], spans.y_min_m[good], spans.y_max_m[good])
            return tuple(
                Neighbourhood(region, sensor, height_m, look, count, angles_rad[good], chosen)
                for look in sensor.looks
            )
    around_rad = angles_around(step_rad)
    around_m = spans_at(points_m, around_rad).across_m
    around_swaths_m = swaths_m(sensor, height_m, around_rad)
    if region.approach_rad is not None and fits(around_m, around_swaths_m, max(wanted)).any():
        raise InfeasibleError(
            "approach",
            region.label,
            "no allowed approach direction sees the whole region with at most two passes",
            "allow more directions in approach_deg, among them the opposites",
            region.centroid,
        )
    raise too_wide(region, sensor, height_m, float(around_m.min()))


def options(
    region: MergedRegion,
    sensor: SarSensor,
    height_m: float,
    etas: Sequence[float] = ETAS,
    step_rad: float = STEP_RAD,
    area: Polygon | None = None,
) -> Iterator[tuple[CollectPass, ...]]:
    """Every way to see a region: single passes, or pairs for a distributed one, angle by angle.

    Parameters
    ----------
    etas
        η of each pass; of pairs those with η₁ + η₂ ≤ 1.
    area
        The operating area: passes that leave it are left out (constraint c4, eq 9).
    """
    grid = np.asarray(etas, dtype=np.float64)
    for side in neighbourhoods(region, sensor, height_m, step_rad):
        first = inside(side.lines(grid), area)
        if side.turns == 0:
            for index, k in np.argwhere(first):
                yield (side.collect(int(index), float(grid[k])),)
            continue
        second = inside(side.lines(grid, opposite=True), area)
        partners = first[:, :, None] & second[:, None, :] & complementary(grid)
        for index, k, m in np.argwhere(partners):
            yield (
                side.collect(int(index), float(grid[k])),
                side.collect(int(index), float(grid[m]), opposite=True),
            )


def can_be_seen(
    region: Region,
    sensor: SarSensor,
    height_m: float,
    area: Polygon | None,
    step_rad: float = STEP_RAD,
    *,
    wide: bool = False,
    settle_m: float = 0.0,
) -> None:
    """Whether some choice of passes sees each part of a region from inside the operating area.

    Parameters
    ----------
    settle_m
        Straight flight before each pass, inside the area too.
    wide
        Whether sweeps of any number of lanes are allowed, of the whole or of divisions of it; without, the
        paper's one or two passes.

    Raises
    ------
    InfeasibleError
        Constraint ``"swath"``, ``"resolution"``, ``"approach"`` or ``"area"``, with the nearest relaxation.
    """
    check_sensor(region, sensor, height_m)
    if area is not None:
        shapely.prepare(area)
    for part in split_region(region):
        if wide and _can_be_swept(part, sensor, height_m, area, settle_m):
            continue
        least = neighbourhoods(part, sensor, height_m, step_rad, anchored=wide)
        # One pass may leave the area where two, further in, do not.
        if any(_some_inside(side, area, settle_m) for side in least):
            continue
        if least[0].turns == 0:
            try:
                two = neighbourhoods(part, sensor, height_m, step_rad, 1, anchored=wide)
                if any(_some_inside(side, area, settle_m) for side in two):
                    continue
            except InfeasibleError:
                pass
        raise InfeasibleError(
            "area",
            region.name,
            f"every pass that sees it leaves the operating area: the line runs "
            f"{sensor.near_m(height_m):.0f} m or more beside the region"
            + (f" and begins with {settle_m:.0f} m of straight flight" if settle_m > 0.0 else ""),
            "enlarge the area round the region, fly lower, or let the sensor look to both sides",
            part.centroid,
        )


def _can_be_swept(
    part: MergedRegion, sensor: SarSensor, height_m: float, area: Polygon | None, settle_m: float
) -> bool:
    """Whether the lanes of some sweep, of the whole or of each piece of some division, stay in the area."""
    if sensor.mode == "spotlight":
        return False
    whole = (Sweep(part, sensor, height_m, 0, extra) for extra in (0, 1))
    if any(is_flyable(sweep, area, settle_m) for sweep in whole):
        return True
    return not decompose.is_plain(part.area) and any(
        all(
            is_flyable(Sweep(replace(part, area=piece), sensor, height_m), area, settle_m) for piece in pieces
        )
        for pieces in decompose.cuts(part.area)
    )


def check_sensor(region: Region, sensor: SarSensor, height_m: float) -> None:
    """Refuse a sensor that cannot give what the region asks for, at this height.

    Raises
    ------
    InfeasibleError
        ``"swath"`` for a beam that is not wholly on one side or a relief too great, ``"spotlight"`` for a
        region larger than the spot, ``"resolution"`` for one too coarse.
    """
    whole = sensor.whole()
    steepest_rad, flattest_rad = whole.steepest_rad, whole.flattest_rad
    if height_m <= 0.0 or steepest_rad < 0.0 or flattest_rad >= math.pi / 2.0 or flattest_rad <= steepest_rad:
        raise InfeasibleError(
            "swath",
            region.name,
            f"sensor {sensor.name} has no swath on one side of the track from {height_m:g} m",
            "keep the whole elevation beam between straight down and the horizon, and fly above the ground",
        )
    if sensor.swath_m(height_m) <= 0.0 < whole.swath_m(height_m):
        raise InfeasibleError(
            "swath",
            region.name,
            f"the margins of sensor {sensor.name} leave nothing of its swath of "
            f"{whole.swath_m(height_m):.0f} m from {height_m:.0f} m",
            "fly higher, or lower pointing_margin_deg or position_margin_m",
        )
    if sensor.swath_m(height_m) <= 0.0:
        raise InfeasibleError(
            "swath",
            region.name,
            f"its ground rises and falls by {2.0 * sensor.relief_m:.0f} m: from {height_m:.0f} m no strip "
            "has all of it in the beam",
            "fly higher, or divide the region by height",
        )
    across_m = 2.0 * float(shapely.minimum_bounding_radius(region.area))
    spot_m = max(sensor.spot_m(height_m), 0.0)
    if across_m > spot_m:
        raise InfeasibleError(
            "spotlight",
            region.name,
            f"it is {across_m:.0f} m across, the spot of {sensor.name}, margins left out, {spot_m:.0f} m",
            "use stripmap, fly higher, or make the region smaller",
        )
    if region.min_resolution_m is None:
        return
    if sensor.resolution_m is None or sensor.resolution_m > region.min_resolution_m:
        # A radar is asked for the finer of both.
        wish = "gsd_m" if region.gsd_m == region.min_resolution_m else "min_resolution_m"
        have = "no stated resolution" if sensor.resolution_m is None else f"{sensor.resolution_m:g} m"
        raise InfeasibleError(
            "resolution",
            region.name,
            f"{region.min_resolution_m:g} m is asked for, sensor {sensor.name} has {have}",
            f"use a camera or a radar with resolution_m up to {region.min_resolution_m:g}, or relax {wish}",
        )


def complementary(etas: Floats) -> NDArray[np.bool_]:
    """Which pairs of offsets leave no gap: η₂ ≤ 1 − η₁, shape (K, K)."""
    return etas[:, None] + etas[None, :] <= 1.0 + 1e-12


def _some_inside(side: Neighbourhood, area: Polygon | None, settle_m: float) -> bool:
    for count in (3, 21):
        grid = np.linspace(0.0, 1.0, count)
        first = inside(flown_straight(side.lines(grid), settle_m), area)
        if side.turns == 0:
            if first.any():
                return True
            continue
        second = inside(flown_straight(side.lines(grid, opposite=True), settle_m), area)
        if (first[:, :, None] & second[:, None, :] & complementary(grid)).any():
            return True
    return False


def _angles(region: MergedRegion, step_rad: float, turns: int, anchored: bool) -> Floats:
    if region.approach_rad is None:
        return grid(region.area, step_rad) if anchored else angles_around(step_rad)
    allowed = np.unique(np.mod(np.asarray(region.approach_rad, dtype=np.float64), 2.0 * math.pi))
    if turns == 0:
        return allowed
    apart = np.abs(np.mod(allowed[:, None] + math.pi - allowed[None, :] + math.pi, 2.0 * math.pi) - math.pi)
    paired: Floats = allowed[(apart <= _SAME_ANGLE_RAD).any(axis=1)]
    return paired
