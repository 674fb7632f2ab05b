"""Sweeps at one heading that see all ground: level ones, then always the lowest ground left unseen."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely
from numpy.typing import NDArray

from planner.coverage.urban.columns_kernels import intervals, left_over, level_sweeps
from planner.coverage.urban.frontier_kernels import frontier_sweeps
from planner.coverage.urban.lanes_kernels import clip_rows

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Columns are no wider than this part of a footprint's width.
COLUMN = 1.0 / 3.0
#: Corners nearer to each other than this along the sweeps bound one column.
SAME_M = 1e-4
#: A place to look from is flown over for so long.
LEAST_M = 1e-3


@dataclass(frozen=True, slots=True)
class Manner:
    """How sweeps are laid at a heading.

    Parameters
    ----------
    level
        Where the lowest of a row of sweeps a footprint apart lies, in widths of the footprint over the lowest
        ground, what they leave being seen after; None to see all from below upwards.
    gap
        Over how much that needs no sweep one is flown on, in widths.
    bent
        How much less than its need a sweep may see of a column that it is flown on through, in widths.
    """

    level: float | None = None
    gap: float = 1.0
    bent: float = 0.5


@dataclass(frozen=True, slots=True)
class Frontier:
    """Ground in columns at one heading: see ``columns_kernels``.

    Parameters
    ----------
    angle_rad
        The heading.
    downwards
        Whether the highest ground comes first.
    borders
        Of columns.
    unseen, offsets
        Intervals to be seen.
    middles, ways
        What is free in the columns' middles.
    """

    angle_rad: float
    downwards: bool
    borders: Floats
    unseen: Floats
    offsets: Ints
    middles: Floats
    ways: Ints

    @classmethod
    def of(
        cls, edges: Floats, angle_rad: float, downwards: bool, across_m: float, unseen: Floats | None = None
    ) -> Frontier:
        """Columns of ground given by its edges, (E, 4), and of what is to be seen of it, where not all is."""
        there = _turned_edges(edges, angle_rad, downwards)
        if unseen is None:
            borders = _borders(there, across_m * COLUMN)
            ground, middles, ways = intervals(there, borders)
            return cls(angle_rad, downwards, borders, ground, ways, middles, ways)
        turned_unseen = _turned_edges(unseen, angle_rad, downwards)
        borders = _borders(np.vstack([there, turned_unseen]), across_m * COLUMN)
        left, _, offsets = intervals(turned_unseen, borders)
        _, middles, ways = intervals(there, borders)
        return cls(angle_rad, downwards, borders, left, offsets, middles, ways)

    def mirrored(self) -> Frontier:
        """The same ground, its other side first."""
        unseen, middles = _flipped(self.unseen, self.offsets), _flipped(self.middles, self.ways)
        return replace(self, downwards=not self.downwards, unseen=unseen, middles=middles)

    @property
    def height_m(self) -> float:
        """From the lowest ground to the highest."""
        return float(self.unseen[:, 1].max() - self.unseen[:, 0].min())

    def laid(
        self, across_m: float, along_m: float, manner: Manner, each_m: float = 0.0, most_m: float = math.inf
    ) -> Laid:
        """Sweeps that see all; those of no length are places to look from once.

        They need not see all where they cost more than ``most_m``, each ``each_m`` besides its length.
        """
        left, left_offsets = self.unseen, self.offsets
        found = np.empty((0, 5))
        if manner.level is not None:
            lowest_m = float(self.unseen[:, 0].min()) + manner.level * across_m
            found = level_sweeps(
                self.unseen, self.offsets, self.middles, self.ways, self.borders, across_m, along_m, lowest_m
            )
            left, left_offsets = left_over(self.unseen, self.offsets, found, across_m)
            most_m -= float((found[:, 1] - found[:, 0]).sum()) + each_m * len(found)
        more = frontier_sweeps(
            left,
            left_offsets,
            self.middles,
            self.ways,
            self.borders,
            across_m,
            along_m,
            manner.gap * across_m,
            manner.bent * across_m,
            each_m,
            most_m,
        )
        rows = np.concatenate([found, more])[:, :3]
        return Laid(self.angle_rad, rows * np.array([1.0, 1.0, -1.0]) if self.downwards else rows)


@dataclass(frozen=True, slots=True)
class Laid:
    """Sweeps at one heading.

    Parameters
    ----------
    angle_rad
        The heading.
    rows
        float64 (N, 3): where each begins and ends along the heading, and how far to its left it lies.
    """

    angle_rad: float
    rows: Floats

    @property
    def lengths_m(self) -> Floats:
        """Of each."""
        lengths: Floats = self.rows[:, 1] - self.rows[:, 0]
        return lengths

    def lines(self) -> Floats:
        """From the first end to the last, (N, 2, 2)."""
        ends = [turned(self.rows[:, [k, 2]], self.angle_rad) for k in (0, 1)]
        return np.stack(ends, axis=1)

    def strips(self, across_m: float, along_m: float) -> NDArray[np.object_]:
        """Ground seen from each: a frame sees half its length beyond its ends."""
        return strips(self.angle_rad, self.rows, across_m, 0.5 * along_m)

    def only(self, which: NDArray[np.bool_]) -> Laid:
        """Some of them."""
        return Laid(self.angle_rad, self.rows[which])

    def within(self, grown: Floats, across_m: float, along_m: float) -> tuple[Laid, NDArray[np.object_]]:
        """What of them runs through ground, and shapes of what those parts do not see any more.

        Parameters
        ----------
        grown
            Edges of the ground, (E, 4), a little outside of it: lines along an edge are within.
        """
        parts, lost = clip_rows(
            _turned_edges(grown, self.angle_rad, False), self.rows, 0.5 * along_m, LEAST_M
        )
        return Laid(self.angle_rad, parts), strips(self.angle_rad, lost, across_m, 0.0)


def strips(angle_rad: float, rows: Floats, across_m: float, more_m: float) -> NDArray[np.object_]:
    """Rectangles about level lines at a heading, so much longer at both ends."""
    west, east = rows[:, 0] - more_m, rows[:, 1] + more_m
    low, high = rows[:, 2] - 0.5 * across_m, rows[:, 2] + 0.5 * across_m
    corners = [(west, low), (east, low), (east, high), (west, high)]
    rings = np.stack([turned(np.column_stack(corner), angle_rad) for corner in corners], axis=1)
    return np.asarray(shapely.polygons(rings), dtype=object)


def _flipped(rows: Floats, offsets: Ints) -> Floats:
    """Intervals of columns, mirrored, again from below upwards."""
    columns = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    places = np.arange(len(rows))
    flipped: Floats = -rows[offsets[columns] + offsets[columns + 1] - 1 - places][:, ::-1]
    return flipped


def _turned_edges(edges: Floats, angle_rad: float, downwards: bool) -> Floats:
    """Edges turned so that a heading is the first axis, and mirrored about it where asked for."""
    there = np.hstack([turned(edges[:, :2], -angle_rad), turned(edges[:, 2:], -angle_rad)])
    return there * np.array([1.0, -1.0, 1.0, -1.0]) if downwards else there


def _borders(there: Floats, wide_m: float) -> Floats:
    """Borders of columns: at all corners, and between them."""
    corners = np.unique(there[:, [0, 2]])
    corners = corners[np.append(True, np.diff(corners) > SAME_M)]
    parts = np.maximum(np.ceil(np.diff(corners) / wide_m), 1.0).astype(np.int64)
    which = np.repeat(np.arange(len(parts)), parts)
    step = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
    borders = corners[which] + (np.diff(corners) / parts)[which] * step
    return np.append(borders, corners[-1])


def turned(places: Floats, angle_rad: float) -> Floats:
    """Places turned about the origin."""
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    return np.column_stack(
        [cosine * places[:, 0] - sine * places[:, 1], sine * places[:, 0] + cosine * places[:, 1]]
    )
