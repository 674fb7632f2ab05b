"""Ground that one flown stretch with the sensor on saw at full resolution: stripmap and ScanSAR.

A place is seen while the beam lay on it over a whole synthetic aperture (eqs 4 and 5 of Li et al. 2018). So
every moment of a stretch is looked at together with the half aperture before and behind it: the stretch must
be straight there, the antenna turned by no more than its beam, and of the ground only that counts which lay
between the beam's edges all the while. The edges are those of the antenna as it was turned: by roll, pitch
and, where it is fixed to the aircraft, by the nose.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import MultiPoint, Polygon

from planner.airspace.terrain import Ground
from planner.as_flown.limits import MAX_OFF_COURSE_RAD, MAX_OFF_LINE_M, look_range_rad
from planner.as_flown.passes import Reason
from planner.route import Look
from planner.sensors import strip
from planner.sensors.sar import SarSensor
from planner.sensors.view import seen_runs

Floats = NDArray[np.float64]

#: Moments of a stretch are this far apart.
MOMENT_M = 10.0
#: Ground of neighbouring moments overlaps by so much, or rounding would leave seams between.
SEAM_M = 1e-3


@dataclass(frozen=True, slots=True)
class Stretch:
    """A stretch as it was flown with the sensor on, in the local frame; one row a sample, N of them.

    Parameters
    ----------
    sensor, look, line
        What looked where, in the scenario's wind, and the line it was meant to fly, (2, 2).
    places
        East and north, all different from the one before, (N, 2).
    height_m, planned_m
        Over the ground, on terrain over home, as flown and as planned, (N,).
    roll_rad, pitch_rad
        Right wing down, nose up, (N,).
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
    planned_m: Floats
    roll_rad: Floats
    pitch_rad: Floats
    nose_rad: Floats
    ground: Ground | None
    home_amsl_m: float

    @property
    def along_m(self) -> Floats:
        """Way flown up to each sample."""
        return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self.places, axis=0).T))])

    @property
    def sign(self) -> float:
        """+1 where it looks right, −1 left."""
        return 1.0 if self.look == "right" else -1.0

    @property
    def banked_rad(self) -> Floats:
        """Right wing down turns a right-looking beam towards the nadir, a left-looking one to the horizon."""
        return self.sign * self.roll_rad


@dataclass(frozen=True, slots=True)
class _Moment:
    """A moment of a stretch that counts.

    Parameters
    ----------
    centre, ahead, side
        Where, and unit vectors along the line and to the look side.
    near_m, far_m
        Beside the line, between what the beam held ground over the aperture.
    near_lead_m, far_lead_m
        How far ahead of ``centre`` either lies.
    looks_rad, yaw_rad, lean_m, aside_m
        For terrain: the look angles held, the yaw, how far pitch leans the beam ahead, and how far the line
        weaved to the look side and away.
    """

    centre: Floats
    ahead: Floats
    side: Floats
    near_m: float
    far_m: float
    near_lead_m: float
    far_lead_m: float
    looks_rad: tuple[float, float]
    yaw_rad: float
    lean_m: float
    aside_m: tuple[float, float]
    height_m: float

    def at(self, out_m: float) -> Floats:
        """The place so far beside the line that the beam's middle lay on."""
        slope = (self.far_lead_m - self.near_lead_m) / (self.far_m - self.near_m)
        lead_m = self.near_lead_m + slope * (out_m - self.near_m)
        place: Floats = self.centre + self.side * out_m + self.ahead * lead_m
        return place


@dataclass(frozen=True, slots=True)
class Judged:
    """What of a stretch counts.

    Parameters
    ----------
    seen
        Ground, in pieces.
    counted
        Samples that are of an aperture that counts, (N,).
    reason
        Why the others do not count.
    """

    seen: tuple[Polygon, ...]
    counted: NDArray[np.bool_]
    reason: Reason


