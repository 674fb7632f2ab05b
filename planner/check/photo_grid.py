"""Overlap and quality of photos, at places of a grid, from each photo's own place and height.

A place is seen by the photos of a lane along a stretch of the way, its *chord*; what part of the chord lies
between two photos is what they do not share. Of the strip that a lane's photos leave no gap in, the part that
lies between two lanes is what these do not share. A place that one photo alone sees, or one lane, counts as
if the next were as far from it on the other side; beside the outer lanes, and beyond the ends of lanes, of a
camera that need not keep its overlaps up to the edges it counts as shared enough.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from planner.sensors.camera import TWICE, CameraSensor

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Chords are measured at so many parts of a photo's width, and at its corners.
_CHORDS = 64
#: Lanes within this of each other's direction, or of its opposite, are neighbours.
PARALLEL_RAD = math.radians(2.0)
#: Lanes that lie within this of one line are one after the other.
SAME_TRACK_M = 0.5
#: Farther than any lane.
_LAST_M = 1e9


@dataclass(frozen=True, slots=True, eq=False)
class Lane:
    """Photos along one straight.

    Parameters
    ----------
    places_m, altitudes_m
        Of each photo, (N, 2) and (N,), in flight order, over the datum that the ground is told over.
    corners
        Of a photo from one metre up, (4, 2), counter-clockwise: ahead along the course and to its left.
    video
        Whether photos follow each other without end.
    """

    places_m: Floats
    altitudes_m: Floats
    corners: Floats
    video: bool = False

    @property
    def course_rad(self) -> float:
        """Of its flight."""
        east_m, north_m = self.places_m[-1] - self.places_m[0]
        return math.atan2(north_m, east_m)


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What lanes give at places, (M,) each.

    Parameters
    ----------
    photos
        How many see it.
    forward, side
        Parts of a photo that the next one, and that of the next lane, see again there; −inf where unseen.
    worst_gsd_m, gsd_m
        Ground sampled distance in the photo that shows it worst, and in that which shows it nearest its
        middle; NaN where unseen.
    """

    photos: NDArray[np.int64]
    forward: Floats
    side: Floats
    worst_gsd_m: Floats
    gsd_m: Floats

    def only(self, kept: Flags) -> Seen:
        """At some of the places, (M,) flags."""
        return Seen(
            self.photos[kept], self.forward[kept], self.side[kept], self.worst_gsd_m[kept], self.gsd_m[kept]
        )

    def where(self, changed: Flags, other: Seen) -> Seen:
        """With what others give at some of the places, (M,) flags."""
        found = []
        for known, new in zip(astuple(self), astuple(other), strict=True):
            mixed = known.copy()
            mixed[changed] = new
            found.append(mixed)
        return Seen(*found)


def look(places_m: Floats, ground_m: Floats, lanes: Sequence[Lane], sensor: CameraSensor) -> Seen:
    """What lanes give at places; parallel ones are neighbours, and the group that keeps overlaps best counts.

    Parameters
    ----------
    ground_m
        Height of the ground at the places, (M,).
    """
    count = len(places_m)
    photos = np.zeros(count, dtype=np.int64)
    forward, side = np.full(count, -np.inf), np.full(count, -np.inf)
    worst, middle, best = np.full(count, np.nan), np.full(count, np.nan), np.full(count, np.inf)
    nearest = sensor.forward_overlap >= TWICE
    for group in _parallel(lanes):
        across = _Across.none(count, once=not sensor.edge_overlap)
        for lane, track in zip(group, _tracks(group), strict=True):
            view = _View.of(lane, places_m, ground_m)
            photos[view.at] += view.photos
            worst[view.at] = np.fmax(worst[view.at], view.worst_gsd(sensor))
            nearer = view.off < best[view.at]
            at = view.at[nearer]
            best[at], middle[at] = view.off[nearer], view.gsd(sensor)[nearer]
            onward = math.cos(lane.course_rad - group[0].course_rad) > 0.0
            across.add(view, track, onward=onward, nearest=nearest)
        beside = across.side()
        if not sensor.edge_overlap:
            beside = np.where(across.outside(), np.maximum(beside, sensor.side_overlap), beside)
            enough = np.maximum(across.forward, sensor.forward_overlap)
            across.forward = np.where(across.beyond, enough, across.forward)
        better = _beyond(across.forward, beside, sensor) > _beyond(forward, side, sensor)
        forward = np.where(better, across.forward, forward)
        side = np.where(better, beside, side)
    return Seen(photos, forward, side, worst, middle)


