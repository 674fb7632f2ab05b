"""What a side-looking radar sees of a ground profile, compiled: in beam, in shadow, in layover."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.airspace.terrain_kernels import ground_at
from planner.jit import njit

Array = NDArray[np.float64]
Flags = NDArray[np.uint8]

OUT, SEEN, SHADOW, LAYOVER = 0, 1, 2, 3


@njit(cache=True)
def profile_flags(
    level_m: float, out_m: Array, ground_m: Array, near_tan: float, far_tan: float, stretch: float
) -> Flags:
    """What is seen of one profile.

    A place at distance y over ground z is seen under the look angle θ = atan(y / (H − z)) and the slant range
    R = √(s²y² + (H − z)²). It is in the beam between the edges' angles; in shadow where a nearer place has a
    larger angle; in layover where another lit place of the beam has its range: one nearer with R as large or
    one farther with R as small (Cumming and Wong 2005, section 1.3; Moreira et al. 2013, section II).

    Parameters
    ----------
    level_m
        H, of the flight, over the datum of the ground.
    out_m, ground_m
        y, increasing from the track, and z; float64 (N,). NaN ground is not seen and hides nothing.
    near_tan, far_tan
        Tangents of the edges' look angles.
    stretch
        s: how much longer the ray's way over ground is than y, for a squinted beam.

    Returns
    -------
    ndarray
        uint8 (N,): 0 out of the beam or unknown, 1 seen, 2 in shadow, 3 in layover.
    """
    count = len(out_m)
    flags = np.zeros(count, dtype=np.uint8)
    steepest = -math.inf
    for j in range(count):
        if math.isnan(ground_m[j]):
            continue
        drop_m = level_m - ground_m[j]
        tangent = out_m[j] / drop_m if drop_m > 0.0 else math.inf
        if near_tan <= tangent <= far_tan:
            flags[j] = SEEN if tangent > steepest else SHADOW
        steepest = max(steepest, tangent)
    longest_m = -math.inf
    for j in range(count):
        if flags[j] == SEEN:
            range_m = math.hypot(stretch * out_m[j], level_m - ground_m[j])
            if range_m <= longest_m:
                flags[j] = LAYOVER
            longest_m = max(longest_m, range_m)
    shortest_m = math.inf
    for j in range(count - 1, -1, -1):
        if flags[j] == SEEN or flags[j] == LAYOVER:
            range_m = math.hypot(stretch * out_m[j], level_m - ground_m[j])
            if range_m >= shortest_m:
                flags[j] = LAYOVER
            shortest_m = min(shortest_m, range_m)
    return flags


@njit(cache=True)
def lead_m(out_m: float, drop_m: float, squint_tan: float, yaw_rad: float) -> float:
    """How far ahead of the aircraft a place is seen, from its distance beside the track and its drop.

    Of y = y_b cos ψ − x_b sin ψ, x_b = √(y_b² + d²) tan θ_sq, the root y_b; then y_b sin ψ + x_b cos ψ.
    """
    if yaw_rad == 0.0:
        return math.hypot(out_m, drop_m) * squint_tan
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    side = squint_tan * sin
    rest = cos * cos - side * side
    beside_m = (cos * out_m + side * math.sqrt(out_m * out_m + rest * drop_m * drop_m)) / rest
    return beside_m * sin + math.hypot(beside_m, drop_m) * squint_tan * cos


@njit(cache=True)
def strip_flags(
    heights_m: Array,
    west_m: float,
    south_m: float,
    step_m: float,
    pose: Array,
    along_m: Array,
    out_m: Array,
    level_m: float,
    near_tan: float,
    far_tan: float,
    squint_tan: float,
    yaw_rad: float,
) -> tuple[Flags, Array]:
    """Flags and ground of a strip's cells.

    Parameters
    ----------
    heights_m, west_m, south_m, step_m
        The ground's grid; see ``Ground``.
    pose
        East, north of the line's start; unit vectors ahead and to the look side: float64 (6,).
    along_m, out_m
        Of the cells' middles: along the line from its start (X,), away from it (Y,).
    squint_tan
        Tangent of the squint angle: a place is seen from R·tan ahead of or behind the line's foot, R being
        its slant range abeam. Each such place then has a profile of its own, along the ray to it.
    yaw_rad
        How far the antenna is turned forward off abeam, about the vertical; ``near_tan`` and ``far_tan`` are
        those beside the track.

    Returns
    -------
    flags : ndarray
        uint8 (X, Y); see ``profile_flags``.
    ground : ndarray
        float64 (X, Y).
    """
    flags = np.zeros((len(along_m), len(out_m)), dtype=np.uint8)
    ground = np.empty((len(along_m), len(out_m)))
    for i in range(len(along_m)):
        for j in range(len(out_m)):
            e_m = pose[0] + along_m[i] * pose[2] + out_m[j] * pose[4]
            n_m = pose[1] + along_m[i] * pose[3] + out_m[j] * pose[5]
            ground[i, j] = ground_at(heights_m, west_m, south_m, step_m, e_m, n_m)
        if squint_tan == 0.0 and yaw_rad == 0.0:
            flags[i] = profile_flags(level_m, out_m, ground[i], near_tan, far_tan, 1.0)
            continue
        profile = np.empty(len(out_m))
        for j in range(len(out_m)):
            if math.isnan(ground[i, j]):
                continue
            drop_m = level_m - ground[i, j]
            tangent = out_m[j] / drop_m if drop_m > 0.0 else math.inf
            if not near_tan <= tangent <= far_tan:
                continue
            ahead_m = lead_m(out_m[j], drop_m, squint_tan, yaw_rad)
            for k in range(len(out_m)):
                at_m = along_m[i] - ahead_m * (1.0 - out_m[k] / out_m[j])
                e_m = pose[0] + at_m * pose[2] + out_m[k] * pose[4]
                n_m = pose[1] + at_m * pose[3] + out_m[k] * pose[5]
                profile[k] = ground_at(heights_m, west_m, south_m, step_m, e_m, n_m)
            profile[j] = ground[i, j]
            stretch = math.hypot(1.0, ahead_m / out_m[j])
            flags[i, j] = profile_flags(level_m, out_m, profile, near_tan, far_tan, stretch)[j]
    return flags, ground
