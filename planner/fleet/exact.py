"""The best assignment, proved: every set of jobs for every aircraft, and the best way to share them out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from planner.fleet.auto.search import Found, Tables
from planner.fleet.auto.tables import IDLE, Ints
from planner.fleet.exact_kernels import PRICE, trips
from planner.progress import Stop, raise_if

#: Up to so many jobs, and no more than so many labels of one aircraft.
JOBS, LABELS = 9, 300_000
#: Of so many ways to share jobs out at most the nearly best are looked for.
SHARES = 500_000


#: The jobs of each aircraft in flight order.
Shared = tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class _Way:
    """One aircraft's best for a set of jobs: cost, landing, its nodes."""

    cost: float
    landing_s: float
    nodes: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class _Share:
    """Sets shared out so far: cost, last landing, one way for each aircraft so far."""

    cost: float
    landing_s: float
    ways: tuple[_Way, ...]


def exact(tables: Tables, stop: Stop) -> Found | None:
    """The best solution, or None where the problem is too large, has revisits or further trips."""
    jobs, crew = tables.jobs, tables.crew
    every = _every(tables, stop)
    if every is None:
        return None
    shares: dict[int, list[_Share]] = {0: [_Share(0.0, 0.0, ())]}
    for ways in every:
        raise_if(stop)
        grown: dict[int, list[_Share]] = {}
        for done, former in shares.items():
            for own, choice in ways.items():
                if done & own == 0:
                    grown.setdefault(done | own, []).extend(
                        _Share(a.cost + b.cost, max(a.landing_s, b.landing_s), (*a.ways, b))
                        for a in former
                        for b in choice
                    )
        shares = {done: _best_of(each, tables.weights.landing) for done, each in grown.items()}
    cost, best = min(
        (
            (
                share.cost + tables.weights.landing * share.landing_s + _left(jobs.prize, done),
                share,
            )
            for done, each in shares.items()
            for share in each
        ),
        key=lambda pair: pair[0],
    )
    members = tuple(range(len(crew.profile)))
    return Found(tuple(way.nodes for way in best.ways), members, jobs.early, jobs.late, cost, 0)


def nearly_best(tables: Tables, jobs: int, part: float, most: int, stop: Stop) -> tuple[float, list[Shared]]:
    """Other ways to share some jobs out that cost little more than the best, the cheapest first.

    Of each set of jobs every aircraft has its own best order, and there are no windows.

    Parameters
    ----------
    jobs
        All that are shared out, as a set of bits.
    part
        By how much they may cost more, of the best.
    most
        So many of them at most.

    Returns
    -------
    tuple
        What the best costs, and the jobs of each aircraft in flight order; infinity and none where there are
        too many to look at.
    """
    every = _every(tables, stop)
    if every is None:
        return math.inf, []
    dear = tables.weights.landing
    best = [
        {own: min(ways, key=lambda way: (way.cost, way.landing_s)) for own, ways in of.items()}
        for of in every
    ]
    done = np.zeros(1, dtype=np.int64)
    cost, landing_s, sets = np.zeros(1), np.zeros(1), np.zeros((1, 0), dtype=np.int64)
    for number, of in enumerate(best):
        own = np.array(sorted(each for each in of if each & ~jobs == 0), dtype=np.int64)
        costs, landings_s = (
            np.array([getattr(of[int(e)], name) for e in own]) for name in ("cost", "landing_s")
        )
        free = (done[:, None] & own[None, :]) == 0
        if number == len(best) - 1:
            free &= (done[:, None] | own[None, :]) == jobs
        if free.sum() > SHARES:
            return math.inf, []
        former, taken = np.nonzero(free)
        done, cost = done[former] | own[taken], cost[former] + costs[taken]
        landing_s = np.maximum(landing_s[former], landings_s[taken])
        sets = np.concatenate([sets[former], own[taken][:, None]], axis=1)
    whole = np.round(cost + dear * landing_s, 3)
    if not len(whole):
        return math.inf, []
    order = np.lexsort((*sets.T[::-1], whole))
    order = order[whole[order] <= (1.0 + part) * whole.min()][:most]
    return float(whole.min()), [
        tuple(
            tuple(int(tables.jobs.of[node]) for node in of[int(own)].nodes[1:-1])
            for of, own in zip(best, sets[row], strict=True)
        )
        for row in order
    ]