def _beyond(forward: Floats, side: Floats, sensor: CameraSensor) -> Floats:
    """By how much overlaps are more than asked for, the lesser of both."""
    return np.minimum(forward - sensor.forward_overlap, side - sensor.side_overlap)


def _parallel(lanes: Sequence[Lane]) -> list[list[Lane]]:
    """Lanes by direction, there and back alike."""
    groups: list[list[Lane]] = []
    for lane in lanes:
        for group in groups:
            if abs(math.remainder(lane.course_rad - group[0].course_rad, math.pi)) < PARALLEL_RAD:
                group.append(lane)
                break
        else:
            groups.append([lane])
    return groups


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """One lane at the places that some photo of it sees, (K,) each.

    Parameters
    ----------
    at
        Their numbers.
    left_m
        How far to the left of the middle of the lane's strip they lie, and ``width_m`` the strip's width.
    forward, photos, off
        See ``Seen``; how far from the middle of the nearest photo, a part of the chord.
    ahead_first, ahead_last, ahead
        How far ahead of the first and the last photo that see it, and of the nearest, for a metre of drop,
        along the image's upright.
    drop_m
        From the photo to the ground.
    beyond
        Whether the middle of the nearest photo lies before the first, or behind the last.
    """

    at: NDArray[np.int64]
    left_m: Floats
    width_m: Floats
    forward: Floats
    photos: NDArray[np.int64]
    off: Floats
    ahead_first: Floats
    ahead_last: Floats
    ahead: Floats
    drop_m: Floats
    beyond: Flags

    @classmethod
    def of(cls, lane: Lane, places_m: Floats, ground_m: Floats) -> _View:
        along = np.array([math.cos(lane.course_rad), math.sin(lane.course_rad)])
        stations_m = (lane.places_m - lane.places_m[0]) @ along
        deepest_m = float(lane.altitudes_m.max() - ground_m.min())
        reach_m = float(np.hypot(lane.corners[:, 0], lane.corners[:, 1]).max()) * deepest_m
        y_m = (places_m - lane.places_m[0]) @ np.array([-along[1], along[0]])
        at = np.flatnonzero(np.abs(y_m) <= reach_m)
        t_m, y_m = (places_m[at] - lane.places_m[0]) @ along, y_m[at]
        drop_m = np.interp(t_m, stations_m, lane.altitudes_m) - ground_m[at]
        near = (drop_m > 0.0) & (t_m >= -reach_m) & (t_m <= stations_m[-1] + reach_m)
        at, t_m, y_m, drop_m = at[near], t_m[near], y_m[near], drop_m[near]
        low, high = _spans(lane.corners, y_m / drop_m)
        # Stations from first to before last see the place.
        first = np.searchsorted(stations_m, t_m - high * drop_m - 1e-9)
        last = np.searchsorted(stations_m, t_m - low * drop_m + 1e-9, side="right")
        if lane.video:
            first, last = np.minimum(first, 1), np.where(first < 2, 2, 0) * (last > 0)
        kept = (last > first) & ~np.isnan(low)
        at, t_m, y_m, drop_m, low, high, first, last = (
            each[kept] for each in (at, t_m, y_m, drop_m, low, high, first, last)
        )
        middle_m = t_m - (low + high) / 2.0 * drop_m
        next_ = np.clip(np.searchsorted(stations_m, middle_m), 1, len(stations_m) - 1)
        behind_m, ahead_m = np.abs(middle_m - stations_m[next_ - 1]), np.abs(middle_m - stations_m[next_])
        between_m = stations_m[next_] - stations_m[next_ - 1]
        off_m = np.minimum(behind_m, ahead_m)
        beyond = (middle_m < stations_m[0]) | (middle_m > stations_m[-1])
        gap_m = np.where(last - first > 1, between_m, 2.0 * off_m)
        near_at = np.where(ahead_m < behind_m, next_, next_ - 1)
        upright = _upright(lane.corners)
        ups = [(t_m - stations_m[each]) / drop_m for each in (first, last - 1, near_at)]
        if lane.video:
            # Some moment shows each place at any part of its chord.
            ups = [low, high, (low + high) / 2.0]
            between_m = gap_m = off_m = np.zeros(len(at))
        chord_m = (high - low) * drop_m
        right, left = _strips(lane.corners, between_m / drop_m)
        from_m, until_m, near_m = (up * upright[0] + y_m / drop_m * upright[1] for up in ups)
        return cls(
            at, y_m - (left + right) / 2.0 * drop_m, (left - right) * drop_m,
            1.0 - gap_m / chord_m, last - first, off_m / chord_m, from_m, until_m, near_m, drop_m,
            beyond,
        )  # fmt: skip

    def worst_gsd(self, sensor: CameraSensor) -> Floats:
        """Ground sampled distance in the photo that shows a place worst."""
        return np.maximum(
            _gsd_m(sensor, self.ahead_first, self.drop_m), _gsd_m(sensor, self.ahead_last, self.drop_m)
        )

    def gsd(self, sensor: CameraSensor) -> Floats:
        """The same in the nearest one."""
        return _gsd_m(sensor, self.ahead, self.drop_m)


