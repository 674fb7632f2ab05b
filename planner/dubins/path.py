"""A flyable line: straights and arcs, continuous in position and direction."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from planner.angles import wrap_pi
from planner.dubins.sample_kernels import sampled
from planner.route import Pose

SegmentKind = Literal["straight", "left", "right"]

#: Arcs that turn less than this are no turns.
MIN_TURN_RAD = math.radians(1.0)


@dataclass(frozen=True, slots=True)
class Segment:
    """A straight or an arc.

    Parameters
    ----------
    kind
        ``left`` turns counter-clockwise, ``right`` clockwise.
    start
        Pose at its beginning.
    length_m
        Along the line, >= 0.
    radius_m
        Of the arc; inf for a straight.
    """

    kind: SegmentKind
    start: Pose
    length_m: float
    radius_m: float = math.inf

    @property
    def turn_rad(self) -> float:
        """Change of direction, positive to the left."""
        if self.kind == "straight":
            return 0.0
        return (self.length_m if self.kind == "left" else -self.length_m) / self.radius_m

    @property
    def centre(self) -> tuple[float, float] | None:
        """Centre of the arc, None for a straight."""
        if self.kind == "straight":
            return None
        side = 1.0 if self.kind == "left" else -1.0
        return (
            self.start.east_m - side * self.radius_m * math.sin(self.start.angle_rad),
            self.start.north_m + side * self.radius_m * math.cos(self.start.angle_rad),
        )

    def at(self, distance_m: float) -> Pose:
        """Pose a distance along the segment."""
        angle = self.start.angle_rad
        if self.kind == "straight":
            return Pose(
                self.start.east_m + distance_m * math.cos(angle),
                self.start.north_m + distance_m * math.sin(angle),
                angle,
            )
        side = 1.0 if self.kind == "left" else -1.0
        end_angle = angle + side * distance_m / self.radius_m
        return Pose(
            self.start.east_m + side * self.radius_m * (math.sin(end_angle) - math.sin(angle)),
            self.start.north_m - side * self.radius_m * (math.cos(end_angle) - math.cos(angle)),
            wrap_pi(end_angle),
        )

    @property
    def end(self) -> Pose:
        """Pose at its end."""
        return self.at(self.length_m)

    def reverse(self) -> Segment:
        """The same line flown the other way."""
        other: dict[SegmentKind, SegmentKind] = {"straight": "straight", "left": "right", "right": "left"}
        end = self.end
        start = Pose(end.east_m, end.north_m, wrap_pi(end.angle_rad + math.pi))
        return Segment(other[self.kind], start, self.length_m, self.radius_m)


@dataclass(frozen=True, slots=True)
class Path:
    """Segments end to end."""

    segments: tuple[Segment, ...]

    @property
    def length_m(self) -> float:
        """Whole length."""
        return math.fsum(segment.length_m for segment in self.segments)

    @property
    def start(self) -> Pose:
        """First pose."""
        return self.segments[0].start

    @property
    def end(self) -> Pose:
        """Last pose."""
        return self.segments[-1].end

    def reverse(self) -> Path:
        """The same line flown the other way."""
        return Path(tuple(segment.reverse() for segment in reversed(self.segments)))

    def sample(self, max_chord_m: float, max_straight_m: float = math.inf) -> NDArray[np.float64]:
        """Points along the line.

        Parameters
        ----------
        max_chord_m
            Largest distance along an arc between neighbours.
        max_straight_m
            The same for straights; by default they have only their ends.

        Returns
        -------
        ndarray
            float64, shape (N, 4): east_m, north_m, angle_rad, distance_m along the path. Each segment's
            ends are among them.
        """
        sides = {"straight": 0.0, "left": 1.0, "right": -1.0}
        rows = [
            (sides[s.kind], *s.start.position, s.start.angle_rad, s.length_m, s.radius_m)
            for s in self.segments
        ]
        points: NDArray[np.float64] = sampled(np.array(rows), max_chord_m, max_straight_m)
        return points


def join(*paths: Path) -> Path:
    """One path of several that follow each other, without segments of no length."""
    segments = tuple(s for path in paths for s in path.segments if s.length_m > 1e-9)
    return Path(segments or paths[0].segments[:1])
