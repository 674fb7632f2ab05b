"""Sweeps at one heading that see all ground: level ones, then always the lowest ground left unseen."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from planner.coverage.urban.columns_kernels import intervals, left_over, level_sweeps
from planner.coverage.urban.frontier_kernels import frontier_sweeps

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Columns are no wider than this part of a footprint's width.
COLUMN = 1.0 / 3.0
#: Corners nearer to each other than this along the sweeps bound one column.
SAME_M = 1e-4
#: A place to look from is flown over for so long.
LEAST_M = 1e-3
#: Lines this far outside of the ground run along its edge.
EDGE_M = 1e-5
#: Overlays snap to this grid.
GRID_M = 1e-6


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
        turned = _turned_edges(edges, angle_rad, downwards)
        if unseen is None:
            borders = _borders(turned, across_m * COLUMN)
            ground, middles, ways = intervals(turned, borders)
            return cls(angle_rad, downwards, borders, ground, ways, middles, ways)
        turned_unseen = _turned_edges(unseen, angle_rad, downwards)
        borders = _borders(np.vstack([turned, turned_unseen]), across_m * COLUMN)
        left, _, offsets = intervals(turned_unseen, borders)
        _, middles, ways = intervals(turned, borders)
        return cls(angle_rad, downwards, borders, left, offsets, middles, ways)

    @property
    def height_m(self) -> float:
        """From the lowest ground to the highest."""
        return float(self.unseen[:, 1].max() - self.unseen[:, 0].min())

    def lines(self, across_m: float, along_m: float, manner: Manner) -> Floats:
        """Lines flown, float64 (N, 2, 2); those of no length are places to look from once."""
        left, left_offsets = self.unseen, self.offsets
        found = np.empty((0, 5))
        if manner.level is not None:
            lowest_m = float(self.unseen[:, 0].min()) + manner.level * across_m
            found = level_sweeps(
                self.unseen, self.offsets, self.middles, self.ways, self.borders, across_m, along_m, lowest_m
            )
            left, left_offsets = left_over(self.unseen, self.offsets, found, across_m)
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
        )
        found = np.concatenate([found, more])
        north = -found[:, 2] if self.downwards else found[:, 2]
        ends = [_turned(np.column_stack([found[:, k], north]), self.angle_rad) for k in (0, 1)]
        return np.stack(ends, axis=1)


def seen_from(lines: Floats, across_m: float, along_m: float, angle_rad: float) -> BaseGeometry:
    """Ground seen from lines at a heading: a frame sees half its length beyond their ends."""
    ahead = np.array([math.cos(angle_rad), math.sin(angle_rad)])
    side = 0.5 * across_m * np.array([-ahead[1], ahead[0]])
    forward = np.where(((lines[:, 1] - lines[:, 0]) @ ahead) < 0.0, -1.0, 1.0)[:, None] * ahead
    first, last = lines[:, 0] - 0.5 * along_m * forward, lines[:, 1] + 0.5 * along_m * forward
    rings = np.stack([first - side, last - side, last + side, first + side], axis=1)
    seen: BaseGeometry = shapely.union_all(shapely.polygons(rings), grid_size=GRID_M)
    return seen


def _turned_edges(edges: Floats, angle_rad: float, downwards: bool) -> Floats:
    """Edges turned so that a heading is the first axis, and mirrored about it where asked for."""
    turned = np.hstack([_turned(edges[:, :2], -angle_rad), _turned(edges[:, 2:], -angle_rad)])
    return turned * np.array([1.0, -1.0, 1.0, -1.0]) if downwards else turned


def _borders(turned: Floats, wide_m: float) -> Floats:
    """Borders of columns: at all corners, and between them."""
    corners = np.unique(turned[:, [0, 2]])
    corners = corners[np.append(True, np.diff(corners) > SAME_M)]
    parts = np.maximum(np.ceil(np.diff(corners) / wide_m), 1.0).astype(np.int64)
    which = np.repeat(np.arange(len(parts)), parts)
    step = np.arange(len(which)) - np.repeat(np.cumsum(parts) - parts, parts)
    borders = corners[which] + (np.diff(corners) / parts)[which] * step
    return np.append(borders, corners[-1])


def _turned(places: Floats, angle_rad: float) -> Floats:
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    return np.column_stack(
        [cosine * places[:, 0] - sine * places[:, 1], sine * places[:, 0] + cosine * places[:, 1]]
    )


def clipped(lines: Floats, ground: BaseGeometry, angle_rad: float) -> Floats:
    """The parts of lines at a heading that run through ground, (M, 2, 2), each a little long at least."""
    half = 0.5 * LEAST_M * np.array([math.cos(angle_rad), math.sin(angle_rad)])
    short = np.hypot(*(lines[:, 1] - lines[:, 0]).T) < LEAST_M
    middles = lines.mean(axis=1)
    lines = np.where(short[:, None, None], np.stack([middles - half, middles + half], axis=1), lines)
    ground = ground.buffer(EDGE_M, join_style="mitre")
    shapely.prepare(ground)
    shapes = np.asarray(shapely.linestrings(lines))
    good = shapely.covers(ground, shapes)
    rows = [lines[good]]
    rows += [np.array([part]) for line in shapes[~good] for part in _inside(line, ground)]
    return np.concatenate(rows)


def _inside(line: BaseGeometry, ground: BaseGeometry) -> Iterator[Floats]:
    for part in shapely.get_parts(shapely.intersection(line, ground)):
        if part.length >= 0.5 * LEAST_M:
            yield shapely.get_coordinates(part)[[0, -1]]