def _every(tables: Tables, stop: Stop) -> list[dict[int, list[_Way]]] | None:
    """The best ways of each aircraft, found once for those that are alike; None where it is too large."""
    jobs, crew = tables.jobs, tables.crew
    if len(jobs.prize) > JOBS or (np.diff(crew.first) > 1).any() or (jobs.after >= 0).any():
        return None
    found: list[dict[int, list[_Way]]] = []
    for member in range(len(crew.profile)):
        raise_if(stop)
        alike = next((other for other in range(member) if _alike(tables, member, other)), None)
        ways = _ways(tables, member) if alike is None else found[alike]
        if ways is None:
            return None
        found.append(ways)
    return found


def _alike(tables: Tables, member: int, other: int) -> bool:
    """Whether two aircraft take the same for everything."""
    costs, crew = tables.costs, tables.crew
    own, others = (crew.ends[crew.ends_first[m] : crew.ends_first[m + 1]] for m in (member, other))
    one, two = int(crew.profile[member]), int(crew.profile[other])
    return (
        crew.start[member] == crew.start[other]
        and np.array_equal(own, others)
        and np.array_equal(crew.limits[member], crew.limits[other])
        and all(len(table) == 1 or np.array_equal(table[one], table[two]) for table in costs)
    )


def _left(prizes: np.ndarray, done: int) -> float:
    return float(sum(prize for job, prize in enumerate(prizes) if not done >> job & 1))


def _best_of(shares: list[_Share], landing: float) -> list[_Share]:
    """Those that none is as cheap and as early as; the cheapest alone where landings cost nothing."""
    if landing == 0.0:
        return [min(shares, key=lambda share: share.cost)]
    kept: list[_Share] = []
    earliest = math.inf
    for share in sorted(shares, key=lambda share: (share.cost, share.landing_s)):
        if share.landing_s < earliest:
            kept.append(share)
            earliest = share.landing_s
    return kept


def _ways(tables: Tables, member: int) -> dict[int, list[_Way]] | None:
    """The best ways of an aircraft to do each set of jobs that it can do."""
    jobs, costs, crew, weights = tables.jobs, tables.costs, tables.crew, tables.weights
    nodes = len(jobs.of)
    labels, links = np.empty((LABELS, 6)), np.empty((LABELS, 4), dtype=np.int64)
    heads = np.full((2 ** len(jobs.prize), nodes), -1, dtype=np.int64)
    bases = crew.ends[crew.ends_first[member] : crew.ends_first[member + 1]]
    ends = np.empty((LABELS, len(bases), 2))
    used = trips(jobs, costs, crew, member, labels, links, heads, ends)
    if used < 0:
        return None
    profile, start = crew.profile[member], int(crew.start[member])
    idle = _Way(float(crew.limits[member, IDLE]), 0.0, (start, start))
    found: dict[int, list[_Way]] = {0: [idle]}
    for done in range(1, len(heads)):
        shares = []
        for node in np.flatnonzero(heads[done] >= 0):
            label = int(heads[done, node])
            while label >= 0:
                if not links[label, 3]:
                    for number, base in enumerate(bases):
                        duration_s, landing_s = ends[label, number]
                        if math.isfinite(duration_s):
                            cost = labels[label, PRICE] + costs.price[profile, node, base]
                            cost += weights.time * duration_s
                            shares.append(_Share(cost, landing_s, (_Way(cost, label, (int(base),)),)))
                label = int(links[label, 2])
        if shares:
            found[done] = [
                _Way(share.cost, share.landing_s, _nodes(links, share.ways[0], start))
                for share in _best_of(shares, weights.landing)
            ]
    return found


def _nodes(links: Ints, way: _Way, start: int) -> tuple[int, ...]:
    """The nodes of a label from the base it left to the base it lands at."""
    nodes, label = list(way.nodes), int(way.landing_s)
    while label >= 0:
        nodes.append(int(links[label, 0]))
        label = int(links[label, 1])
    return (start, *reversed(nodes))
