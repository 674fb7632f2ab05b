"""Ground that one flown interval with the sensor on saw at full resolution."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import MultiPoint, Polygon

from planner.airspace.terrain import Ground
from planner.route import Look
from planner.sensors import spot, strip
from planner.sensors.aim import aim_drop_m, spot_ahead_m, spot_half_m
from planner.sensors.sar import SarSensor
from planner.sensors.view import seen_beside

Floats = NDArray[np.float64]

#: A beam lifted to within this of the horizon by bank sees no farther.
MAX_LOOK_RAD = math.radians(85.0)
#: Footprints are built of slices this long along the track.
SLICE_M = 10.0
#: Places of a track are known to a digit, and so is the angle it turned round a spot.
TURNED_PART = 1.0 - 1e-3


@dataclass(frozen=True, slots=True)
class Flown:
    """An interval as it was flown, in the local frame; one row a sample, N of them.

    Parameters
    ----------
    sensor, look, line
        What looked where, in the scenario's wind, and the line it was meant to fly, (2, 2).
    places
        East and north, (N, 2).
    height_m
        Over the ground, on terrain over home, (N,).
    roll_rad
        Right wing down, (N,).
    nose_rad
        Where the nose points, NaN where unknown, (N,).
    ground, home_amsl_m
        Terrain, and home's height.
    """

    sensor: SarSensor
    look: Look
    line: Floats
    places: Floats
    height_m: Floats
    roll_rad: Floats
    nose_rad: Floats
    ground: Ground | None
    home_amsl_m: float

    @property
    def along_m(self) -> Floats:
        """Way flown up to each sample."""
        return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self.places, axis=0).T))])

    @property
    def banked_rad(self) -> Floats:
        """Right wing down turns a right-looking beam towards the nadir, a left-looking one to the horizon."""
        return self.roll_rad if self.look == "right" else -self.roll_rad


@dataclass(frozen=True, slots=True)
class _Slices:
    """Moments of an interval: places, unit vectors ahead and to the look side, heights, bank and yaw."""

    at_m: Floats
    centre: Floats
    ahead: Floats
    side: Floats
    height_m: Floats
    banked_rad: Floats
    yaw_rad: Floats


def ground_seen(flown: Flown) -> Iterator[Polygon]:
    """Ground seen, in pieces."""
    if flown.sensor.turned_rad is not None:
        yield from _spot(flown)
        return
    slices = _slices(flown)
    if slices is None:
        return
    yield from _on_flat(flown.sensor, slices) if flown.ground is None else _on_terrain(flown, slices)


def _slices(flown: Flown) -> _Slices | None:
    """From half an aperture after sensor on to half an aperture before sensor off; None where too short."""
    sensor, along_m, places = flown.sensor, flown.along_m, flown.places
    flown_rad = math.atan2(*(places[-1] - places[0])[::-1])
    yaw_rad = float(sensor.yaw_rad(flown_rad, flown.look))
    half_m = float(strip.aperture_m(sensor, float(flown.height_m.mean()), yaw_rad)) / 2.0
    if along_m[-1] <= 2.0 * half_m:
        return None
    count = max(2, math.ceil((along_m[-1] - 2.0 * half_m) / SLICE_M) + 1)
    at_m = np.linspace(half_m, along_m[-1] - half_m, count)

    def at(values: Floats, where_m: Floats = at_m) -> Floats:
        return np.asarray(np.interp(where_m, along_m, values), dtype=np.float64)

    centre = np.stack([at(places[:, k]) for k in (0, 1)], axis=1)
    ahead = np.stack(
        [at(places[:, k], at_m + half_m) - at(places[:, k], at_m - half_m) for k in (0, 1)], axis=1
    )
    ahead /= np.hypot(ahead[:, 0], ahead[:, 1])[:, None]
    sign = 1.0 if flown.look == "right" else -1.0
    side = np.stack([ahead[:, 1], -ahead[:, 0]], axis=1) * sign
    courses_rad = np.arctan2(ahead[:, 1], ahead[:, 0])
    yaw = sensor.yaw_rad(courses_rad, flown.look)
    if not sensor.stabilised and np.isfinite(flown.nose_rad).all():
        # What the nose was seen to do goes before what the wind should have made it do.
        nose = np.unwrap(flown.nose_rad)
        off_rad = np.array([_mean(along_m, nose, m - half_m, m + half_m) for m in at_m]) - courses_rad
        yaw = sign * (np.mod(off_rad + math.pi, math.tau) - math.pi)
    return _Slices(at_m, centre, ahead, side, at(flown.height_m), at(flown.banked_rad), yaw)


def _mean(along_m: Floats, values: Floats, low_m: float, high_m: float) -> float:
    """Mean over a stretch of the way."""
    at_m = np.linspace(low_m, high_m, 9)
    return float(np.interp(at_m, along_m, values).mean())


def _on_flat(sensor: SarSensor, here: _Slices) -> Iterator[Polygon]:
    """Quadrilaterals between one moment's rays and the next's."""
    edges = []
    cos, sin = np.cos(here.yaw_rad), np.sin(here.yaw_rad)
    for half_beam_rad in (-sensor.elevation_beamwidth_rad / 2.0, sensor.elevation_beamwidth_rad / 2.0):
        look_rad = np.clip(sensor.incidence_rad + half_beam_rad - here.banked_rad, 0.0, MAX_LOOK_RAD)
        beside_m = here.height_m * np.tan(look_rad)
        # A squinted beam sees ground at slant range R abeam R·tan ahead.
        lead_m = here.height_m / np.cos(look_rad) * math.tan(sensor.squint_rad)
        edges.append(
            here.centre
            + here.side * (beside_m * cos - lead_m * sin)[:, None]
            + here.ahead * (beside_m * sin + lead_m * cos)[:, None]
        )
    near, far = edges
    for (near0, far0), (near1, far1) in pairwise(zip(near, far, strict=True)):
        hull = MultiPoint([near0, near1, far1, far0]).convex_hull
        if isinstance(hull, Polygon):
            yield hull


def _on_terrain(flown: Flown, here: _Slices) -> Iterator[Polygon]:
    """The same on terrain, without what it hides: one slice half-way between each two places."""
    assert flown.ground is not None
    sensor = flown.sensor
    half_beam_rad = sensor.elevation_beamwidth_rad / 2.0
    values = (here.centre, here.ahead, here.side, here.height_m, here.banked_rad, here.yaw_rad)
    for k in range(len(here.at_m) - 1):
        middle, forward, outward, height_m, banked, yaw = [(v[k] + v[k + 1]) / 2.0 for v in values]
        near_tan, far_tan = _tangents(sensor, half_beam_rad, float(banked))
        # Neighbouring slices of a weaving track are to touch.
        half_m = float(here.at_m[k + 1] - here.at_m[k]) / 2.0 * 1.02
        pose = np.concatenate([middle, forward / np.hypot(*forward), outward / np.hypot(*outward)])
        squint, level_m = math.tan(sensor.squint_rad), float(height_m) + flown.home_amsl_m
        yield from seen_beside(pose, half_m, level_m, (near_tan, far_tan), squint, flown.ground, float(yaw))


def _tangents(sensor: SarSensor, half_beam_rad: float, banked_rad: float) -> tuple[float, float]:
    near_rad = sensor.incidence_rad - half_beam_rad - banked_rad
    far_rad = sensor.incidence_rad + half_beam_rad - banked_rad
    near_tan, far_tan = (math.tan(min(max(angle, 0.0), MAX_LOOK_RAD)) for angle in (near_rad, far_rad))
    return near_tan, far_tan


def _spot(flown: Flown) -> Iterator[Polygon]:
    """The spot of a spotlight pass, where the beam dwelt on it long enough.

    The beam is kept on the place the line was laid for. It holds it while the place's look angle, bank
    included, is between the beam's edges; the longest such stretch counts, if the corners of the spot are
    resolved from its first place to its last. Ground is seen where the edges held it all the way.
    """
    sensor = flown.sensor
    assert sensor.turned_rad is not None
    first, last = flown.line
    length_m = math.dist(first, last)
    ahead = (last - first) / length_m
    side = np.array([ahead[1], -ahead[0]]) * (1.0 if flown.look == "right" else -1.0)
    mean_m = float(flown.height_m.mean())
    if flown.ground is not None:

        def places(along_m: Floats, out_m: Floats) -> Floats:
            found: Floats = first + along_m[:, None] * ahead + out_m[:, None] * side
            return found

        level_m = mean_m + flown.home_amsl_m
        mean_m = aim_drop_m(sensor, places, length_m, level_m, flown.ground)
    near_m, far_m = (mean_m * math.tan(edge) for edge in (sensor.steepest_rad, sensor.flattest_rad))
    middle_m, half_m = 0.5 * length_m + spot_ahead_m(sensor, mean_m), spot_half_m(sensor, mean_m)
    place = first + middle_m * ahead + mean_m * math.tan(sensor.incidence_rad) * side
    drop_m = (
        flown.height_m if flown.ground is None else flown.height_m + flown.home_amsl_m - _height(flown, place)
    )
    look_rad = np.arctan2((place - flown.places) @ side, drop_m) + flown.banked_rad
    half_rad = sensor.elevation_beamwidth_rad / 2.0
    run = _longest(np.abs(look_rad - sensor.incidence_rad) <= half_rad)
    if run is None:
        return
    ends = [run.start, run.stop - 1]
    at_m, out_m = ((flown.places[ends] - first) @ axis for axis in (ahead, side))
    wanted = spot.sine_wanted(sensor.turned_rad, sensor.squint_rad) * TURNED_PART
    for along_m, away_m in product((middle_m - half_m, middle_m + half_m), (near_m, far_m)):
        sines = (at_m - along_m) / np.sqrt((at_m - along_m) ** 2 + (away_m - out_m) ** 2 + drop_m[ends] ** 2)
        if sines[1] - sines[0] < wanted:
            return
    tangents = np.array([_tangents(sensor, half_rad, float(bank)) for bank in flown.banked_rad[run]])
    beside_m = (flown.places[run] - first) @ side
    if flown.ground is None:
        low_m = float((beside_m + tangents[:, 0] * drop_m[run]).max())
        high_m = float((beside_m + tangents[:, 1] * drop_m[run]).min())
        if low_m < high_m:
            at = [(middle_m - half_m, low_m), (middle_m + half_m, low_m), (middle_m + half_m, high_m)]
            corners = [first + x * ahead + y * side for x, y in [*at, (middle_m - half_m, high_m)]]
            yield Polygon(corners)
        return
    # Hidden ground is that hidden from the middle of the stretch.
    foot = first + (0.5 * length_m) * ahead + float(beside_m.mean()) * side
    pose = np.concatenate([foot, ahead, side])
    level_m = float(flown.height_m[run].mean()) + flown.home_amsl_m
    edges = (float(tangents[:, 0].max()), float(tangents[:, 1].min()))
    if edges[0] < edges[1]:
        squint, ahead_m = math.tan(sensor.squint_rad), middle_m - 0.5 * length_m
        yield from seen_beside(pose, half_m, level_m, edges, squint, flown.ground, ahead_m=ahead_m)


def _longest(held: NDArray[np.bool_]) -> slice | None:
    """The longest run of samples that hold, of two at least."""
    turns = np.flatnonzero(np.diff(np.concatenate([[0], held.astype(np.int8), [0]])))
    runs = [slice(int(a), int(b)) for a, b in zip(turns[::2], turns[1::2], strict=True) if b - a > 1]
    return max(runs, key=lambda run: run.stop - run.start) if runs else None


def _height(flown: Flown, place: Floats) -> float:
    assert flown.ground is not None
    height_m = float(flown.ground.at(place[None, :])[0])
    return float(np.nanmean(flown.ground.heights_m)) if math.isnan(height_m) else height_m
