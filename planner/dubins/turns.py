"""Turns at a waypoint, and how well each keeps to the legs.

Stecz and Gromada (2020), section 4.2.2: the turn of three arcs through the waypoint (Algorithm 4), and the
turns it is compared with: past the target, and before the waypoint ("short turn"). Each begins on the leg to
the waypoint and ends on one away from it. The paper's letters are kept for points and circles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from planner.angles import wrap_pi
from planner.dubins.path import Path, Segment, SegmentKind
from planner.dubins.segment_arcs import egress
from planner.route import Point, Pose

#: Spacing of the sum that stands for the integral of eq 48.
SPACING_M = 1.0


@dataclass(frozen=True, slots=True)
class Turn:
    """A turn at a waypoint.

    Parameters
    ----------
    path
        Its arcs; past the target the straight to the next waypoint, too.
    before_m, after_m
        How far before the waypoint it leaves the leg that leads there, and how far beyond it comes onto the
        next; ``after_m`` is infinite where it comes onto the next waypoint, not the leg.
    """

    path: Path
    before_m: float
    after_m: float


def three_arc(
    before: Point,
    waypoint: Point,
    after: Point,
    radius_m: float,
    radius_in_m: float | None = None,
    radius_out_m: float | None = None,
) -> Turn:
    """Algorithm 4: out of the turn, through the waypoint along the turn, and back onto the next leg.

    The middle circle C_mid touches the waypoint from inside the turn, its centre w_k on the bisector. The
    ingress circle lies R beyond the leg on the outer side (L'_m) and touches C_mid: it is where L'_m crosses
    the circle about w_k of R + R_in (C_mid-ext; 2R where all radii are one), and the egress circle likewise.

    Parameters
    ----------
    before, waypoint, after
        w_i, w_(i+3), w_(i+6): the legs L_m and L_(m+1).
    radius_m, radius_in_m, radius_out_m
        Of the middle arc, the first and the last, > 0; the last two as the middle one where not given.
    """
    angle_rad, turn_rad = _corner(before, waypoint, after)
    half_rad, left = 0.5 * abs(turn_rad), turn_rad >= 0.0
    outward: SegmentKind = "right" if left else "left"
    inward: SegmentKind = "left" if left else "right"
    away_m, reach_m = radius_m * math.cos(half_rad), radius_m * math.sin(half_rad)
    arcs: list[tuple[float, float, float]] = []
    for own_m in (radius_in_m or radius_m, radius_out_m or radius_m):
        lever_m, height_m = radius_m + own_m, own_m + away_m
        along_m = math.sqrt(max(0.0, lever_m * lever_m - height_m * height_m))
        arcs.append((own_m, math.atan2(along_m, height_m), reach_m + along_m))
    (in_m, in_rad, before_m), (out_m, out_rad, after_m) = arcs
    start = Pose(
        waypoint[0] - before_m * math.cos(angle_rad), waypoint[1] - before_m * math.sin(angle_rad), angle_rad
    )
    if half_rad == 0.0:
        return Turn(Path((Segment("straight", start, 0.0),)), before_m, after_m)
    first = Segment(outward, start, in_rad * in_m, in_m)
    middle = Segment(inward, first.end, (in_rad + abs(turn_rad) + out_rad) * radius_m, radius_m)
    last = Segment(outward, middle.end, out_rad * out_m, out_m)
    return Turn(Path((first, middle, last)), before_m, after_m)


def past_target(before: Point, waypoint: Point, after: Point, radius_m: float) -> Turn | None:
    """The simplest turn: over the waypoint straight on, then round until the next one lies ahead.

    From there it is flown to directly, beside the leg, not on it. None where no arc leads
    to the next waypoint.
    """
    angle_rad, _ = _corner(before, waypoint, after)
    path = egress(Pose(*waypoint, angle_rad), after, radius_m)
    return None if path is None else Turn(path, 0.0, math.inf)


def short_turn(before: Point, waypoint: Point, after: Point, radius_m: float) -> Turn | None:
    """The fastest turn, before the waypoint: one arc that touches both legs. None for a turn right back."""
    angle_rad, turn_rad = _corner(before, waypoint, after)
    if math.pi - abs(turn_rad) < 1e-9:
        return None
    tangent_m = radius_m * math.tan(0.5 * abs(turn_rad))
    start = Pose(
        waypoint[0] - tangent_m * math.cos(angle_rad),
        waypoint[1] - tangent_m * math.sin(angle_rad),
        angle_rad,
    )
    kind: SegmentKind = "left" if turn_rad >= 0.0 else "right"
    return Turn(Path((Segment(kind, start, abs(turn_rad) * radius_m, radius_m),)), tangent_m, tangent_m)


def quality_m2(path: Path, waypoints: ArrayLike, spacing_m: float = SPACING_M) -> float:
    """The integral quality index of eq 48: the distance from the legs, summed along the line.

    Parameters
    ----------
    path
        The line as flown.
    waypoints
        Shape (N, 2), N >= 2: the ends of the legs.
    spacing_m
        Of the trapezia that are summed.
    """
    points = np.asarray(waypoints, dtype=np.float64)
    samples = path.sample(spacing_m, spacing_m)
    away_m = np.full(len(samples), np.inf)
    for begin, end in pairwise(points):
        away_m = np.minimum(away_m, _from_leg(samples[:, :2], begin, end))
    return float(np.sum(0.5 * (away_m[1:] + away_m[:-1]) * np.diff(samples[:, 3])))


def _from_leg(
    places: NDArray[np.float64], begin: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Distances of places (K, 2) from a leg, its ends included."""
    leg = end - begin
    square = float(leg @ leg)
    part = np.clip((places - begin) @ leg / square, 0.0, 1.0) if square > 0.0 else np.zeros(len(places))
    offsets = places - (begin + part[:, None] * leg)
    return np.asarray(np.hypot(offsets[:, 0], offsets[:, 1]), dtype=np.float64)


def _corner(before: Point, waypoint: Point, after: Point) -> tuple[float, float]:
    """Direction of the first leg and the turn to the second, to the left positive; right back is π."""
    legs = [
        (there[0] - here[0], there[1] - here[1]) for here, there in ((before, waypoint), (waypoint, after))
    ]
    if any(math.hypot(*leg) == 0.0 for leg in legs):
        raise ValueError(f"a turn needs two legs, not {before}, {waypoint}, {after}")
    first_rad, second_rad = (math.atan2(north_m, east_m) for east_m, north_m in legs)
    return first_rad, wrap_pi(second_rad - first_rad)
