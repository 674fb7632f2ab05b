"""Passes of one region parted by other regions where the whole tour gets shorter.

The tour has been chosen with all passes of a region one after the other. Each pass alone, or a run of a few,
is put elsewhere in the tour; straight-line differences say where it may pay, the transit stage's own lines
whether it does.
"""

from __future__ import annotations

import itertools
import math

from planner.progress import Stop, raise_if
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


def split_passes(cost_m: float, passes: Passes, legs: Legs, stop: Stop) -> tuple[float, Passes]:
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
        trials = sorted(_moves(passes), key=lambda move: move[0])[:TRIED]
        best = (cost_m - LEAST_GAIN_M, passes)
        for _, trial in trials:
            best = min(best, (legs.tour_m(trial), trial), key=lambda found: found[0])
        if best[1] is passes:
            break
        cost_m, passes = best
    return cost_m, passes


def _moves(passes: Passes) -> list[tuple[float, Passes]]:
    """Orders one move away, with what they save along straight lines (less than nothing is a gain)."""
    moves = []
    several = [any(other is not one and other.regions == one.regions for other in passes) for one in passes]
    for first in range(len(passes)):
        for last in range(first + 1, min(first + LONGEST, len(passes)) + 1):
            run, rest = passes[first:last], passes[:first] + passes[last:]
            if not any(several[first:last]):
                continue
            for at in range(len(rest) + 1):
                if at == first:
                    continue
                trial = rest[:at] + run + rest[at:]
                moves.append((_straight_m(trial) - _straight_m(passes), trial))
    return moves


def _straight_m(passes: Passes) -> float:
    """Straight distances between passes; the ways from the start and to the end are left to the judgement."""
    return math.fsum(
        math.dist(leaves(one).position, other.start) for one, other in itertools.pairwise(passes)
    )
