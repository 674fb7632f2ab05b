"""What one photo sees, in the axes of the course: how much of the way along it, at each distance beside it.

Of a camera one metre up, tilted forward by τ, an image point u across and v up (as tangents) lies on level
ground at (sin τ + v cos τ) / D ahead and u / D to the side, D = cos τ − v sin τ. Turned by the crab that is
a convex quadrilateral; all of it grows with the height. A place beside the track is seen along the *chord*
that its parallel to the course cuts from the quadrilateral.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from planner.sensors.optics import Optics

_HALVINGS = 60
#: Photos are no farther apart than this part of the longest chord: at all of it the strip has no width.
FARTHEST = 0.98


@dataclass(frozen=True, slots=True)
class Band:
    """A photo's quadrilateral from one metre up.

    Parameters
    ----------
    corners
        Ahead of the camera and to its left, metres, in order round the image.
    """

    corners: tuple[tuple[float, float], ...]

    @property
    def knots(self) -> tuple[float, ...]:
        """Distances to the left at which corners lie, from right to left."""
        return tuple(sorted({left for _, left in self.corners}))

    def span(self, left: float) -> tuple[float, float]:
        """What is seen of the parallel to the course at a distance to the left: from, to, ahead."""
        met = []
        for (x0, y0), (x1, y1) in zip(self.corners, self.corners[1:] + self.corners[:1], strict=True):
            if y0 == y1 == left:
                met += [x0, x1]
            elif min(y0, y1) <= left <= max(y0, y1) and y0 != y1:
                met.append(x0 + (x1 - x0) * (left - y0) / (y1 - y0))
        if not met:
            return (math.nan, math.nan)
        return min(met), max(met)

    def chord(self, left: float) -> float:
        """Length of that span."""
        first, last = self.span(left)
        return last - first

    def strip(self, chord: float) -> tuple[float, float] | None:
        """From where on the right to where on the left a chord of that length, at least, is seen."""
        knots = self.knots
        lengths = [self.chord(knot) for knot in knots]
        # The longest chord itself is as long but for rounding.
        long = [k for k, length in enumerate(lengths) if length >= chord * (1.0 - 1e-6)]
        if not long:
            return None
        first, last = long[0], long[-1]
        right, left = knots[first], knots[last]
        if first > 0:
            share = max(lengths[first] - chord, 0.0) / (lengths[first] - lengths[first - 1])
            right -= share * (knots[first] - knots[first - 1])
        if last < len(knots) - 1:
            share = max(lengths[last] - chord, 0.0) / (lengths[last] - lengths[last + 1])
            left += share * (knots[last + 1] - knots[last])
        return right, left


def band(optics: Optics, tilt_rad: float, crab_rad: float) -> Band:
    """Of a camera tilted forward, its nose turned to the left of the course.

    Raises
    ------
    ValueError
        A part of the image looks over the horizon.
    """
    wide, high = math.tan(optics.half_width_rad), math.tan(optics.half_height_rad)
    cos, sin = math.cos(tilt_rad), math.sin(tilt_rad)
    corners = []
    for u, v in ((wide, -high), (-wide, -high), (-wide, high), (wide, high)):
        down = cos - v * sin
        if not down > 1e-9:
            raise ValueError("a part of the image looks over the horizon")
        ahead, left = (sin + v * cos) / down, -u / down
        corners.append(
            (
                ahead * math.cos(crab_rad) - left * math.sin(crab_rad),
                ahead * math.sin(crab_rad) + left * math.cos(crab_rad),
            )
        )
    return Band(tuple(corners))


def _shared(knots: tuple[float, ...], lengths: list[float], moved: float) -> float:
    """The part of a photo's ground, chords of these lengths at knots, that one so much farther along sees."""
    whole = again = 0.0
    for k in range(len(knots) - 1):
        width, a, b = knots[k + 1] - knots[k], lengths[k], lengths[k + 1]
        whole += width * (a + b) / 2.0
        low, high = (a - moved, b - moved) if a < b else (b - moved, a - moved)
        if low >= 0.0:
            again += width * (low + high) / 2.0
        elif high > 0.0:
            again += width * high * high / (high - low) / 2.0
    return again / whole


@dataclass(frozen=True, slots=True)
class Pattern:
    """Photos along a lane from one metre up, and the strip in which they overlap.

    Parameters
    ----------
    spacing
        Between two photos.
    right, left
        Edges of the strip, the right one negative: within it each place is seen along as much of the way as
        the overlap asks for.
    before, beyond
        How far ahead the whole strip is seen from on, and until where: the farthest of the chords'
        beginnings, the nearest of their ends.
    middle
        How far ahead the middle of what is seen of the course itself lies.
    middle_first, middle_last
        The same of parallels to the course in the strip: of that where it lies least far ahead, and farthest.
    """

    spacing: float
    right: float
    left: float
    before: float
    beyond: float
    middle: float
    middle_first: float
    middle_last: float

    @property
    def half_width(self) -> float:
        """Of the strip, to the nearer of its edges."""
        return min(self.left, -self.right)


@lru_cache(maxsize=8192)
def pattern(optics: Optics, tilt_rad: float, crab_rad: float, forward_overlap: float) -> Pattern:
    """Photos spaced so that the next sees the overlap's part of each again, its crab allowed for.

    The strip beside them is where a place is seen along spacing / (1 − overlap) of the way at least, as
    often, that is, as the overlap says: all of the image's width where nothing crabs, and less where it does.
    """
    seen = band(optics, tilt_rad, crab_rad)
    knots = seen.knots
    lengths = [seen.chord(knot) for knot in knots]
    low, high = 0.0, FARTHEST * max(lengths)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2.0
        low, high = (middle, high) if _shared(knots, lengths, middle) >= forward_overlap else (low, middle)
    edges = seen.strip(min(low / (1.0 - forward_overlap), max(lengths)))
    assert edges is not None
    right, left = edges
    spans = [seen.span(at) for at in (right, left, *(k for k in seen.knots if right < k < left))]
    # Bounds of a quadrilateral: between its corners they, and what lies halfway, are straight.
    middles = [(first + last) / 2.0 for first, last in spans]
    centre = seen.span(0.0)
    return Pattern(
        low,
        right,
        left,
        max(first for first, _ in spans),
        min(last for _, last in spans),
        (centre[0] + centre[1]) / 2.0,
        min(middles),
        max(middles),
    )
