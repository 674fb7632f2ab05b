"""Ground that the photos of one straight pass see together, on level ground and on terrain."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import shapely
from numpy.typing import ArrayLike, NDArray
from shapely.geometry import MultiPolygon, Polygon

from planner.airspace.terrain import Ground
from planner.sensors.base import SeenGround
from planner.sensors.camera import CameraSensor
from planner.sensors.photo_band import Band, band

Floats = NDArray[np.float64]

#: Rays along each end of what is seen on terrain, and the most along each side.
END_RAYS, MOST_SIDE_RAYS = 17, 2_000
#: A ray over terrain is looked at so many times on its way down, then halved.
LOOKS, HALVINGS = 64, 30


def seen_on_flat(sensor: CameraSensor, line_m: ArrayLike, height_m: float) -> Polygon:
    """Ground that all along a line some photo sees, photos as far apart as the forward overlap allows."""
    start, end, along, left = _axes(line_m)
    seen, (low, high) = _strip(sensor, _angle_rad(along))
    knots = [low, *(k for k in seen.knots if low < k < high), high]
    first = [start + height_m * (seen.span(k)[0] * along + k * left) for k in knots]
    last = [end + height_m * (seen.span(k)[1] * along + k * left) for k in reversed(knots)]
    return Polygon([*first, *last])


def seen_on_terrain(
    sensor: CameraSensor, line_m: ArrayLike, _look: Any, level_m: float | Floats, ground: Ground
) -> SeenGround:
    """The same over terrain: to where the rays at its edges first meet the ground; nothing where unknown.

    Parameters
    ----------
    level_m
        Altitude of the line; of places evenly along it, its ends among them, where it follows the ground.
    """
    start, end, along, left = _axes(line_m)
    seen, (low, high) = _strip(sensor, _angle_rad(along))
    knots = np.linspace(low, high, END_RAYS)
    spans = np.array([seen.span(float(k)) for k in knots])
    count = min(max(2, math.ceil(math.dist(start, end) / ground.step_m) + 1), MOST_SIDE_RAYS)
    stations = start + np.linspace(0.0, 1.0, count)[:, None] * (end - start)
    known_m = np.atleast_1d(np.asarray(level_m, dtype=np.float64))
    levels_m = np.interp(np.linspace(0.0, 1.0, count), np.linspace(0.0, 1.0, len(known_m)), known_m)
    first_m, last_m = (np.full(END_RAYS, levels_m[k]) for k in (0, -1))
    rings = []
    for origins, slopes, from_m in (
        (np.tile(start, (END_RAYS, 1)), spans[:, :1] * along + knots[:, None] * left, first_m),
        (stations, np.tile(spans[-1].mean() * along + high * left, (count, 1)), levels_m),
        (np.tile(end, (END_RAYS, 1)), spans[::-1, 1:] * along + knots[::-1, None] * left, last_m),
        (stations[::-1], np.tile(spans[0].mean() * along + low * left, (count, 1)), levels_m[::-1]),
    ):
        rings.append(_met(origins, slopes, from_m, ground))
    ring = np.concatenate(rings)
    if np.isnan(ring).any():
        return SeenGround(Polygon())
    area = shapely.make_valid(Polygon(ring))
    parts = [part for part in shapely.get_parts(area) if isinstance(part, Polygon)]
    return SeenGround(parts[0] if len(parts) == 1 else MultiPolygon(parts))


def _met(origins: Floats, slopes: Floats, levels_m: Floats, ground: Ground) -> Floats:
    """Where rays from some altitudes first meet the ground, (N, 2); NaN where that is not known.

    Parameters
    ----------
    origins, slopes
        (N, 2): places, and metres over the ground for each metre down.
    levels_m
        (N,).
    """
    deepest_m = float(levels_m.max() - np.nanmin(ground.heights_m))
    drops = np.linspace(0.0, deepest_m, LOOKS + 1)
    places = origins[:, None, :] + drops[None, :, None] * slopes[:, None, :]
    under = levels_m[:, None] - drops[None, :] <= ground.at(places)
    hit = under.any(axis=1)
    first = under.argmax(axis=1)
    below, over = drops[first], drops[np.maximum(first - 1, 0)]
    for _ in range(HALVINGS):
        middle = (below + over) / 2.0
        inside = levels_m - middle <= ground.at(origins + middle[:, None] * slopes)
        below, over = np.where(inside, middle, below), np.where(inside, over, middle)
    met: Floats = origins + over[:, None] * slopes
    met[~hit | np.isnan(ground.at(met))] = np.nan
    return met


def _strip(sensor: CameraSensor, angle_rad: float) -> tuple[Band, tuple[float, float]]:
    """A photo, and the part of its width in which photos leave no gap, from one metre up."""
    seen = band(sensor.optics, sensor.tilt_rad, sensor.crab_rad(angle_rad))
    edges = seen.strip(sensor.pattern(angle_rad).spacing)
    assert edges is not None
    return seen, edges


def _axes(line_m: ArrayLike) -> tuple[Floats, Floats, Floats, Floats]:
    start, end = np.asarray(line_m, dtype=np.float64)
    along = (end - start) / math.dist(start, end)
    return start, end, along, np.array([-along[1], along[0]])


def _angle_rad(along: Floats) -> float:
    return math.atan2(float(along[1]), float(along[0]))
