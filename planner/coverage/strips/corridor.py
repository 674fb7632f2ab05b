"""A corridor cut into few straight pieces: the line it follows, simplified within the swath.

What a swath holds of the line with half the corridor's width at either side is seen in one straight pass,
however many bends are in it. The line is cut at some of many places along it, by dynamic programming: each
piece costs its passes, and with each pass what flying to the next one costs. A line that closes upon itself
is cut from several of its places.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import substring

from planner.coverage.decompose import OVERLAP_M
from planner.coverage.strips.classify import ROUNDING_M, hull_points, spans_at
from planner.coverage.strips.headings import Swaths

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: The places where a piece begins and ends; beyond the last ones of a line that closes upon itself once more.
Piece = tuple[int, int]

#: Places to cut a line at: this part of what the swath has to spare apart, but no more of them than this.
FINE, MOST_PLACES = 0.25, 300
#: Headings that pieces are measured at where any is allowed; pieces that almost fit are measured exactly.
STEP_RAD = math.radians(2.0)
#: Passes of one piece, over what the corridor's width alone takes.
MORE_PASSES = 2
#: Places to begin at in a line that closes upon itself.
MOST_BEGINNINGS = 8
#: Buffers of a part and of the whole differ by less than this factor: pieces are made wider, then clipped.
WIDER = 1.01
#: What two buffers of one line differ by is no ground.
SLIVER_M = 1e-5


@dataclass(frozen=True, slots=True)
class Corridor:
    """A corridor's line, with the places it may be cut at.

    Parameters
    ----------
    area, half_m
        The corridor, and half the width that pieces are made with.
    line, length_m
        Its line, of one that closes upon itself thrice round, and its length, once round.
    places_m
        Along the line from its beginning to its end, ascending, (P + 1,).
    runs
        Vertices from each place to the next, (P,) of (V, 2).
    closed
        Whether the line closes upon itself, so that its first and last place are one.
    """

    area: Polygon
    half_m: float
    line: LineString
    length_m: float
    places_m: Floats
    runs: tuple[Floats, ...]
    closed: bool

    @classmethod
    def of(cls, area: Polygon, axis: LineString, swath_m: float) -> Corridor:
        """The corridor round an axis, with places as close as the swath asks for."""
        coords = np.asarray(axis.coords, dtype=np.float64)[:, :2]
        outline = shapely.points(shapely.get_coordinates(area))
        half_m = WIDER * float(shapely.distance(outline, axis).max())
        step_m = max(FINE * max(swath_m - 2.0 * half_m, FINE * swath_m), axis.length / MOST_PLACES)
        along_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(coords, axis=0).T))])
        places_m = np.linspace(0.0, along_m[-1], max(math.ceil(along_m[-1] / step_m), 2) + 1)
        # Close to a vertex the vertex is taken: at bends pieces rather end.
        nearest_m = along_m[np.abs(along_m[None, :] - places_m[:, None]).argmin(axis=1)]
        places_m = np.unique(np.where(np.abs(nearest_m - places_m) < step_m / 2.0, nearest_m, places_m))
        all_m = np.union1d(along_m, places_m)
        every = np.stack([np.interp(all_m, along_m, column) for column in coords.T], axis=1)
        at = np.searchsorted(all_m, places_m)
        runs = tuple(every[first : last + 1] for first, last in itertools.pairwise(at))
        line = np.concatenate([coords, coords[1:], coords[1:]]) if axis.is_closed else coords
        return cls(area, half_m, LineString(line), float(along_m[-1]), places_m, runs, bool(axis.is_closed))

    def division(self, pieces: Iterable[Piece]) -> tuple[Polygon, ...] | None:
        """The ground of pieces that follow each other; None where that is not all of the corridor."""
        found = [self.ground(piece) for piece in pieces]
        seen = shapely.union_all(found, grid_size=1e-6).buffer(SLIVER_M)
        rest = shapely.difference(self.area, seen, grid_size=1e-6)
        # At a cut in a bend its outside may be left over.
        for wedge in shapely.get_parts(rest):
            nearest = int(np.argmin(shapely.distance(found, wedge)))
            wide = wedge.buffer((WIDER - 1.0) * self.half_m)
            found[nearest] = self._inside(shapely.union_all([found[nearest], wide], grid_size=1e-6))
        whole = shapely.union_all(found, grid_size=1e-6).buffer(2.0 * SLIVER_M)
        return tuple(found) if whole.covers(self.area) else None

    def ground(self, piece: Piece) -> Polygon:
        """The ground of a piece, reaching a metre over its cuts."""
        count = len(self.runs)
        begin_m, end_m = (
            float(self.places_m[place % count]) + place // count * self.length_m for place in piece
        )
        if self.closed:
            begin_m, end_m = begin_m + self.length_m, end_m + self.length_m
        part = substring(self.line, max(begin_m - OVERLAP_M, 0.0), end_m + OVERLAP_M)
        return self._inside(part.buffer(self.half_m, cap_style="flat"))

    def _inside(self, wide: BaseGeometry) -> Polygon:
        """What of a shape is in the corridor; its largest part where only those touch."""
        found = shapely.get_parts(shapely.intersection(self.area, wide, grid_size=1e-6))
        return max((one for one in found if isinstance(one, Polygon)), key=lambda one: float(one.area))


@dataclass(frozen=True, slots=True)
class Pieces:
    """How long pieces of a corridor are.

    Parameters
    ----------
    fewest
        Strips that the corridor's width alone takes.
    lengths_m
        (N, P, P): of the piece from a place on, by its number of runs less one, along the best heading at
        which so many strips more than the fewest hold it; inf where they do not.
    """

    fewest: int
    lengths_m: Floats

    @classmethod
    def of(cls, corridor: Corridor, swaths: Swaths, headings_rad: Floats | None) -> Pieces:
        """The pieces of a corridor.

        Parameters
        ----------
        swaths
            Width of the swath at headings.
        headings_rad
            Those allowed; None for any.
        """
        angles_rad = np.arange(0.0, math.pi - 1e-9, STEP_RAD) if headings_rad is None else headings_rad
        swath_m = np.maximum(swaths(angles_rad), 1e-9)
        fewest = max(math.ceil((2.0 * corridor.half_m - ROUNDING_M) / float(swath_m.max())), 1)
        spans = [spans_at(run, angles_rad) for run in corridor.runs]
        low = [np.stack([getattr(span, f"{axis}_min_m") for span in spans]) for axis in "xy"]
        high = [np.stack([getattr(span, f"{axis}_max_m") for span in spans]) for axis in "xy"]
        count = len(corridor.runs)
        lengths_m = np.full((MORE_PASSES + 1, count, count), math.inf)
        for begin in range(count):
            rows = np.arange(begin, begin + count if corridor.closed else count) % count
            along_m, across_m = (
                np.maximum.accumulate(top[rows], axis=0) - np.minimum.accumulate(bottom[rows], axis=0)
                for bottom, top in zip(low, high, strict=True)
            )
            ends_m = np.stack([corridor.runs[row][-1] for row in rows]) - corridor.runs[begin][0]
            # Flown across, a piece is short; to the next one it is as far as along it all the same.
            along_m = np.maximum(along_m, np.hypot(*ends_m.T)[:, None])
            strips = (across_m + 2.0 * corridor.half_m - ROUNDING_M) / swath_m
            for more in range(MORE_PASSES + 1):
                held_m = np.where(strips <= fewest + more, along_m, math.inf)
                lengths_m[more, begin, : len(rows)] = held_m.min(axis=1)
            if headings_rad is not None:
                continue
            # Between two headings a strip may be narrower than at either, by the length that it turns.
            nearly = (strips - along_m * STEP_RAD / 2.0 / swath_m).min(axis=1) <= fewest
            fits, reach = int((strips.min(axis=1) <= fewest).sum()), int(nearly.sum())
            while fits < reach:
                middle = (fits + reach + 1) // 2
                points_m = np.concatenate([corridor.runs[row] for row in rows[:middle]])
                if _fewest_swaths(points_m, corridor.half_m, swaths) <= fewest:
                    fits = middle
                else:
                    reach = middle - 1
            best = strips[:fits].argmin(axis=1)[:, None]
            length_m = np.take_along_axis(along_m[:fits], best, axis=1)[:, 0]
            lengths_m[0, begin, :fits] = np.minimum(lengths_m[0, begin, :fits], length_m)
        return cls(fewest, lengths_m)

    def cheapest(
        self, between_m: float, barred: Iterable[Piece] = (), *, closed: bool
    ) -> tuple[Piece, ...] | None:
        """The pieces that a corridor is seen in at the least cost; None where it cannot be.

        Parameters
        ----------
        between_m
            What each pass costs besides the length of its piece.
        barred
            Pieces that may not be, nor any that holds one of them.
        closed
            Whether the corridor's line closes upon itself.
        """
        strips = self.fewest + np.arange(len(self.lengths_m))
        costs_m = (strips[:, None, None] * (self.lengths_m + between_m)).min(axis=0)
        count = len(costs_m)
        for first, last in barred:
            for sooner in range(count):
                if closed or sooner <= first:
                    costs_m[(first - sooner) % count, last - first - 1 + sooner :] = math.inf
        # From some place before the end of the first piece the best cut of a closed line begins.
        reach = max(int(np.isfinite(costs_m[0]).sum()) - 1, 0) if closed else 0
        beginnings = np.unique(np.linspace(0, reach, MOST_BEGINNINGS).astype(np.int64))
        found = [_least(costs_m, int(begin)) for begin in beginnings]
        cost_m, pieces = min(found, key=lambda each: each[0])
        return pieces if math.isfinite(cost_m) else None


def _fewest_swaths(points_m: Floats, half_m: float, swaths: Swaths) -> float:
    """Swaths, not rounded up, that hold points and so much round them: across an edge of their hull."""
    hull_m = hull_points(shapely.MultiPoint(points_m))
    east_m, north_m = np.diff(hull_m, axis=0).T
    angles_rad = np.arctan2(north_m, east_m)
    across_m = spans_at(hull_m, angles_rad).across_m + 2.0 * half_m - ROUNDING_M
    return float((across_m / np.maximum(swaths(angles_rad), 1e-9)).min())


def _least(costs_m: Floats, begin: int) -> tuple[float, tuple[Piece, ...]]:
    """The cheapest pieces from a place on to the end, or once round to it again."""
    count = len(costs_m)
    best_m = np.full(count + 1, math.inf)
    before = np.zeros(count + 1, dtype=np.int64)
    best_m[0] = 0.0
    for place in range(count):
        reached_m = best_m[place] + costs_m[(begin + place) % count, : count - place]
        better = reached_m < best_m[place + 1 :]
        best_m[place + 1 :][better] = reached_m[better]
        before[place + 1 :][better] = place
    if not math.isfinite(best_m[-1]):
        return math.inf, ()
    pieces: list[Piece] = []
    end = count
    while end > 0:
        pieces.append((begin + int(before[end]), begin + end))
        end = int(before[end])
    return float(best_m[-1]), tuple(reversed(pieces))
