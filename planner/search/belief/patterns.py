"""Search patterns as the IAMSAR Manual, volume II, defines them, for one aircraft or several over a datum.

Expanding square, sector, parallel track and creeping line. Where several search, the ground about the datum
is shared out in sub-areas side by side; sectors are flown over one datum, each turned from the other. The
datum is that of the middle of the search, and the ground as large as the aircraft sweep once, three errors
about the datum at most.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from planner.search.belief.lines import homeward, rounded, timed
from planner.search.belief.target import Target

Floats = NDArray[np.float64]

PATTERNS = ("expanding-square", "sector", "parallel-track", "creeping-line")

#: Patterns of legs side by side.
LEGGED = ("parallel-track", "creeping-line")

#: Ground beyond so many standard deviations of the datum is not searched.
ERRORS = 3.0


@dataclass(frozen=True, slots=True)
class Searcher:
    """One aircraft as a search knows it.

    Parameters
    ----------
    base_m
        Where it starts, and ends.
    until_s
        When it must be back.
    half_width_m
        Half of what it sees across its course.
    detection
        Probability that a look finds what it sees.
    """

    base_m: tuple[float, float]
    speed_m_s: float
    turn_radius_m: float
    until_s: float
    half_width_m: float
    detection: float

    @property
    def track_m(self) -> float:
        """Length that it can fly."""
        return self.speed_m_s * self.until_s


@dataclass(frozen=True, slots=True)
class Shape:
    """What may be varied of a pattern.

    Parameters
    ----------
    spacing
        Of its legs, by the swath.
    course_rad
        Direction of what lies to the right of its first legs.
    size
        Of the ground, by that which is swept once.
    drifting
        Whether it goes along with the drift.
    datum_part
        The part of the search at whose time the datum is taken, where it does not.
    outward
        Whether legs side by side are flown from the one nearest to the datum on, to one side, then the other.
    """

    spacing: float = 1.0
    course_rad: float = 0.0
    size: float = 1.0
    drifting: bool = False
    datum_part: float = 0.5
    outward: bool = False

    def varied(self, generator: np.random.Generator) -> Shape:
        """One a little different."""
        spacing, size, course, part = generator.normal(size=4)
        return Shape(
            float(np.clip(self.spacing * math.exp(0.12 * spacing), 0.5, 2.5)),
            self.course_rad + 0.25 * float(course),
            float(np.clip(self.size * math.exp(0.15 * size), 0.2, 2.0)),
            self.drifting != bool(generator.random() < 0.1),
            float(np.clip(self.datum_part + 0.1 * part, 0.0, 1.0)),
            self.outward,
        )


def pattern_lines(
    name: str, target: Target, searchers: tuple[Searcher, ...], shape: Shape = Shape()
) -> list[Floats]:
    """Lines (M, 3), one an aircraft, each home in time."""
    return [
        homeward(
            timed(rounded(corners, one.turn_radius_m), one.speed_m_s),
            one.base_m, one.speed_m_s, one.turn_radius_m, one.until_s,
        )
        for corners, one in zip(pattern_corners(name, target, searchers, shape), searchers, strict=True)
    ]  # fmt: skip


def pattern_corners(
    name: str, target: Target, searchers: tuple[Searcher, ...], shape: Shape = Shape()
) -> list[Floats]:
    """Corners (K, 2), one array an aircraft, from its base on, for longer than it may fly."""
    until_s = max(one.until_s for one in searchers)
    middle_s = shape.datum_part * until_s
    datum = np.array(target.datum_m(0.0 if shape.drifting else middle_s))
    swept_m2 = sum(
        2.0
        * one.half_width_m
        * shape.spacing
        * max(0.0, one.track_m - 2.0 * math.dist(one.base_m, datum.tolist()))
        for one in searchers
    )
    side_m = shape.size * min(math.sqrt(swept_m2), 2.0 * ERRORS * target.error_m(middle_s))
    found = []
    for index, one in enumerate(searchers):
        corners = _corners(name, one, index, len(searchers), side_m, shape)
        cosine, sine = math.cos(shape.course_rad), math.sin(shape.course_rad)
        turned = corners @ np.array([[cosine, sine], [-sine, cosine]]) + datum
        if shape.drifting:
            turned = _along(turned, one, target)
        found.append(np.concatenate([[one.base_m], turned]))
    return found


def _along(corners: Floats, one: Searcher, target: Target) -> Floats:
    """The same about a datum that goes on drifting while the pattern is flown."""
    drift = np.asarray(target.drift_m_s)
    time_s, here = 0.0, np.asarray(one.base_m)
    found = []
    for corner in corners:
        # Two rounds meet the moving corner well enough.
        there = corner + time_s * drift
        for _ in range(2):
            there = corner + (time_s + math.dist(here, there) / one.speed_m_s) * drift
        time_s += math.dist(here, there) / one.speed_m_s
        here = there
        found.append(there)
    return np.array(found)


def _corners(name: str, one: Searcher, index: int, count: int, side_m: float, shape: Shape) -> Floats:
    """Corners of the pattern about (0, 0), in flight order."""
    spacing_m = 2.0 * one.half_width_m * shape.spacing
    if name == "sector":
        return _sectors(0.5 * side_m, math.pi / 3.0 * index / count, one.track_m)
    # Sub-areas: slices side by side, in the order of the aircraft.
    slice_m = side_m / count
    west_m = -0.5 * side_m + index * slice_m
    if name == "expanding-square":
        about: Floats = _square(spacing_m, one.track_m) + np.array([west_m + 0.5 * slice_m, 0.0])
        return about
    along = name == "parallel-track"
    long_m, wide_m = (side_m, slice_m) if along or count > 1 else (side_m, side_m)
    if along:
        # Legs along the slice's longer side.
        offsets = _offsets(west_m, wide_m, spacing_m, shape.outward)
        ends = (-0.5 * long_m, 0.5 * long_m)
        rows = [((o, ends[k % 2]), (o, ends[1 - k % 2])) for k, o in enumerate(offsets)]
    else:
        # Legs across it, creeping along from one end.
        offsets = _offsets(-0.5 * long_m, long_m, spacing_m, shape.outward)
        ends = (west_m, west_m + slice_m)
        rows = [((ends[k % 2], o), (ends[1 - k % 2], o)) for k, o in enumerate(offsets)]
    return np.array([corner for row in rows for corner in row])


def _offsets(first_m: float, wide_m: float, spacing_m: float, outward: bool) -> Floats:
    """Of legs side by side from an edge on, in flight order."""
    count = max(1, round(wide_m / spacing_m))
    offsets: Floats = first_m + (np.arange(count) + 0.5) * wide_m / count
    if outward:
        nearest = int(np.argmin(np.abs(offsets)))
        offsets = np.concatenate([offsets[nearest:], offsets[:nearest][::-1]])
    return offsets


def _square(spacing_m: float, track_m: float) -> Floats:
    here, corners, length_m, flown_m = np.zeros(2), [np.zeros(2)], spacing_m, 0.0
    ways = ((0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0))
    for leg in range(400):
        here = here + length_m * np.array(ways[leg % 4])
        corners.append(here)
        flown_m += length_m
        if flown_m > track_m:
            break
        length_m += spacing_m * (leg % 2)
    return np.array(corners)


def _sectors(radius_m: float, first_rad: float, track_m: float) -> Floats:
    """Legs through the datum, each followed by a chord to the next one, 120° turns; again turned by 30°."""
    corners, angle, flown_m = [np.zeros(2)], math.pi / 2.0 + first_rad, 0.0
    while flown_m < track_m:
        for _ in range(3):
            out = radius_m * np.array([math.cos(angle), math.sin(angle)])
            chord = radius_m * np.array([math.cos(angle - math.pi / 3.0), math.sin(angle - math.pi / 3.0)])
            corners += [out, chord, np.zeros(2)]
            angle += -2.0 * math.pi / 3.0
            flown_m += 3.0 * radius_m
        angle += math.pi / 6.0
        if radius_m < 1.0:
            break
    return np.array(corners)
