"""Compiled turns between parallel lanes: reckoned only where one that is known to be as short is not at hand.

A lane n has B states, n·B and on. Ends of states are float64 (S, 12), see ``ENTRY`` and ``EXIT``; discs
float64 (K, 3) or as in ``planner.airspace.barriers``. Turns are (S, 2 · reach + 1, B): from a state to those
of the lane ``reach`` before its own, and so on to those of the lane ``reach`` after.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from planner.dubins.estimate_kernels import detour_m
from planner.dubins.kernels import dubins_length_by_sines
from planner.jit import njit

Floats = NDArray[np.float64]

#: Where an end's east_m, north_m, angle_rad, sine and cosine of it, and cost of too little room begin.
ENTRY, EXIT, END = 0, 6, 12
#: A turn that is not known yet.
UNKNOWN = -1.0
#: Sine of the angle between headings that are parallel; rounding does not put a bound over the truth by more.
PARALLEL, SLACK = 1e-12, 1.0 - 1e-9


@njit(cache=True)
def ends_of(entries: Floats, exits: Floats, cramped_m: Floats) -> Floats:
    """Both ends of states, (S, 12), of poses (S, 3) and what want of room costs there, (S, 2)."""
    ends = np.empty((len(entries), END))
    for i in range(len(entries)):
        for at, pose in ((ENTRY, entries[i]), (EXIT, exits[i])):
            ends[i, at : at + 3] = pose
            ends[i, at + 3] = math.sin(pose[2])
            ends[i, at + 4] = math.cos(pose[2])
        ends[i, ENTRY + 5] = cramped_m[i, 0]
        ends[i, EXIT + 5] = cramped_m[i, 1]
    return ends


@njit(cache=True)
def turn_m(ends: Floats, i: int, j: int, radius_m: float, discs: Floats) -> float:
    """Length of the turn from state i to state j, with what discs and want of room add."""
    e0, n0, a0, s0, c0, leaving_m = ends[i, EXIT:END]
    e1, n1, a1, s1, c1, coming_m = ends[j, ENTRY:EXIT]
    turn: float = dubins_length_by_sines(e0, n0, a0, s0, c0, e1, n1, a1, s1, c1, radius_m)
    turn += max(leaving_m, coming_m)
    return turn + detour_m(e0, n0, e1, n1, discs) if discs.shape[0] > 0 else turn


@njit(cache=True)
def least_turn_m(across_m: float, radius_m: float) -> float:
    """No turn to the opposite heading so far to a side is shorter, wherever along it ends.

    Of wide ones two quarter turns and a straight; of narrow ones a turn aside by α, and back by π + α, with
    cos α = across / 2r: what is turned away from the lane beside is turned back.
    """
    if across_m >= 2.0 * radius_m:
        return math.pi * radius_m + across_m - 2.0 * radius_m
    return radius_m * (math.pi + 2.0 * math.acos(across_m / (2.0 * radius_m)))


@njit(cache=True)
def least_turns(ends: Floats, own_m: Floats, states: int, reach: int, radius_m: float) -> Floats:
    """No turn from a state to one of a lane so many on is shorter: (2 · reach + 1, B, B), whatever the lane.

    ``own_m`` is inf where a state may not be flown; inf where there is no such turn, too.
    """
    count = len(own_m)
    lanes = count // states
    across = np.full((2 * reach + 1, states, states), np.inf)
    along = np.full((2 * reach + 1, states, states), np.inf)
    opposite = np.ones((states, states), dtype=np.bool_)
    sine, cosine = ends[0, ENTRY + 3], ends[0, ENTRY + 4]
    for i in range(count):
        if not own_m[i] < np.inf:
            continue
        lane, a = divmod(i, states)
        for other in range(max(0, lane - reach), min(lanes, lane + reach + 1)):
            if other == lane:
                continue
            step = other - lane + reach
            for b in range(states):
                j = other * states + b
                if not own_m[j] < np.inf:
                    continue
                e, n = ends[j, ENTRY] - ends[i, EXIT], ends[j, ENTRY + 1] - ends[i, EXIT + 1]
                across[step, a, b] = min(across[step, a, b], abs(cosine * n - sine * e))
                along[step, a, b] = min(along[step, a, b], abs(cosine * e + sine * n))
                s0, c0 = ends[i, EXIT + 3], ends[i, EXIT + 4]
                s1, c1 = ends[j, ENTRY + 3], ends[j, ENTRY + 4]
                aslant = max(abs(s0 * cosine - c0 * sine), abs(s1 * cosine - c1 * sine))
                opposite[a, b] &= aslant < PARALLEL and s0 * s1 + c0 * c1 < 0.0
    least = np.full((2 * reach + 1, states, states), np.inf)
    for step in range(2 * reach + 1):
        for a in range(states):
            for b in range(states):
                if not across[step, a, b] < np.inf:
                    continue
                least[step, a, b] = SLACK * math.hypot(across[step, a, b], along[step, a, b])
                if opposite[a, b]:
                    turn = SLACK * least_turn_m(across[step, a, b], radius_m)
                    least[step, a, b] = max(least[step, a, b], turn)
    return least
