"""How much of a region each of many lines leaves in shadow or layover, compiled; for choosing among them.

The rules are those of ``view_kernels.profile_flags``, asked for one place of each profile alone. Only ground
that could hide the place is looked at: what may stand over its ray, and what may have its range, given the
lowest and the highest ground in reach.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.airspace.terrain_kernels import ground_at, heights_between
from planner.jit import njit
from planner.sensors.view_kernels import lead_m

Array = NDArray[np.float64]

#: Bounds are widened by this against rounding.
SLACK_M = 1e-3


@njit(cache=True)
def _tangent(out_m: float, ground_m: float, level_m: float) -> float:
    """Of the look angle of a sample; -inf where its ground is unknown."""
    if math.isnan(ground_m):
        return -math.inf
    drop_m = level_m - ground_m
    return out_m / drop_m if drop_m > 0.0 else math.inf


@njit(cache=True)
def _shaded(
    heights_m: Array, west_m: float, south_m: float, step_m: float, ray: Array, out_m: float, tangent: float,
    cell_m: float, level_m: float, highest_m: float,
) -> bool:  # fmt: skip
    """Whether a sample nearer than ``out_m`` on the ray has a tangent as large.

    ``ray``, float64 (5,): the place seen (east, north), what a metre outward on the ray is in east and north,
    and how far outward the place is.
    """
    from_m = max(0.0, (level_m - highest_m) * tangent - SLACK_M)
    k = 1
    while out_m - k * cell_m >= from_m:
        at_m = out_m - k * cell_m
        e_m = ray[0] + (at_m - ray[4]) * ray[2]
        n_m = ray[1] + (at_m - ray[4]) * ray[3]
        if _tangent(at_m, ground_at(heights_m, west_m, south_m, step_m, e_m, n_m), level_m) >= tangent:
            return True
        k += 1
    return False


@njit(cache=True)
def line_visibility(
    heights_m: Array,
    west_m: float,
    south_m: float,
    step_m: float,
    poses: Array,
    places_m: Array,
    cell_m: float,
    level_m: float,
    near_tan: Array,
    far_tan: Array,
    squint_tan: float,
    yaw_rad: Array,
) -> Array:
    """Fraction of places hidden, in shadow or layover, from each of several lines.

    A place on a line's other side or out of its beam counts as neither: another pass may be for it.

    Parameters
    ----------
    heights_m, west_m, south_m, step_m
        The ground's grid; see ``Ground``.
    poses
        Starts and unit vectors of the lines as in ``view_kernels.strip_flags``, float64 (L, 6).
    places_m
        float64 (P, 2).
    cell_m
        Distance between samples of the profiles; the place itself is one, they go on half as far beyond it.
    near_tan, far_tan, yaw_rad
        Of each line, as in ``view_kernels.strip_flags``, float64 (L,).
    """
    ground_m = np.empty(len(places_m))
    for p in range(len(places_m)):
        ground_m[p] = ground_at(heights_m, west_m, south_m, step_m, places_m[p, 0], places_m[p, 1])
    hidden = np.zeros(len(poses))
    # What lies between the lines and the places, and half as far beyond: once to bound it, once to look.
    box = np.array([math.inf, math.inf, -math.inf, -math.inf])
    lowest_m, highest_m = math.inf, -math.inf
    ray = np.empty(5)
    for looking in (False, True):
        if looking:
            lowest_m, highest_m = heights_between(heights_m, west_m, south_m, step_m, box)
        for i in range(len(poses)):
            for p in range(len(places_m)):
                z_m = ground_m[p]
                d_e, d_n = places_m[p, 0] - poses[i, 0], places_m[p, 1] - poses[i, 1]
                reach_m = d_e * poses[i, 4] + d_n * poses[i, 5]
                if reach_m <= 0.0 or math.isnan(z_m) or z_m >= level_m:
                    continue
                if not near_tan[i] <= reach_m / (level_m - z_m) <= far_tan[i]:
                    continue
                back = lead_m(reach_m, level_m - z_m, squint_tan, yaw_rad[i]) / reach_m
                ray[0], ray[1] = places_m[p, 0], places_m[p, 1]
                ray[2] = back * poses[i, 2] + poses[i, 4]
                ray[3] = back * poses[i, 3] + poses[i, 5]
                ray[4] = reach_m
                if looking:
                    hidden[i] += _is_hidden(
                        heights_m, west_m, south_m, step_m, ray, z_m, cell_m, level_m, near_tan[i],
                        far_tan[i], math.hypot(1.0, back), lowest_m, highest_m,
                    )  # fmt: skip
                    continue
                beyond_m = 0.5 * reach_m + 3.0 * cell_m
                for away_m in (-reach_m, beyond_m):
                    e_m, n_m = ray[0] + away_m * ray[2], ray[1] + away_m * ray[3]
                    box[0], box[1] = min(box[0], e_m), min(box[1], n_m)
                    box[2], box[3] = max(box[2], e_m), max(box[3], n_m)
    return hidden / max(len(places_m), 1)


@njit(cache=True)
def _is_hidden(
    heights_m: Array, west_m: float, south_m: float, step_m: float, ray: Array, z_m: float, cell_m: float,
    level_m: float, near_tan: float, far_tan: float, stretch: float, lowest_m: float, highest_m: float,
) -> bool:  # fmt: skip
    """Whether the place of a ray is in shadow, or in layover with lit ground nearer or farther."""
    reach_m = ray[4]
    tangent = reach_m / (level_m - z_m)
    if _shaded(
        heights_m, west_m, south_m, step_m, ray, reach_m, tangent, cell_m, level_m, highest_m
    ):  # fmt: skip
        return True
    range_m = math.hypot(stretch * reach_m, level_m - z_m)
    square = range_m * range_m
    deepest_m = level_m - lowest_m
    nearest_m = math.sqrt(max(square - deepest_m * deepest_m, 0.0)) / stretch - SLACK_M
    least_m = max(level_m - highest_m, 0.0)
    farthest_m = math.sqrt(max(square - least_m * least_m, 0.0)) / stretch + SLACK_M
    last = int(reach_m / cell_m)
    beyond = int(0.5 * reach_m / cell_m) + 2
    for side in (-1, 1):
        for k in range(1, (last if side < 0 else beyond) + 1):
            out_m = reach_m + side * k * cell_m
            if (side < 0 and out_m < nearest_m) or (side > 0 and out_m > farthest_m):
                break
            e_m = ray[0] + (out_m - reach_m) * ray[2]
            n_m = ray[1] + (out_m - reach_m) * ray[3]
            other_m = ground_at(heights_m, west_m, south_m, step_m, e_m, n_m)
            other = _tangent(out_m, other_m, level_m)
            if not near_tan <= other <= far_tan:
                continue
            other_range_m = math.hypot(stretch * out_m, level_m - other_m)
            if (side < 0 and other_range_m < range_m) or (side > 0 and other_range_m > range_m):
                continue
            if not _shaded(
                heights_m, west_m, south_m, step_m, ray, out_m, other, cell_m, level_m, highest_m
            ):  # fmt: skip
                return True
    return False
