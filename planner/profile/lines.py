"""Pieces of lines: cut at a distance, with a circle put in, flown the other way."""

from __future__ import annotations

import math
from dataclasses import replace

from planner.dubins.path import Path, Segment, SegmentKind, join

#: Missions keep circles up to this radius in whole metres, wider ones in steps of ten.
WHOLE_METRES_UP_TO_M, WIDE_STEP_M = 255.0, 10.0


def stored_radius_m(radius_m: float) -> float:
    """The radius of a circle as missions can say it, no tighter."""
    if radius_m <= WHOLE_METRES_UP_TO_M:
        return float(math.ceil(radius_m))
    return float(math.ceil(radius_m / WIDE_STEP_M) * WIDE_STEP_M)


def cut(path: Path, from_m: float, until_m: float) -> Path:
    """The part of a line between two distances along it; None of it gives a straight of no length."""
    pieces: list[Segment] = []
    along_m = 0.0
    for segment in path.segments:
        first_m = max(from_m - along_m, 0.0)
        last_m = min(until_m - along_m, segment.length_m)
        if last_m - first_m > 1e-9:
            pieces.append(replace(segment, start=segment.at(first_m), length_m=last_m - first_m))
        along_m += segment.length_m
    return Path(tuple(pieces) or (Segment("straight", path.start, 0.0),))


def circle(path: Path, at_m: float, side: SegmentKind, radius_m: float, turns: int) -> Path:
    """Whole turns that begin and end on a line, along it.

    Parameters
    ----------
    side
        ``left`` or ``right``: where the centre lies.
    """
    pose = cut(path, at_m, path.length_m).start if at_m < path.length_m else path.end
    return Path((Segment(side, pose, math.tau * radius_m * turns, radius_m),))


def with_circle(path: Path, at_m: float, turns: Path) -> Path:
    """A line with turns put in where they touch it."""
    return join(cut(path, 0.0, at_m), turns, cut(path, at_m, path.length_m))


def straights(path: Path, step_m: float) -> list[float]:
    """Distances along a line at which it flies straight, no further apart than asked."""
    found: list[float] = []
    along_m = 0.0
    for segment in path.segments:
        if segment.kind == "straight":
            steps = max(1, math.ceil(segment.length_m / step_m))
            found.extend(along_m + segment.length_m * k / steps for k in range(steps + 1))
        along_m += segment.length_m
    return found