def judged(stretch: Stretch) -> Judged:
    """What a stretch saw."""
    along_m, sensor = stretch.along_m, stretch.sensor
    none = np.zeros(len(along_m), dtype=bool)
    course_rad = math.atan2(*(stretch.places[-1] - stretch.places[0])[::-1])
    yaw_rad = float(sensor.yaw_rad(course_rad, stretch.look))
    half_m = float(strip.aperture_m(sensor, float(stretch.height_m.mean()), yaw_rad)) / 2.0
    if not along_m[-1] > 2.0 * half_m > 0.0:
        return Judged((), none, "too-short")
    count = max(2, math.ceil((along_m[-1] - 2.0 * half_m) / MOMENT_M) + 1)
    at_m = np.linspace(half_m, along_m[-1] - half_m, count)
    windows = _Windows(stretch, along_m, half_m)
    moments = [windows.moment(float(m)) for m in at_m]
    counted = none.copy()
    pieces: list[Polygon] = []
    half_step_m = float(at_m[1] - at_m[0]) / 2.0
    for k in range(count - 1):
        before, after = moments[k], moments[k + 1]
        if isinstance(before, _Moment) and isinstance(after, _Moment):
            counted |= (along_m >= at_m[k] - half_m - 1e-6) & (along_m <= at_m[k + 1] + half_m + 1e-6)
            if stretch.ground is None:
                pieces += _between(before, after)
            else:
                pieces += _on_terrain(stretch, before, after, half_step_m)
    wrong = [moment for moment in moments if not isinstance(moment, _Moment)]
    return Judged(tuple(pieces), counted, wrong[0] if wrong else "too-short")


class _Windows:
    """Apertures of a stretch, whole by whole."""

    def __init__(self, stretch: Stretch, along_m: Floats, half_m: float) -> None:
        self._stretch, self._along_m, self._half_m = stretch, along_m, half_m
        self._nose = np.unwrap(stretch.nose_rad) if np.isfinite(stretch.nose_rad).all() else None
        first, last = stretch.line
        self._planned_rad = math.atan2(*(last - first)[::-1])

    def moment(self, at_m: float) -> _Moment | Reason:
        """The moment in the middle of an aperture; why not, where that does not count."""
        flown, sensor = self._stretch, self._stretch.sensor
        low_m, high_m = max(at_m - self._half_m, 0.0), min(at_m + self._half_m, float(self._along_m[-1]))
        first, after = np.searchsorted(self._along_m, [low_m, high_m], side="right")
        inner = slice(int(first), int(after))
        rows_m = np.concatenate([[low_m], self._along_m[inner], [high_m]])

        def over(values: Floats) -> Floats:
            ends = np.interp([low_m, high_m], self._along_m, values)
            return np.concatenate([ends[:1], values[inner], ends[1:]])

        places = np.stack([over(flown.places[:, k]) for k in (0, 1)], axis=1)
        ahead = places[-1] - places[0]
        chord_m = float(np.hypot(*ahead))
        if chord_m <= 0.0:
            return "not-straight"
        ahead = ahead / chord_m
        side = flown.sign * np.array([ahead[1], -ahead[0]])
        centre = np.array([np.interp(at_m, self._along_m, flown.places[:, k]) for k in (0, 1)])
        course_rad = math.atan2(ahead[1], ahead[0])
        if abs(math.remainder(course_rad - self._planned_rad, math.tau)) > MAX_OFF_COURSE_RAD:
            return "no-planned-pass"
        aside_m = (places - centre) @ side
        chord_aside_m = (places - places[0]) @ side
        if float(np.abs(chord_aside_m).max()) > MAX_OFF_LINE_M:
            return "not-straight"
        height_m, planned_m = over(flown.height_m), over(flown.planned_m)
        looks = look_range_rad(sensor, float(height_m.max()), float(planned_m.min()))
        looks_low = look_range_rad(sensor, float(height_m.min()), float(planned_m.max()))
        if looks is None or looks_low is None:
            return "out-of-range"
        limits = max(looks[0], looks_low[0]), min(looks[1], looks_low[1])
        banked, pitch = over(flown.banked_rad), over(flown.pitch_rad)
        half_rad = sensor.elevation_beamwidth_rad / 2.0
        near_rad = np.maximum(sensor.incidence_rad - half_rad - banked, limits[0])
        far_rad = np.minimum(sensor.incidence_rad + half_rad - banked, limits[1])
        if (near_rad >= far_rad).any():
            return "out-of-range"
        yaw = self._yaw_rad(over, course_rad)
        near, far = (_ray(sensor, look, pitch, yaw) for look in (near_rad, far_rad))
        # The beam of every pulse has to be on the place: it may turn by half its width to either side.
        middle = _ray(sensor, (near_rad + far_rad) / 2.0, pitch, yaw)
        turned_rad = np.arctan2(middle[0], np.hypot(1.0, middle[1]))
        if float(np.ptp(turned_rad)) > sensor.azimuth_beamwidth_rad:
            return "not-straight"
        near_m = float((aside_m + height_m * near[1]).max())
        far_m = float((aside_m + height_m * far[1]).min())
        if near_m >= far_m:
            return "out-of-range"
        weights = np.gradient(rows_m) if len(rows_m) > 2 else np.ones(len(rows_m))

        def mean(values: Floats) -> float:
            return float(np.average(values, weights=np.maximum(weights, 1e-9)))

        return _Moment(
            centre, ahead, side, near_m, far_m,
            mean(height_m * near[0]), mean(height_m * far[0]),
            (float(near_rad.max()), float(far_rad.min())), mean(yaw), mean(height_m * np.tan(pitch)),
            (float(aside_m.max()), float(aside_m.min())), mean(height_m),
        )  # fmt: skip

    def _yaw_rad(self, over: Callable[[Floats], Floats], course_rad: float) -> Floats:
        """How far the antenna is turned forward off abeam of the course, at each place."""
        flown = self._stretch
        if flown.sensor.stabilised or self._nose is None:
            values = over(np.zeros(len(self._along_m)))
            return np.asarray(values + float(flown.sensor.yaw_rad(course_rad, flown.look)))
        # What the nose was seen to do goes before what the wind should have made it do.
        off_rad = over(self._nose) - course_rad
        return np.asarray(flown.sign * (np.mod(off_rad + math.pi, math.tau) - math.pi))


