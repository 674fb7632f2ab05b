"""Ground really seen by a pass: on flat ground in closed form, on terrain cell by cell.

A place at slant range R abeam is seen at full resolution while the aircraft is within half an aperture of the
spot from which the beam, squint included, lies on it; so the ground seen in a pass of length l is, at each
distance from the track, [l_s/2 + R tan θ_sq, l − l_s/2 + R tan θ_sq] along it. Across, it lies between the
beam's edges, without what is in shadow or layover. An antenna fixed to the aircraft turns with the crab; see
``strip``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.affinity import affine_transform
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.airspace.terrain import Ground
from planner.route import Look
from planner.sensors import spot, strip, view_kernels, visibility_kernels
from planner.sensors.aim import aim_drop_m, spot_ahead_m, spot_half_m
from planner.sensors.base import SeenGround
from planner.sensors.sar import SarSensor

Floats = NDArray[np.float64]

#: Points on each edge of a squinted footprint.
EDGE_POINTS = 17
#: Cells along and across a strip.
MOST_CELLS = 300
#: What an option costs whose view of the region is all hidden, and a share of it for a share.
HIDDEN_M = 100_000.0
#: Any hidden ground at all costs this: such a pass does not cover its region.
SOME_HIDDEN_M = 5_000.0


def seen_on_flat(sensor: SarSensor, line_m: ArrayLike, look: Look, height_m: float) -> Polygon:
    """Ground seen from a line (2, 2) at a height over flat ground; empty where the line is too short."""
    sensor = sensor.whole()
    frame = _Axes.of(line_m, look)
    yaw_rad = float(sensor.yaw_rad(frame.course_rad, look))
    near_tan, far_tan = _edges_tan(sensor, yaw_rad)
    squinted = sensor.squint_rad != 0.0
    out_m = np.linspace(height_m * near_tan, height_m * far_tan, EDGE_POINTS if squinted else 2)
    drops_m = np.full(len(out_m), height_m)
    first_m, last_m = _dwell(sensor, frame.length_m, out_m, drops_m, yaw_rad, height_m)
    if (first_m >= last_m).any():
        return Polygon()
    ring = np.concatenate([np.stack([first_m, out_m], axis=1), np.stack([last_m, out_m], axis=1)[::-1]])
    return Polygon(frame.places(*ring.T))


def seen_on_terrain(
    sensor: SarSensor, line_m: ArrayLike, look: Look, level_m: float, ground: Ground
) -> SeenGround:
    """Ground seen from a line (2, 2) flown at a level over the ground's datum."""
    frame = _Axes.of(line_m, look)
    yaw_rad = float(sensor.yaw_rad(frame.course_rad, look))
    near_tan, far_tan = _edges_tan(sensor.whole(), yaw_rad)
    lowest_m = _lowest(ground, frame, level_m, far_tan)
    if math.isnan(lowest_m):
        return SeenGround(Polygon(), 0.0, 0.0)
    out_edges = _edges(0.0, (level_m - lowest_m) * far_tan, ground.step_m)
    out_m = (out_edges[:-1] + out_edges[1:]) / 2.0
    farthest = strip.lead_m(sensor.squint_rad, yaw_rad, [0.0, out_edges[-1]], level_m - lowest_m)
    reach_m = float(np.abs(farthest).max())
    along_edges = _edges(-reach_m, frame.length_m + reach_m, ground.step_m)
    along_m = (along_edges[:-1] + along_edges[1:]) / 2.0
    flags, heights = view_kernels.strip_flags(
        ground.heights_m,
        ground.west_m,
        ground.south_m,
        ground.step_m,
        frame.pose,
        along_m,
        out_m,
        level_m,
        near_tan,
        far_tan,
        math.tan(sensor.squint_rad),
        yaw_rad,
    )
    drop_m = level_m - heights
    visible = _visible_area(flags, along_edges, out_edges, out_m, drop_m, near_tan, far_tan)
    dwell = _dwell_area(sensor, frame, ground, level_m, out_edges, yaw_rad)
    inside = shapely.contains_xy(dwell, *np.meshgrid(along_m, out_m, indexing="ij"))
    cell_m2 = float((along_edges[1] - along_edges[0]) * (out_edges[1] - out_edges[0]))
    return SeenGround(
        frame.to_local(_areal(shapely.intersection(visible, dwell))),
        cell_m2 * float(np.count_nonzero(inside & (flags == view_kernels.SHADOW))),
        cell_m2 * float(np.count_nonzero(inside & (flags == view_kernels.LAYOVER))),
    )


