"""Headings worth laying lanes at: along the ground's edges, and a grid from where it is narrowest."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.coverage.merge import MergedRegion
from planner.coverage.strips.headings import grid, singled_out
from planner.coverage.survey.lanes import Survey, edges_of, lanes_at

Floats = NDArray[np.float64]

#: Of the headings that the ground's shape singles out so many are tried, those with the shortest lanes.
MOST_TELLING = 32
#: Corners of the outline that headings are taken from: beyond, it is thinned.
MOST_EDGES = 400
#: Headings whose lanes are laid to be compared.
MOST_COMPARED = 96
THINNING = 0.002
#: Spacings are looked up between these headings where only the breaks of their number are sought.
TABLE_RAD = np.radians(np.arange(0.0, 180.5, 1.0))


def headings(
    region: MergedRegion, survey: Survey, step_rad: float, turn_m: float, most: int = MOST_TELLING
) -> Floats:
    """The allowed headings; else, of half a circle, a grid and those that the ground singles out.

    Lanes are flown to and fro, so that half a circle has them all.

    Parameters
    ----------
    turn_m
        What a turn from lane to lane is taken to cost.
    most
        Headings besides the grid.
    """
    if region.approach_rad is not None:
        return np.unique(np.mod(np.asarray(region.approach_rad, dtype=np.float64), math.pi))
    own_rad = np.mod(grid(survey.ground, step_rad), math.pi)
    return _distinct(np.concatenate([own_rad, _telling(survey, turn_m, most)]))


def _telling(survey: Survey, turn_m: float, most: int) -> Floats:
    ground = survey.ground
    if len(edges_of(ground)) > MOST_EDGES:
        thinned = ground.simplify(THINNING * math.sqrt(ground.area))
        assert isinstance(thinned, Polygon)
        ground = thinned

    laid = survey.frames(TABLE_RAD)

    def held(at_rad: Floats) -> Floats:
        spacing_m, inset_m = (
            np.interp(np.mod(at_rad, math.pi), TABLE_RAD, table_m)
            for table_m in (laid.spacing_m, laid.inset_m)
        )
        return survey.needed(at_rad, np.asarray(spacing_m), np.asarray(inset_m))

    angles_rad = _distinct(np.mod(singled_out(ground, held), math.pi))
    angles_rad = angles_rad[survey.frames(angles_rad).good]
    counts = survey.counts(angles_rad)
    rough_m = ground.area / survey.frames(angles_rad).spacing_m + counts * turn_m
    angles_rad = angles_rad[np.argsort(rough_m, kind="stable")[:MOST_COMPARED]]
    counts = survey.counts(angles_rad)
    cost_m = np.empty(len(angles_rad))
    for count in np.unique(counts):
        rows = np.flatnonzero(counts == count)
        lines = lanes_at(survey, angles_rad[rows], np.array([0.5]), int(count)).lines[:, 0, :, 0]
        ahead_m = lines[..., 1, :] - lines[..., 0, :]
        cost_m[rows] = np.hypot(ahead_m[..., 0], ahead_m[..., 1]).sum(axis=1) + count * turn_m
    return angles_rad[np.argsort(cost_m, kind="stable")[:most]]


def _distinct(angles_rad: Floats) -> Floats:
    ordered = np.sort(angles_rad)
    return ordered[np.diff(ordered, prepend=-1.0) > 1e-7]