def _ray(sensor: SarSensor, look_rad: Floats, pitch_rad: Floats, yaw_rad: Floats) -> tuple[Floats, Floats]:
    """How far ahead and how far to the look side a ray meets flat ground, for each metre it drops.

    The look angle is across the aircraft, bank taken off; squint is along it; pitch turns the ray about the
    wings, and yaw about the vertical.
    """
    ahead = math.tan(sensor.squint_rad) / np.cos(look_rad)
    out = np.tan(look_rad)
    down = np.maximum(np.cos(pitch_rad) - ahead * np.sin(pitch_rad), 1e-6)
    ahead, out = (ahead * np.cos(pitch_rad) + np.sin(pitch_rad)) / down, out / down
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    return ahead * cos + out * sin, out * cos - ahead * sin


def _between(before: _Moment, after: _Moment) -> Iterator[Polygon]:
    """Ground between two moments next to each other: what the beam held at both."""
    near_m, far_m = max(before.near_m, after.near_m), min(before.far_m, after.far_m)
    if near_m >= far_m:
        return
    yield from _spanned(before, after, (near_m, far_m))


def _spanned(before: _Moment, after: _Moment, outs_m: tuple[float, float]) -> Iterator[Polygon]:
    """Between two moments, from one distance beside the line to another.

    Neighbours share the line that the beam lay on at a moment, whatever the antenna does between.
    """
    seam = np.array([-SEAM_M * before.ahead, SEAM_M * after.ahead])
    places = [here.at(out_m) + seam[k] for k, here in enumerate((before, after)) for out_m in outs_m]
    hull = MultiPoint(places).convex_hull
    if isinstance(hull, Polygon):
        yield hull


def _on_terrain(stretch: Stretch, before: _Moment, after: _Moment, half_m: float) -> Iterator[Polygon]:
    """The same on terrain, without what it hides: one slice half-way between each two moments.

    The slice lies along the beam, yaw included, not abeam.
    """
    assert stretch.ground is not None
    near_rad = max(before.looks_rad[0], after.looks_rad[0])
    far_rad = min(before.looks_rad[1], after.looks_rad[1])
    if near_rad >= far_rad:
        return
    values = [
        (one + other) / 2.0
        for one, other in (
            (before.ahead, after.ahead),
            (before.side, after.side),
            (before.centre, after.centre),
        )
    ]
    ahead, side, centre = values
    height_m = (before.height_m + after.height_m) / 2.0
    lean_m, yaw_rad = (before.lean_m + after.lean_m) / 2.0, (before.yaw_rad + after.yaw_rad) / 2.0
    ahead, side = ahead / np.hypot(*ahead), side / np.hypot(*side)
    out_m, back_m = max(before.aside_m[0], after.aside_m[0]), min(before.aside_m[1], after.aside_m[1])
    edges = (math.tan(near_rad) + out_m / height_m, math.tan(far_rad) + back_m / height_m)
    if edges[0] >= edges[1]:
        return
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    turned = cos * ahead - sin * side, cos * side + sin * ahead
    foot = centre + lean_m * turned[0]
    squint, level_m = math.tan(stretch.sensor.squint_rad), height_m + stretch.home_amsl_m
    pose = np.concatenate([foot, *turned])
    lead_m, runs = seen_runs(pose, half_m, level_m, edges, squint, stretch.ground)
    for low_m, high_m in runs:
        ends = [foot + lead_m * turned[0] + out_m * turned[1] - centre for out_m in (low_m, high_m)]
        yield from _spanned(before, after, (float(ends[0] @ side), float(ends[1] @ side)))
