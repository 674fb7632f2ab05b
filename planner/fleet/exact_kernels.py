"""Compiled enumeration of all trips of one aircraft that no other trip of the same jobs beats.

Labels over sets of jobs (M. Held and R. Karp 1962, with the dominance of M. Desrochers 1988): two ways to
have done the same jobs and be at the same node are told apart only by what may still matter, the least
duration, the earliest end, the latest start, the price and what the limits count.
"""

from __future__ import annotations

import math

import numpy as np

from planner.fleet.auto.tables import (
    ENERGY,
    FLIGHT,
    RANGE,
    READY,
    SHIFT_END,
    WAITING,
    Costs,
    Crew,
    Floats,
    Ints,
    Jobs,
)
from planner.fleet.auto.times_kernels import EPSILON, join
from planner.jit import njit

#: Columns of a label.
SPAN, EARLY, LATE, PRICE, LENGTH, USED = range(6)


@njit(cache=True, nogil=True)
def _beats(a: Floats, b: Floats) -> bool:
    """Whether whatever can follow ``b`` can follow ``a`` at no more cost."""
    if a[EARLY] + a[SPAN] > b[EARLY] + b[SPAN] + EPSILON or a[LATE] < b[LATE] - EPSILON:
        return False
    if a[SPAN] > b[SPAN] + EPSILON or a[PRICE] > b[PRICE] + EPSILON:
        return False
    return not (a[LENGTH] > b[LENGTH] + EPSILON or a[USED] > b[USED] + EPSILON)


@njit(cache=True, nogil=True)
def trips(
    jobs: Jobs, costs: Costs, crew: Crew, m: int, labels: Floats, links: Ints, heads: Ints, ends: Floats
) -> int:
    """Fill the labels of member ``m``; returns how many, or −1 where they do not fit.

    Parameters
    ----------
    labels
        (K, 6), to be filled: ``SPAN`` … ``USED``.
    links
        (K, 4), to be filled: node, label before, next label of the same set and node, 1 where beaten.
    heads
        (2^J, N) of −1, to be filled: the first label of a set and node.
    ends
        (K, E, 2), to be filled: duration and landing at each base it may land at, infinite where it cannot.
    """
    p = crew.profile[m]
    limits = crew.limits[m]
    wait_wh = limits[WAITING] / 3600.0
    counts_length = limits[RANGE] < math.inf
    counts_energy = limits[ENERGY] < math.inf
    total = jobs.prize.shape[0]
    used = 0
    fresh = np.empty(6)
    for done in range(heads.shape[0]):
        for at in range(heads.shape[1]):
            here = heads[done, at] if done > 0 else -2
            if done == 0 and at != crew.start[m]:
                continue
            while here != -1:
                if here >= 0 and links[here, 3] == 1:
                    here = links[here, 2]
                    continue
                for v in range(jobs.first[0], jobs.first[total]):
                    j = jobs.of[v]
                    service = costs.service[p, v]
                    if done >> j & 1 or not service < math.inf:
                        continue
                    if here == -2:
                        d, e, last = 0.0, limits[READY], math.inf
                        fresh[PRICE] = fresh[LENGTH] = fresh[USED] = 0.0
                    else:
                        d, e, last = labels[here, SPAN], labels[here, EARLY], labels[here, LATE]
                        fresh[PRICE:] = labels[here, PRICE:]
                    leg = costs.seconds[p, at, v]
                    d, e, last = join(d, e, last, leg, service, jobs.early[v], jobs.late[v] - service)
                    if not e <= last + EPSILON or not d < math.inf:
                        continue
                    fresh[SPAN], fresh[EARLY], fresh[LATE] = d, e, last
                    fresh[PRICE] += costs.price[p, at, v]
                    if counts_length:
                        fresh[LENGTH] += costs.length[p, at, v]
                    if counts_energy:
                        fresh[USED] += costs.energy[p, at, v] - wait_wh * (leg + service)
                    if (
                        d > limits[FLIGHT] + EPSILON
                        or fresh[LENGTH] > limits[RANGE] + EPSILON
                        or fresh[USED] + wait_wh * d > limits[ENERGY] + EPSILON
                    ):
                        continue
                    grown = done | (1 << j)
                    other = heads[grown, v]
                    beaten = False
                    while other != -1:
                        if links[other, 3] == 0:
                            if _beats(labels[other], fresh):
                                beaten = True
                                break
                            if _beats(fresh, labels[other]):
                                links[other, 3] = 1
                        other = links[other, 2]
                    if beaten:
                        continue
                    if used == labels.shape[0]:
                        return -1
                    labels[used] = fresh
                    links[used, 0], links[used, 1], links[used, 3] = v, here, 0
                    links[used, 2] = heads[grown, v]
                    heads[grown, v] = used
                    used += 1
                if here == -2:
                    break
                here = links[here, 2]
    first = crew.ends_first[m]
    for k in range(used):
        v = links[k, 0]
        for n in range(ends.shape[1]):
            ends[k, n, :] = math.inf
            base = crew.ends[first + n]
            leg = costs.seconds[p, v, base]
            d, e, last = join(
                labels[k, SPAN], labels[k, EARLY], labels[k, LATE], leg, 0.0, 0.0, limits[SHIFT_END]
            )
            length, energy = labels[k, LENGTH], labels[k, USED]
            if counts_length:
                length += costs.length[p, v, base]
            if counts_energy:
                energy += costs.energy[p, v, base] - wait_wh * leg
            if (
                e <= last + EPSILON
                and d < math.inf
                and d <= limits[FLIGHT] + EPSILON
                and length <= limits[RANGE] + EPSILON
                and energy + wait_wh * d <= limits[ENERGY] + EPSILON
            ):
                ends[k, n, 0], ends[k, n, 1] = d, d + e
    return used