def _gsd_m(sensor: CameraSensor, ahead: Floats, drop_m: Floats) -> Floats:
    """Mean of along and across, at a place so far ahead for each metre of drop.

    Its depth along the camera's axis is what a pixel's size goes by across, and by its square along.
    """
    depth = ahead * math.sin(sensor.tilt_rad) + math.cos(sensor.tilt_rad)
    pixel = sensor.optics.pixel_pitch_m / sensor.optics.focal_length_m
    return np.asarray(pixel * drop_m * (depth + depth * depth) / 2.0)


@dataclass(slots=True, eq=False)
class _Across:
    """The two nearest lanes at each place: to the left of it by how much, width of the strip, which track.

    Lanes in line with each other are one track; tracks are counted from right to left.

    Parameters
    ----------
    once
        Whether a place need be in one photo only at edges: the nearest lane counts.
    forward, rank
        Of the lane that counts, and by what it does, the least of all: how far it is, lanes in one photo of
        which a place is behind those in two; where places need not be in two photos, how little is shared.
    beyond
        Whether it lies before the first photo of that lane, or behind the last.
    left_m, width_m, track
        (2, M): the nearest lane and the nearest of another track.
    """

    once: bool
    forward: Floats
    rank: Floats
    beyond: Flags
    left_m: Floats
    width_m: Floats
    track: Floats

    @classmethod
    def none(cls, count: int, *, once: bool) -> _Across:
        """Before any lane."""
        far = np.full((2, count), np.inf)
        nowhere = np.zeros(count, dtype=np.bool_)
        none, first = np.full(count, -np.inf), np.full(count, np.inf)
        return cls(once, none, first, nowhere, far, far.copy(), far.copy())

    def add(self, view: _View, track: int, *, onward: bool, nearest: bool) -> None:
        """One more lane.

        Parameters
        ----------
        onward
            Whether it flies as the first does, by which left and right are told.
        nearest
            Whether the nearest lane counts forward, or the one whose photos share most.
        """
        left_m = view.left_m if onward else -view.left_m
        away_m = np.abs(left_m)
        rank = away_m + np.where(view.photos > 1, 0.0, _LAST_M) if nearest else -view.forward
        if self.once:
            rank = away_m
        closer = rank < self.rank[view.at]
        self.rank[view.at[closer]] = rank[closer]
        self.forward[view.at[closer]] = view.forward[closer]
        self.beyond[view.at[closer]] = view.beyond[closer]
        new = np.stack([left_m, view.width_m, np.full(len(left_m), float(track))])
        known = np.stack([self.left_m[:, view.at], self.width_m[:, view.at], self.track[:, view.at]])
        first, second = away_m < np.abs(known[0, 0]), away_m < np.abs(known[0, 1])
        same = known[2, 0] == track
        # A second nearest of the same track is none: lanes in line stand in for each other.
        known[:, 1] = np.where(first & ~same, known[:, 0], known[:, 1])
        known[:, 1] = np.where(~first & second & ~same, new, known[:, 1])
        known[:, 0] = np.where(first, new, known[:, 0])
        self.left_m[:, view.at], self.width_m[:, view.at], self.track[:, view.at] = known

    def outside(self) -> Flags:
        """Which places lie beside the outer one of the tracks, in view of it and of no other."""
        seen = np.isfinite(self.track[0])
        last = float(self.track[0][seen].max()) if seen.any() else 0.0
        alone = seen & ~np.isfinite(self.track[1])
        beyond = (self.track[0] == 0.0) & (self.left_m[0] <= 0.0)
        beyond |= (self.track[0] == last) & (self.left_m[0] >= 0.0)
        return np.asarray(alone & beyond, dtype=np.bool_)

    def side(self) -> Floats:
        """What of the strip the next lane sees again."""
        with np.errstate(invalid="ignore"):
            neighbours = np.abs(self.track[0] - self.track[1]) == 1.0
            between_m = np.abs(self.left_m[0] - self.left_m[1])
        # Tracks between two that see a place may be over ground elsewhere.
        alone_m = 2.0 * np.abs(self.left_m[0])
        gap_m = np.where(neighbours, between_m, np.fmin(alone_m, between_m))
        width_m = np.where(neighbours, np.minimum(*self.width_m), self.width_m[0])
        seen = np.isfinite(width_m) & (width_m > 0.0)
        share = np.full(len(width_m), -np.inf)
        share[seen] = 1.0 - gap_m[seen] / width_m[seen]
        return share


