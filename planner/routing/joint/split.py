"""Passes of one region parted by other regions where the whole tour gets shorter.

The tour has been chosen with all passes of a region one after the other. Each pass alone, or a run of a few,
is put elsewhere in the tour; straight-line differences say where it may pay, the transit stage's own lines
whether it does.
"""

from __future__ import annotations

from collections import Counter

import numpy as np

from planner.progress import Stop, never, raise_if
from planner.route import CollectPass
from planner.routing.legs import Legs, leaves

#: Passes moved together at most.
LONGEST = 3
#: Moves flown in earnest in each round, the most promising first; rounds.
TRIED = 6
ROUNDS = 8
#: A move has to save this much.
LEAST_GAIN_M = 0.5

Passes = tuple[CollectPass, ...]


def split_passes(
    cost_m: float, passes: Passes, legs: Legs, stop: Stop, enough: Stop = never
) -> tuple[float, Passes]:
    """The tour with runs of passes moved as long as that makes it truly cheaper.

    Only runs out of regions with several passes are moved: with whole regions the search has been over all
    orders already.

    Returns
    -------
    tuple
        True cost in metres, and the passes in flight order.
    """
    for _ in range(ROUNDS):
        raise_if(stop)
        if enough():
            break
        trials = sorted(_moves(passes), key=lambda move: move[0])[:TRIED]
        best = (cost_m - LEAST_GAIN_M, passes)
        for _, first, last, at in trials:
            run, rest = passes[first:last], passes[:first] + passes[last:]
            trial = rest[:at] + run + rest[at:]
            best = min(best, (legs.tour_m(trial), trial), key=lambda found: found[0])
        if best[1] is passes:
            break
        cost_m, passes = best
    return cost_m, passes


def _moves(passes: Passes) -> list[tuple[float, int, int, int]]:
    """Orders one move away: what they save along straight lines (less than nothing is a gain), which run of
    passes moves, and where among the others to.

    Straight distances are those between passes; the ways from the start and to the end are left to the
    judgement.
    """
    moves: list[tuple[float, int, int, int]] = []
    count = len(passes)
    shared = Counter(one.regions for one in passes)
    several = [shared[one.regions] > 1 for one in passes]
    ends = np.array([leaves(one).position for one in passes])
    begins = np.array([one.start for one in passes])
    # Before the first and after the last pass nothing is counted: a row and a column of zeros.
    apart_m = np.zeros((count + 1, count + 1))
    apart_m[:count, :count] = np.hypot(*(begins[None] - ends[:, None]).transpose(2, 0, 1))
    for first in range(count):
        for last in range(first + 1, min(first + LONGEST, count) + 1):
            if not any(several[first:last]):
                continue
            rest = [*range(first), *range(last, count)]
            before, after = np.array([count, *rest]), np.array([*rest, count])
            out_m = apart_m[first - 1, last] if first > 0 and last < count else 0.0
            out_m -= apart_m[first - 1, first] if first > 0 else 0.0
            out_m -= apart_m[last - 1, last] if last < count else 0.0
            saved_m = out_m + apart_m[before, first] + apart_m[last - 1, after] - apart_m[before, after]
            moves.extend((float(m), first, last, at) for at, m in enumerate(saved_m) if at != first)
    return moves
