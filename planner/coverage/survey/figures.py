"""Figures flown round a place: rings of chords, a spiral of them, looks from all round; lines in order.

Chords of a ring touch a circle; those of one ring and the next are parallel in each of n sectors, a lane
spacing apart, so that photos overlap there as between lanes. They leave room at the corners for an arc of the
turn radius, r·tan(π / n), which n keeps within a photo's interval where it can, and are flown on without
settling there: all of a ring is one turn. Rings too small for that have few chords, each flown by itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage.survey.frame import frames, runs
from planner.sensors.camera import TWICE, CameraSensor

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

#: Sectors of rings and spirals, and looks from all round.
FEWEST_SECTORS, MOST_SECTORS, LOOKS = 6, 36, 8
#: The innermost ring sees the middle with this part of a photo's half width to spare.
INNERMOST = 0.9


class Figure(Protocol):
    """Lines in flight order, turned by an angle."""

    @property
    def period_rad(self) -> float:
        """Turned by this it is the same."""

    def lines(self, angle_rad: float, left: bool) -> Floats:
        """Its lines (N, 2, 2), flown to the left round the middle or to the right."""

    def goes_on(self, left: bool) -> Flags:
        """Which of its lines are flown on from the one before, in one turn, (N,)."""


@dataclass(frozen=True, slots=True)
class Chords:
    """Chords round a middle, outermost first.

    Parameters
    ----------
    apothems_m
        Distances of the chords from the middle, in flight order.
    sectors
        Chords to a full turn.
    corner_m, least_m
        Left out at either end of a chord where at least so much of it is left.
    """

    middle: tuple[float, float]
    apothems_m: Floats
    sectors: int
    corner_m: float
    least_m: float

    @property
    def period_rad(self) -> float:
        """A sector."""
        return math.tau / self.sectors

    def lines(self, angle_rad: float, left: bool) -> Floats:
        """See ``Figure``."""
        turn_rad = self.period_rad
        begin_m, end_m, cut = self._ends()
        corner_m = np.where(cut, self.corner_m, 0.0)
        begin_m, end_m = begin_m + corner_m, end_m - corner_m
        toward_rad = angle_rad + turn_rad * np.arange(len(self.apothems_m))
        out = np.stack([np.cos(toward_rad), np.sin(toward_rad)], axis=1)
        ahead = np.stack([-out[:, 1], out[:, 0]], axis=1)
        foot = np.array(self.middle) + self.apothems_m[:, None] * out
        lines = np.stack([foot + begin_m[:, None] * ahead, foot + end_m[:, None] * ahead], axis=1)
        return lines if left else lines[::-1, ::-1].copy()

    def goes_on(self, left: bool) -> Flags:
        """See ``Figure``."""
        _, _, cut = self._ends()
        cut = cut if left else cut[::-1]
        return np.concatenate([[False], cut[1:] & cut[:-1]])

    def _ends(self) -> tuple[Floats, Floats, Flags]:
        """Where along each chord it meets those beside it, and whether there is room for an arc at both."""
        turn_rad = self.period_rad
        before_m = np.concatenate([self.apothems_m[:1], self.apothems_m[:-1]])
        after_m = np.concatenate([self.apothems_m[1:], self.apothems_m[-1:]])
        # Where a chord meets the next: two lines a and b from the middle, a sector apart.
        begin_m = -(before_m - self.apothems_m * math.cos(turn_rad)) / math.sin(turn_rad)
        end_m = (after_m - self.apothems_m * math.cos(turn_rad)) / math.sin(turn_rad)
        cut = (end_m - begin_m >= 2.0 * self.corner_m + self.least_m) & (self.corner_m > 0.0)
        return begin_m, end_m, np.asarray(cut, dtype=np.bool_)


@dataclass(frozen=True, slots=True)
class Nested:
    """Rings inside others, with fewer chords."""

    outer: Chords
    inner: Chords

    @property
    def period_rad(self) -> float:
        """That of the rings with fewer chords."""
        return self.inner.period_rad

    def lines(self, angle_rad: float, left: bool) -> Floats:
        """See ``Figure``: from outside inwards, or back."""
        parts = [each.lines(angle_rad, left) for each in (self.outer, self.inner)]
        return np.concatenate(parts if left else parts[::-1])

    def goes_on(self, left: bool) -> Flags:
        """See ``Figure``."""
        parts = [each.goes_on(left) for each in (self.outer, self.inner)]
        return np.concatenate(parts if left else parts[::-1])


@dataclass(frozen=True, slots=True)
class Looks:
    """Photos of ground ahead from so many directions, evenly round.

    Parameters
    ----------
    ground
        To be in the frame, in all of it where it is no longer than that.
    count
        Directions.
    """

    ground: Polygon
    camera: CameraSensor
    height_m: float
    count: int

    @property
    def period_rad(self) -> float:
        """From one direction to the next."""
        return math.tau / self.count

    def lines(self, angle_rad: float, left: bool) -> Floats:
        """See ``Figure``."""
        step_rad = self.period_rad if left else -self.period_rad
        return np.array([self._line(angle_rad + k * step_rad) for k in range(self.count)])

    def goes_on(self, left: bool) -> Flags:
        """None: each is turned to by itself."""
        return np.zeros(self.count, dtype=np.bool_)

    def holds(self, angle_rad: float) -> bool:
        """Whether the ground is no wider than what a photo sees from a direction."""
        across_m = np.ptp(shapely.get_coordinates(self.ground) @ (-math.sin(angle_rad), math.cos(angle_rad)))
        return bool(across_m <= 2.0 * self.camera.half_width_m(self.height_m, angle_rad))

    def _line(self, angle_rad: float) -> Floats:
        ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
        left = np.array([-ahead[1], ahead[0]])
        corners = shapely.get_coordinates(self.ground)
        along_m, across_m = corners @ ahead, corners @ left
        run = runs(self.camera, self.height_m, np.array([angle_rad]))
        first_m = float(along_m.min() - run.other_in_m[0])
        last_m = float(along_m.max() + run.other_out_m[0])
        short_m = self.camera.photo_spacing_m(self.height_m, angle_rad)
        if last_m - first_m < short_m:
            # All of it is in every photo between the two; the middle of these is the best place.
            middle_m = (first_m + last_m) / 2.0
            first_m, last_m = middle_m - short_m / 2.0, middle_m + short_m / 2.0
        y_m = float(across_m.min() + across_m.max()) / 2.0
        return np.array([first_m * ahead + y_m * left, last_m * ahead + y_m * left])


def rings(ground: Polygon, camera: CameraSensor, height_m: float, radius_m: float) -> Chords | Nested:
    """Rings that see a disc round the ground, the innermost its middle."""
    found = _Round.of(ground, camera, height_m, radius_m)
    apothems_m: Floats = found.inner_m + found.spacing_m * np.arange(found.count * 1.0)[::-1]
    whole = apothems_m >= found.least_ring_m
    outer = found.chords(np.repeat(apothems_m[whole], found.sectors))
    # Chords that are turned to one by one: as few as can be, that lie no nearer to the ring outside.
    few = replace(found, sectors=FEWEST_SECTORS, corner_m=0.0)
    inner = few.chords(np.repeat(apothems_m[~whole], FEWEST_SECTORS))
    return outer if whole.all() else inner if not whole.any() else Nested(outer, inner)


def spiral(ground: Polygon, camera: CameraSensor, height_m: float, radius_m: float) -> Chords | Nested:
    """A spiral that sees a disc round the ground: its first turn the edge, its last one the middle."""
    found = _Round.of(ground, camera, height_m, radius_m)
    steps: Floats = np.arange(found.count * found.sectors + 1.0)[::-1]
    if found.inner_m + found.spacing_m > found.middle_m:
        # The last turn comes in too late to see the middle from all sides of it.
        steps = np.concatenate([steps, np.zeros(found.sectors - 1)])
    apothems_m: Floats = found.inner_m + found.spacing_m / found.sectors * steps
    whole = apothems_m >= found.least_ring_m
    if whole.all() or found.sectors == FEWEST_SECTORS:
        return found.chords(apothems_m)
    few = replace(found, sectors=FEWEST_SECTORS, corner_m=0.0)
    from_m = float(apothems_m[whole][-1] if whole.any() else apothems_m[0])
    # Behind a whole ring no place is farther than a lane spacing from the turn outside.
    coming: Floats = np.arange(from_m, found.inner_m, -found.spacing_m / FEWEST_SECTORS)
    every = np.concatenate(
        [np.full(FEWEST_SECTORS - 1, from_m), coming, np.full(FEWEST_SECTORS, found.inner_m)]
    )
    inner = few.chords(every)
    return Nested(found.chords(apothems_m[whole]), inner) if whole.any() else inner


@dataclass(frozen=True, slots=True)
class _Round:
    """Rings round a ground: their middle, the innermost's apothem, how many so far apart, their corners."""

    middle: tuple[float, float]
    inner_m: float
    count: int
    spacing_m: float
    sectors: int
    corner_m: float
    photos_m: float
    middle_m: float

    @classmethod
    def of(cls, ground: Polygon, camera: CameraSensor, height_m: float, radius_m: float) -> _Round:
        middle = shapely.minimum_bounding_circle(ground).centroid
        reach_m = float(shapely.minimum_bounding_radius(ground))
        laid = frames(camera, height_m, np.radians(np.arange(0.0, 180.0, 5.0)))
        spacing_m, half_m, photos_m = (
            float(each.min()) for each in (laid.spacing_m, laid.half_m, laid.photos_m)
        )
        sectors = math.ceil(math.pi / math.atan(photos_m / (2.0 * radius_m)))
        sectors = min(max(sectors, FEWEST_SECTORS), MOST_SECTORS)
        # Rings no smaller than the turns, as far as the middle is still seen from them.
        inner_m = min(max(radius_m, half_m / 2.0), INNERMOST * half_m)
        outer_m = reach_m - float(laid.inset_m.min())
        count = max(math.ceil((outer_m - inner_m) / spacing_m - 1e-9), 0) + 1
        corner_m = radius_m * math.tan(math.pi / sectors)
        if 2.0 * corner_m > (photos_m if camera.forward_overlap < TWICE else 2.0 * photos_m):
            # Photos on either side of it would hardly overlap.
            corner_m = 0.0
        seen_m = INNERMOST * half_m
        return cls((middle.x, middle.y), inner_m, count, spacing_m, sectors, corner_m, photos_m, seen_m)

    @property
    def least_ring_m(self) -> float:
        """Apothem of the smallest ring flown in one turn: with an arc at either end of a chord and photos."""
        if self.corner_m <= 0.0:
            return math.inf
        return (self.corner_m + self.photos_m / 2.0) / math.tan(math.pi / self.sectors)

    def chords(self, apothems_m: Floats) -> Chords:
        """Chords so far from the middle."""
        return Chords(self.middle, apothems_m, self.sectors, self.corner_m, self.photos_m)
