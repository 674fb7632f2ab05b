"""Approach angles, one region after the other: eq 21 of Li, Chen, Wang, Li (2018)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.coverage.strips.choices import Choices
from planner.route import Anchor

Floats = NDArray[np.float64]

_MIDDLE = np.array([0.5])


def turning_rad(origin: Anchor, lines: Floats) -> Floats:
    """γ + β of figure 10: how far one turns from the last collect into the line to the next, and out of it.

    Parameters
    ----------
    origin
        B of the last collect, or the start. Where its direction is free, γ is 0.
    lines
        Shape (M, 2, 2): start F and end B of the next collect.

    Returns
    -------
    ndarray
        float64, shape (M,), each in [0, 2π].
    """
    across = lines[:, 0, :] - np.array(origin.position)
    bearing_rad = np.arctan2(across[:, 1], across[:, 0])
    ahead = lines[:, 1, :] - lines[:, 0, :]
    angle_rad = np.arctan2(ahead[:, 1], ahead[:, 0])
    # Where the next collect begins at the origin itself there is one turn only.
    touching = np.hypot(across[:, 0], across[:, 1]) == 0.0
    bearing_rad = np.where(touching, angle_rad, bearing_rad)
    gamma_rad = np.zeros_like(bearing_rad)
    if origin.angle_rad is not None:
        gamma_rad = _between(bearing_rad, np.asarray(origin.angle_rad))
    return gamma_rad + _between(angle_rad, bearing_rad)


def best_approach(origin: Anchor, region: Choices) -> tuple[int, int]:
    """Eq 21: the side of view and the feasible angle with the least γ + β.

    Angles are compared at η = 0.5; of a distributed region the first pass decides, the second follows at
    θ + 180°. Only angles at which some η has the region's best grade are feasible here. Among equals the
    nearer line wins, then the first.

    Returns
    -------
    tuple
        Index into ``region.sides`` and of the angle.
    """
    found: list[tuple[float, float, int, int]] = []
    for number, side in enumerate(region.sides):
        lines = side.neighbourhood.lines(_MIDDLE)[:, 0]
        costs_rad = np.round(turning_rad(origin, lines), 9)
        distances_m = np.hypot(*(lines[:, 0, :] - np.array(origin.position)).T)
        open_ = side.grades.reshape(len(lines), -1).min(axis=1) == region.best
        found.extend(
            (float(costs_rad[index]), float(distances_m[index]), number, int(index))
            for index in np.flatnonzero(open_)
        )
    *_, number, index = min(found)
    return number, index


def _between(one_rad: Floats, other_rad: Floats) -> Floats:
    """Unsigned angle between two directions, 0 to π."""
    difference_rad: Floats = np.abs(np.mod(one_rad - other_rad + np.pi, 2.0 * np.pi) - np.pi)
    return difference_rad