def _tracks(group: Sequence[Lane]) -> list[int]:
    """The track of each lane, by where it lies across the first one's course."""
    course_rad = group[0].course_rad
    left = np.array([-math.sin(course_rad), math.cos(course_rad)])
    across_m = np.array([float(lane.places_m.mean(axis=0) @ left) for lane in group])
    order = np.argsort(across_m)
    steps = np.concatenate([[0], np.cumsum(np.diff(across_m[order]) > SAME_TRACK_M)])
    return [int(track) for track in steps[np.argsort(order)]]


def _spans(corners: Floats, left: Floats) -> tuple[Floats, Floats]:
    """What a photo sees of parallels to the course, from and to; NaN where nothing: bounds of half planes."""
    low, high = np.full(len(left), -np.inf), np.full(len(left), np.inf)
    for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        # Counter-clockwise, the inside lies to the left of each edge: n · p ≤ c.
        ahead, across = other[1] - one[1], one[0] - other[0]
        limit = ahead * one[0] + across * one[1]
        rest = limit - across * left
        if abs(ahead) < 1e-12:
            low = np.where(rest < -1e-12, np.nan, low)
        elif ahead > 0.0:
            high = np.minimum(high, rest / ahead)
        else:
            low = np.maximum(low, rest / ahead)
    missed = ~(high > low)
    return np.where(missed, np.nan, low), np.where(missed, np.nan, high)


def _strips(corners: Floats, chords: Floats) -> tuple[Floats, Floats]:
    """Between which distances to the left chords of a length, at least, are seen; 0 and 0 where none."""
    knots = np.linspace(corners[:, 1].min(), corners[:, 1].max(), _CHORDS + 1)
    left = np.unique(np.concatenate([knots, corners[:, 1]]))
    low, high = _spans(corners, np.clip(left, left[0] + 1e-12, left[-1] - 1e-12))
    lengths = np.nan_to_num(high - low)
    top = int(np.argmax(lengths))
    # Chords grow up to the longest, and shrink behind it: the photo is convex.
    rising = np.interp(chords, np.maximum.accumulate(lengths[: top + 1]), left[: top + 1])
    falling = np.interp(chords, np.maximum.accumulate(lengths[top:][::-1]), left[top:][::-1])
    fits = chords <= lengths[top] * (1.0 + 1e-12)
    return np.where(fits, rising, 0.0), np.where(fits, falling, 0.0)


def _upright(corners: Floats) -> Floats:
    """Unit vector of the image's upright on the ground, ahead and left: from its lower to its upper edge."""
    up = (corners[1] + corners[2]) / 2.0 - (corners[0] + corners[3]) / 2.0
    unit: Floats = up / math.hypot(*up)
    return unit
