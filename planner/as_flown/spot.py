"""The spot of a spotlight pass, where the beam dwelt on it long enough."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.as_flown.ground import Judged, Stretch
from planner.as_flown.limits import MAX_OFF_LINE_M, look_range_rad
from planner.sensors import spot
from planner.sensors.aim import aim_drop_m, spot_ahead_m, spot_half_m
from planner.sensors.view import seen_beside

Floats = NDArray[np.float64]

#: Places of a track are known to a digit, and so is the angle it turned round a spot.
TURNED_PART = 1.0 - 1e-3


def judged_spot(stretch: Stretch) -> Judged:
    """What a spotlight pass saw.

    The beam is kept on the place the line was laid for. It holds it while the place's look angle, bank
    included, is between the beam's edges; the longest such stretch counts, if it is straight and the corners
    of the spot are resolved from its first place to its last. Ground is seen where the edges held it all the
    way. Pitch and yaw are what a steered beam makes up for.
    """
    sensor = stretch.sensor
    assert sensor.turned_rad is not None
    none = np.zeros(len(stretch.places), dtype=bool)
    first, last = stretch.line
    length_m = math.dist(first, last)
    ahead = (last - first) / length_m
    side = np.array([ahead[1], -ahead[0]]) * stretch.sign
    mean_m = float(stretch.height_m.mean())
    if stretch.ground is not None:

        def places(along_m: Floats, out_m: Floats) -> Floats:
            found: Floats = first + along_m[:, None] * ahead + out_m[:, None] * side
            return found

        level_m = mean_m + stretch.home_amsl_m
        mean_m = aim_drop_m(sensor, places, length_m, level_m, stretch.ground)
    near_m, far_m = (mean_m * math.tan(edge) for edge in (sensor.steepest_rad, sensor.flattest_rad))
    middle_m, half_m = 0.5 * length_m + spot_ahead_m(sensor, mean_m), spot_half_m(sensor, mean_m)
    place = first + middle_m * ahead + mean_m * math.tan(sensor.incidence_rad) * side
    drop_m = (
        stretch.height_m
        if stretch.ground is None
        else stretch.height_m + stretch.home_amsl_m - _height(stretch, place)
    )
    look_rad = np.arctan2((place - stretch.places) @ side, drop_m) + stretch.banked_rad
    half_rad = sensor.elevation_beamwidth_rad / 2.0
    run = _longest(np.abs(look_rad - sensor.incidence_rad) <= half_rad)
    if run is None:
        return Judged((), none, "out-of-range")
    chord = stretch.places[run.stop - 1] - stretch.places[run.start]
    across = np.array([chord[1], -chord[0]]) / max(float(np.hypot(*chord)), 1e-9)
    if float(np.abs((stretch.places[run] - stretch.places[run.start]) @ across).max()) > MAX_OFF_LINE_M:
        return Judged((), none, "not-straight")
    ends = [run.start, run.stop - 1]
    at_m, out_m = ((stretch.places[ends] - first) @ axis for axis in (ahead, side))
    wanted = spot.sine_wanted(sensor.turned_rad, sensor.squint_rad) * TURNED_PART
    for along_m, away_m in product((middle_m - half_m, middle_m + half_m), (near_m, far_m)):
        sines = (at_m - along_m) / np.sqrt((at_m - along_m) ** 2 + (away_m - out_m) ** 2 + drop_m[ends] ** 2)
        if sines[1] - sines[0] < wanted:
            return Judged((), none, "too-short")
    looks = look_range_rad(sensor, float(stretch.height_m[run].mean()), float(stretch.planned_m[run].mean()))
    if looks is None:
        return Judged((), none, "out-of-range")
    edges_rad = [
        np.clip(sensor.incidence_rad + off - stretch.banked_rad[run], *looks) for off in (-half_rad, half_rad)
    ]
    near_tan, far_tan = (np.tan(edge) for edge in edges_rad)
    beside_m = (stretch.places[run] - first) @ side
    counted = none.copy()
    counted[run] = True
    if stretch.ground is None:
        low_m = float((beside_m + near_tan * drop_m[run]).max())
        high_m = float((beside_m + far_tan * drop_m[run]).min())
        if low_m >= high_m:
            return Judged((), none, "out-of-range")
        at = [(middle_m - half_m, low_m), (middle_m + half_m, low_m), (middle_m + half_m, high_m)]
        corners = [first + x * ahead + y * side for x, y in [*at, (middle_m - half_m, high_m)]]
        return Judged((Polygon(corners),), counted, "too-short")
    # Hidden ground is that hidden from the middle of the stretch.
    foot = first + (0.5 * length_m) * ahead + float(beside_m.mean()) * side
    pose = np.concatenate([foot, ahead, side])
    level_m = float(stretch.height_m[run].mean()) + stretch.home_amsl_m
    edges = (float(near_tan.max()), float(far_tan.min()))
    if edges[0] >= edges[1]:
        return Judged((), none, "out-of-range")
    squint, ahead_m = math.tan(sensor.squint_rad), middle_m - 0.5 * length_m
    seen = seen_beside(pose, half_m, level_m, edges, squint, stretch.ground, ahead_m=ahead_m)
    return Judged(tuple(seen), counted, "too-short")


def _longest(held: NDArray[np.bool_]) -> slice | None:
    """The longest run of samples that hold, of two at least."""
    turns = np.flatnonzero(np.diff(np.concatenate([[0], held.astype(np.int8), [0]])))
    runs = [slice(int(a), int(b)) for a, b in zip(turns[::2], turns[1::2], strict=True) if b - a > 1]
    return max(runs, key=lambda run: run.stop - run.start) if runs else None


def _height(stretch: Stretch, place: Floats) -> float:
    assert stretch.ground is not None
    height_m = float(stretch.ground.at(place[None, :])[0])
    return float(np.nanmean(stretch.ground.heights_m)) if math.isnan(height_m) else height_m