def seen_beside(
    pose: Floats,
    half_along_m: float,
    level_m: float,
    edges_tan: tuple[float, float],
    squint: float,
    ground: Ground,
    ahead_m: float | None = None,
) -> list[Polygon]:
    """Ground seen at one moment of a flight, as wide along the track as half to either side.

    Parameters
    ----------
    pose
        East, north; unit vectors ahead and to the look side: float64 (6,).
    edges_tan
        Tangents of the look angles of the beam's edges, bank included.
    squint
        Tangent of the squint angle.
    ahead_m
        Where the middle of it lies along the track; None for where the squint has it.
    """
    middle_m, runs = seen_runs(pose, half_along_m, level_m, edges_tan, squint, ground, ahead_m)
    frame = _Axes(np.asarray(pose, dtype=np.float64), 2.0 * half_along_m)
    ends_m = middle_m - half_along_m, middle_m + half_along_m
    seen = _areal(shapely.union_all([shapely.box(ends_m[0], low, ends_m[1], high) for low, high in runs]))
    return [part for part in shapely.get_parts(frame.to_local(seen)) if isinstance(part, Polygon)]


def seen_runs(
    pose: Floats,
    half_along_m: float,
    level_m: float,
    edges_tan: tuple[float, float],
    squint: float,
    ground: Ground,
    ahead_m: float | None = None,
) -> tuple[float, list[tuple[float, float]]]:
    """How far ahead ground is seen at one moment of a flight, and from where to where beside the track.

    Parameters are those of ``seen_beside``.
    """
    frame = _Axes(np.asarray(pose, dtype=np.float64), 2.0 * half_along_m)
    near_tan, far_tan = edges_tan
    lowest_m = _lowest(ground, frame, level_m, far_tan)
    if math.isnan(lowest_m):
        return 0.0, []
    out_edges = _edges(0.0, (level_m - lowest_m) * far_tan, ground.step_m)
    out_m = (out_edges[:-1] + out_edges[1:]) / 2.0
    leads_m = strip.lead_m(math.atan(squint), 0.0, out_m, level_m - lowest_m)
    middle_m = float(leads_m[len(leads_m) // 2]) if ahead_m is None else ahead_m
    flags, heights = view_kernels.strip_flags(
        ground.heights_m, ground.west_m, ground.south_m, ground.step_m, frame.pose,
        np.array([middle_m]), out_m, level_m, near_tan, far_tan, squint, 0.0,
    )  # fmt: skip
    return middle_m, list(_runs(flags[0], out_edges, out_m, level_m - heights[0], near_tan, far_tan))


def shadow_cost(
    lines_m: Floats,
    look: Look,
    sensor: SarSensor,
    level_m: float,
    area: BaseGeometry,
    ground: Ground,
    places: int = 60,
) -> Floats:
    """What each of many lines costs for the part of a region it leaves in shadow or layover.

    Parameters
    ----------
    lines_m
        Shape (..., 2, 2): start and end.
    places
        How many places of the region are looked at, evenly spread.

    Returns
    -------
    ndarray
        float64 (...), metres: 0 where all of them are seen.
    """
    flat = np.asarray(lines_m, dtype=np.float64).reshape(-1, 2, 2)
    ahead = flat[:, 1] - flat[:, 0]
    ahead = ahead / np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    sign = 1.0 if look == "right" else -1.0
    poses = np.column_stack([flat[:, 0], ahead, sign * ahead[:, 1], -sign * ahead[:, 0]])
    yaw_rad = sensor.yaw_rad(np.arctan2(ahead[:, 1], ahead[:, 0]), look)
    near_tan, far_tan = (
        strip.edge_tan(sensor, edge_rad, yaw_rad)
        for edge_rad in (sensor.whole().steepest_rad, sensor.whole().flattest_rad)
    )
    hidden = visibility_kernels.line_visibility(
        ground.heights_m,
        ground.west_m,
        ground.south_m,
        ground.step_m,
        poses,
        # A little round the region besides: cells of the judge reach over its edge.
        spread(area.buffer(ground.step_m / 2.0, join_style="mitre"), places),
        max(ground.step_m / 2.0, 1.0),
        level_m,
        near_tan,
        far_tan,
        math.tan(sensor.squint_rad),
        yaw_rad,
    )
    cost_m: Floats = np.where(hidden > 0.0, SOME_HIDDEN_M + HIDDEN_M * hidden, 0.0)
    return cost_m.reshape(lines_m.shape[:-2])


def spread(area: BaseGeometry, count: int) -> Floats:
    """About ``count`` places on a square grid over an area, its corners besides; float64 (N, 2)."""
    west, south, east, north = area.bounds
    step_m = math.sqrt(max(area.area, 1e-6) / count)
    axes = [
        low + step_m * (np.arange(max(1, math.ceil((high - low) / step_m))) + 0.5)
        for low, high in ((west, east), (south, north))
    ]
    places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    inside = places[shapely.contains_xy(area, places[:, 0], places[:, 1])]
    return np.ascontiguousarray(
        np.concatenate([inside, shapely.get_coordinates(area.simplify(step_m / 4.0))])
    )


@dataclass(frozen=True, slots=True)
class _Axes:
    """Axes along a line and away from it to the look side."""

    pose: Floats
    length_m: float

    @classmethod
    def of(cls, line_m: ArrayLike, look: Look) -> _Axes:
        (east0, north0), (east1, north1) = np.asarray(line_m, dtype=np.float64)
        length_m = math.hypot(east1 - east0, north1 - north0)
        ahead = ((east1 - east0) / length_m, (north1 - north0) / length_m)
        side = (ahead[1], -ahead[0]) if look == "right" else (-ahead[1], ahead[0])
        return cls(np.array([east0, north0, *ahead, *side]), length_m)

    @property
    def course_rad(self) -> float:
        """Flight direction."""
        return math.atan2(self.pose[3], self.pose[2])

    def to_local(self, shape: Polygon | MultiPolygon) -> Polygon | MultiPolygon:
        """From (along, away) to east and north."""
        e, n, a_e, a_n, s_e, s_n = (float(value) for value in self.pose)
        moved: Polygon | MultiPolygon = affine_transform(shape, [a_e, s_e, a_n, s_n, e, n])
        return moved

    def places(self, along_m: Floats, out_m: Floats) -> Floats:
        """East and north of places along and away, (..., 2)."""
        e, n, a_e, a_n, s_e, s_n = self.pose
        return np.stack([e + along_m * a_e + out_m * s_e, n + along_m * a_n + out_m * s_n], axis=-1)


def _edges_tan(sensor: SarSensor, yaw_rad: float) -> tuple[float, float]:
    """Tangents of the beam's near and far edge beside the track."""
    near, far = (
        strip.edge_tan(sensor, sensor.steepest_rad, yaw_rad),
        strip.edge_tan(sensor, sensor.flattest_rad, yaw_rad),
    )
    return float(near), float(far)


def _dwell(
    sensor: SarSensor, length_m: float, out_m: Floats, drop_m: Floats, yaw_rad: float, aim_m: float
) -> tuple[Floats, Floats]:
    """From where to where along the line ground is seen at full resolution, at distances and drops (N,).

    ``aim_m`` is the drop to where a spotlight's beam is kept.
    """
    if sensor.turned_rad is not None:
        # The beam stays on the middle of the spot, the one seen squinted from the middle of the line.
        middle_m = length_m / 2.0 + spot_ahead_m(sensor, aim_m)
        half_m = spot_half_m(sensor, aim_m)
        wanted = spot.sine_wanted(sensor.turned_rad, sensor.squint_rad) * (1.0 - 1e-9)
        range_m, resolved = np.hypot(out_m, drop_m), np.ones(len(out_m), dtype=bool)
        for at_m in (middle_m - half_m, middle_m + half_m):
            resolved &= spot.sine_turned(-at_m, length_m - at_m, range_m) >= wanted
        # Outside the beam it does not matter: that is not seen.
        near, far = math.tan(sensor.steepest_rad), math.tan(sensor.flattest_rad)
        resolved |= (out_m < drop_m * near - 1e-6) | (out_m > drop_m * far + 1e-6)
        halves_m = np.where(resolved, half_m, -1.0)
        return middle_m - halves_m, middle_m + halves_m
    lead_m = strip.lead_m(sensor.squint_rad, yaw_rad, out_m, drop_m)
    aperture_m = strip.aperture_m(sensor, drop_m, yaw_rad)
    return aperture_m / 2.0 + lead_m, length_m - aperture_m / 2.0 + lead_m


def _dwell_area(
    sensor: SarSensor, frame: _Axes, ground: Ground, level_m: float, out_edges: Floats, yaw_rad: float
) -> Polygon | MultiPolygon:
    """Ground lit over a whole aperture, in the line's axes, the beam's edges aside."""
    aim_m = aim_drop_m(sensor, frame.places, frame.length_m, level_m, ground)
    ends = []
    for which in (0, 1):
        at_m = np.full(len(out_edges), 0.0 if which == 0 else frame.length_m)
        # The aperture depends on the ground where it ends: a few steps settle it to a centimetre.
        for _ in range(4):
            heights = ground.at(frame.places(at_m, out_edges))
            drop_m = level_m - np.where(np.isnan(heights), np.nanmean(ground.heights_m), heights)
            at_m = _dwell(sensor, frame.length_m, out_edges, drop_m, yaw_rad, aim_m)[which]
        ends.append(at_m)
    first_m, last_m = ends
    if (first_m >= last_m).all():
        return Polygon()
    last_m = np.maximum(first_m, last_m)
    ring = np.concatenate(
        [np.stack([first_m, out_edges], axis=1), np.stack([last_m, out_edges], axis=1)[::-1]]
    )
    return _areal(shapely.make_valid(Polygon(ring)))


def _visible_area(
    flags: NDArray[np.uint8],
    along_edges: Floats,
    out_edges: Floats,
    out_m: Floats,
    drop_m: Floats,
    near_tan: float,
    far_tan: float,
) -> Polygon | MultiPolygon:
    """Union of the cells seen; where a run of them ends at the beam's edge, it ends exactly there."""
    boxes = [
        shapely.box(along_edges[i], low_m, along_edges[i + 1], high_m)
        for i, row in enumerate(flags)
        for low_m, high_m in _runs(row, out_edges, out_m, drop_m[i], near_tan, far_tan)
    ]
    return _areal(shapely.union_all(boxes))


def _runs(
    flags: NDArray[np.uint8],
    out_edges: Floats,
    out_m: Floats,
    drop_m: Floats,
    near_tan: float,
    far_tan: float,
) -> Iterator[tuple[float, float]]:
    """From where to where one row of cells is seen."""
    turns = np.flatnonzero(
        np.diff(np.concatenate([[False], flags == view_kernels.SEEN, [False]]).astype(np.int8))
    )
    tangents = out_m / np.maximum(drop_m, 1e-9)
    for first, after in zip(turns[::2].tolist(), turns[1::2].tolist(), strict=True):
        yield (
            _run_end(tangents, out_m, first, first - 1, near_tan, far_tan, out_edges[first], flags),
            _run_end(tangents, out_m, after - 1, after, near_tan, far_tan, out_edges[after], flags),
        )


def _run_end(
    tangents: Floats,
    out_m: Floats,
    seen: int,
    other: int,
    near_tan: float,
    far_tan: float,
    middle_m: float,
    flags: NDArray[np.uint8],
) -> float:
    """Where a run of seen samples ends towards a neighbour: at the beam's edge, else half-way."""
    if not 0 <= other < len(out_m) or flags[other] != view_kernels.OUT or math.isnan(tangents[other]):
        return float(middle_m)
    edge_tan = near_tan if tangents[other] < near_tan else far_tan
    share = (edge_tan - tangents[seen]) / (tangents[other] - tangents[seen])
    return float(out_m[seen] + min(max(share, 0.0), 1.0) * (out_m[other] - out_m[seen]))


def _lowest(ground: Ground, frame: _Axes, level_m: float, far_tan: float) -> float:
    """Lowest ground where the strip may lie; it reaches farther over lower ground, so it is asked twice."""
    lowest_m = float(np.nanmin(ground.heights_m)) if np.isfinite(ground.heights_m).any() else math.nan
    if math.isnan(lowest_m) or lowest_m >= level_m:
        return math.nan
    far_m = (level_m - lowest_m) * far_tan
    along, out = np.meshgrid(
        np.linspace(0.0, frame.length_m, MOST_CELLS), np.linspace(0.0, far_m, MOST_CELLS), indexing="ij"
    )
    heights = ground.at(frame.places(along, out))
    return float(np.nanmin(heights)) - ground.step_m / 10.0 if np.isfinite(heights).any() else math.nan


def _edges(first_m: float, last_m: float, post_step_m: float) -> Floats:
    """Edges of cells from one place to another: three to a post, 40 to ``MOST_CELLS`` in all."""
    count = math.ceil((last_m - first_m) / (post_step_m / 3.0))
    return np.linspace(first_m, last_m, min(max(count, 40), MOST_CELLS) + 1)


def _areal(shape: shapely.Geometry) -> Polygon | MultiPolygon:
    parts = [part for part in shapely.get_parts(shape) if isinstance(part, Polygon) and part.area > 0.0]
    return parts[0] if len(parts) == 1 else MultiPolygon(parts)
