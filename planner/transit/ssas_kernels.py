"""Compiled tree of the sampling-based sparse A* search (Li et al. 2018, section 4.4).

One call of ``grow`` is one run of Algorithm 3: a tree of straight legs from a root towards a goal. Positions
are metres east and north, directions radians counter-clockwise from east.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from planner.airspace.kernels import CLEAR, OUTSIDE, leg_risk, leg_verdict
from planner.jit import njit
from planner.transit.kernels import BUCKETS, forget, nearest, pop, push, remember, wrap

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

# What a run aims at, and so when it ends.
TO_POINT = 0  # the goal has no direction: ring of eq 26 without its second condition, then one leg
TO_VECTOR = 1  # both conditions of eq 26, then one or two legs that meet the goal's direction
NEAR_POINT = 2  # an intermediate point: within two legs is near enough
INVERSE = 3  # stage 1: a given number of legs back from the goal, inside its cone

# How it ended.
FOUND = 0
EMPTY = 1
SPENT = 2

# States of a node.
_OPEN = 0
_CLOSED = 1
_REPLACED = 2
_GOAL = 3

# Columns of a node.
EAST, NORTH, ANGLE, LENGTH, KILL, DETECTION = range(6)

_SLACK_RAD = 1e-9
_SLACK_M = 1e-6
_COST_STEP = 1e-9


class Space(NamedTuple):
    """What surrounds the search, as arrays.

    ``missiles`` (K, 3) and ``radars`` (M, 4) as in ``planner.airspace.threats.threat_arrays``; ``discs``
    (D, 3: east_m, north_m, radius_m) and polygons (``edges`` (E, 4: e0, n0, e1, n1) with int64 ``offsets``
    (P + 1)) are never entered; ``area`` (A, 4) holds the edges of what is never left, no rows for no limit.
    """

    missiles: Array
    radars: Array
    discs: Array
    edges: Array
    offsets: Indices
    area: Array


class Rules(NamedTuple):
    """How a tree grows: see ``planner.transit.ssas.SsasParameters`` for the meanings."""

    mode: int
    directed: bool
    backwards: bool
    leg_m: float
    min_leg_m: float
    max_turn_rad: float
    sectors: int
    neighbour_radius_m: float
    neighbour_angle_rad: float
    direct_m: float
    weight_length: float
    weight_missile: float
    weight_radar: float
    heuristic_length: float
    heuristic_missile: float
    heuristic_radar: float
    dividing_m: float
    margin_m: float
    clipping: bool
    max_depth: int
    max_nodes: int


@njit(cache=True)
def _verdict(e0: float, n0: float, e1: float, n1: float, space: Space) -> int:
    return leg_verdict(e0, n0, e1, n1, space.discs, space.edges, space.offsets, space.area)


@njit(cache=True)
def _leg_cost(e0: float, n0: float, e1: float, n1: float, space: Space, rules: Rules) -> tuple[float, float]:
    m, r = space.missiles, space.radars
    return leg_risk(e0, n0, e1, n1, m, r, rules.dividing_m, rules.margin_m, rules.clipping, rules.backwards)


@njit(cache=True)
def _cost(length_m: float, kill: float, detection: float, rules: Rules) -> float:
    """Eq 25, rounded: legs in another order end at one place at one cost, whatever the last bit says."""
    total: float = (
        rules.weight_length * length_m / rules.direct_m
        + rules.weight_missile * kill
        + rules.weight_radar * detection
    )
    return math.floor(total / _COST_STEP + 0.5) * _COST_STEP


@njit(cache=True)
def _estimate(node: Array, goal: Array, space: Space, rules: Rules, risks_ahead: bool) -> float:
    """Eqs 23 and 25: cost so far and weighted estimate along the straight line to the goal."""
    rest_m = math.hypot(goal[EAST] - node[EAST], goal[NORTH] - node[NORTH])
    kill = node[KILL]
    detection = node[DETECTION]
    if risks_ahead and (rules.heuristic_missile > 0.0 or rules.heuristic_radar > 0.0):
        rest_kill, rest_detection = _leg_cost(node[EAST], node[NORTH], goal[EAST], goal[NORTH], space, rules)
        kill += rules.heuristic_missile * rest_kill
        detection += rules.heuristic_radar * rest_detection
    return _cost(node[LENGTH] + rules.heuristic_length * rest_m, kill, detection, rules)


@njit(cache=True)
def _actual(node: Array, rules: Rules) -> float:
    return _cost(node[LENGTH], node[KILL], node[DETECTION], rules)


@njit(cache=True)
def _advance(nodes: Array, parent: int, child: int, e1: float, n1: float, space: Space, rules: Rules) -> None:
    """Write the node at the end of a leg (eq 24)."""
    e0, n0 = nodes[parent, EAST], nodes[parent, NORTH]
    kill, detection = _leg_cost(e0, n0, e1, n1, space, rules)
    nodes[child, EAST] = e1
    nodes[child, NORTH] = n1
    nodes[child, ANGLE] = math.atan2(n1 - n0, e1 - e0)
    nodes[child, LENGTH] = nodes[parent, LENGTH] + math.hypot(e1 - e0, n1 - n0)
    nodes[child, KILL] = nodes[parent, KILL] + kill
    nodes[child, DETECTION] = nodes[parent, DETECTION] + detection


@njit(cache=True)
def _trace(nodes: Array, parents: Indices, last: int) -> Array:
    count = 1
    node = last
    while parents[node] >= 0:
        node = parents[node]
        count += 1
    path = np.empty((count, 6))
    node = last
    for k in range(count - 1, -1, -1):
        path[k] = nodes[node]
        node = parents[node]
    return path


@njit(cache=True)
def _turn_ok(before_rad: float, after_rad: float, limit_rad: float) -> bool:
    turn_rad: float = abs(wrap(after_rad - before_rad))
    return turn_rad <= limit_rad + _SLACK_RAD


@njit(cache=True)
def _close(
    nodes: Array,
    parents: Indices,
    depths: Indices,
    node: int,
    free: int,
    directed: bool,
    goal: Array,
    space: Space,
    rules: Rules,
) -> tuple[int, int, int]:
    """Join a node of the termination ring (eq 26) to the goal by one leg, else by the cheapest two.

    The two meet at a tip of the goal's own fan-tail (Figure 12b): that is what lets the ring be entered at
    up to 2 φmax from the goal's direction with no turn above φmax. Nodes are written from ``free`` on.

    Returns
    -------
    tuple
        The goal's node (-1 where it cannot be joined); legs refused for the area; legs refused for zones.
    """
    e0, n0, angle = nodes[node, EAST], nodes[node, NORTH], nodes[node, ANGLE]
    goal_e, goal_n = goal[EAST], goal[NORTH]
    rest_m = math.hypot(goal_e - e0, goal_n - n0)
    rest_rad = math.atan2(goal_n - n0, goal_e - e0)
    outside = 0
    forbidden = 0
    # the root may stand nearer to the goal than the ring's inner margin; with no room there for two corners
    # it is joined only straight on
    if rest_m < rules.leg_m - _SLACK_M and node > 0:
        return -1, outside, forbidden
    limit_rad = rules.max_turn_rad if rest_m >= rules.min_leg_m else 0.0
    turns_in = not directed or _turn_ok(angle, rest_rad, limit_rad)
    if turns_in and (rules.mode == TO_POINT or _turn_ok(rest_rad, goal[ANGLE], limit_rad)):
        verdict = _verdict(e0, n0, goal_e, goal_n, space)
        if verdict == CLEAR:
            _advance(nodes, node, free, goal_e, goal_n, space, rules)
            parents[free] = node
            depths[free] = depths[node] + 1
            return free, outside, forbidden
        if verdict == OUTSIDE:
            outside += 1
        else:
            forbidden += 1
    entry_rad = abs(wrap(rest_rad - goal[ANGLE]))
    if (
        rules.mode == TO_POINT
        or rest_m < rules.min_leg_m
        or entry_rad > 2.0 * rules.max_turn_rad + _SLACK_RAD
    ):
        return -1, outside, forbidden
    best_e, best_n, best_cost = 0.0, 0.0, math.inf
    for branch in range(rules.sectors):
        offset_rad = rules.max_turn_rad * (2.0 * branch + 1.0 - rules.sectors) / rules.sectors
        last_rad = goal[ANGLE] + offset_rad
        tip_e = goal_e - rules.leg_m * math.cos(last_rad)
        tip_n = goal_n - rules.leg_m * math.sin(last_rad)
        tip_rad = math.atan2(tip_n - n0, tip_e - e0)
        if (
            math.hypot(tip_e - e0, tip_n - n0) < rules.min_leg_m
            or (directed and not _turn_ok(angle, tip_rad, rules.max_turn_rad))
            or not _turn_ok(tip_rad, last_rad, rules.max_turn_rad)
        ):
            continue
        verdict = _verdict(e0, n0, tip_e, tip_n, space)
        if verdict == CLEAR:
            verdict = _verdict(tip_e, tip_n, goal_e, goal_n, space)
        if verdict == OUTSIDE:
            outside += 1
        elif verdict != CLEAR:
            forbidden += 1
        else:
            _advance(nodes, node, free, tip_e, tip_n, space, rules)
            _advance(nodes, free, free + 1, goal_e, goal_n, space, rules)
            cost = _actual(nodes[free + 1], rules)
            if cost < best_cost:
                best_e, best_n, best_cost = tip_e, tip_n, cost
    if best_cost == math.inf:
        return -1, outside, forbidden
    _advance(nodes, node, free, best_e, best_n, space, rules)
    _advance(nodes, free, free + 1, goal_e, goal_n, space, rules)
    parents[free] = node
    parents[free + 1] = free
    depths[free] = depths[node] + 1
    depths[free + 1] = depths[node] + 2
    return free + 1, outside, forbidden


@njit(cache=True)
def grow(root: Array, goal: Array, space: Space, rules: Rules) -> tuple[int, int, int, int, Array]:
    """One run of Algorithm 3.

    Parameters
    ----------
    root
        float64, shape (6,): east_m, north_m, angle_rad, length_m, and risks of kill and detection so far.
    goal
        float64, shape (3,): east_m, north_m, angle_rad (read only when a vector is aimed at).

    Returns
    -------
    tuple
        How it ended (FOUND, EMPTY, SPENT); nodes reached; legs refused for the area; legs refused for
        zones; path from the root, shape (N, 6) in the columns of ``root``: to the goal or the node that
        ended the run when FOUND, to the deepest expanded node otherwise.

    Notes
    -----
    A replaced sample (line 14) is taken out of the open set. Were it expanded already - possible only under
    heuristics that overestimate - its record stays as the parent of its children: nodes are never rewritten
    and parents are older than their children, so every path traced is one that was grown.

    A node satisfying eq 26 does not end the run by itself: the goal enters the open set at the full cost of
    the closing legs and ends it when it is the best. Without threats on a straight closing leg that is the
    same moment; with them it is not ended by an estimate that ignores them.
    """
    capacity = rules.max_nodes + 16
    nodes = np.empty((capacity, 6))
    parents = np.empty(capacity, np.int64)
    depths = np.empty(capacity, np.int64)
    states = np.empty(capacity, np.int64)
    chain = np.empty(capacity, np.int64)
    costs = np.empty(capacity)
    keys = np.empty(capacity)
    items = np.empty(capacity, np.int64)
    heads = np.full(BUCKETS, -1, np.int64)
    cell_m = rules.neighbour_radius_m
    outside = 0
    forbidden = 0

    nodes[0] = root
    parents[0] = -1
    depths[0] = 0
    states[0] = _OPEN
    costs[0] = 0.0
    remember(root[EAST], root[NORTH], 0, heads, chain, cell_m)
    size = push(keys, items, 0, 0.0, 0)
    count = 1
    deepest = 0

    while size > 0:
        node, size = pop(keys, items, size)
        if states[node] == _REPLACED:
            continue
        if states[node] == _GOAL:
            return FOUND, count, outside, forbidden, _trace(nodes, parents, node)
        states[node] = _CLOSED
        if depths[node] > depths[deepest]:
            deepest = node
        e0, n0, angle = nodes[node, EAST], nodes[node, NORTH], nodes[node, ANGLE]
        directed = rules.directed or node > 0
        rest_m = math.hypot(goal[EAST] - e0, goal[NORTH] - n0)
        near = rest_m <= 2.0 * rules.leg_m + _SLACK_M
        far_enough = node > 0 and (near or depths[node] >= rules.max_depth)
        if (rules.mode == NEAR_POINT and near) or (rules.mode == INVERSE and far_enough):
            return FOUND, count, outside, forbidden, _trace(nodes, parents, node)
        if count + rules.sectors + 2 >= rules.max_nodes:
            return SPENT, count, outside, forbidden, _trace(nodes, parents, deepest)

        if near and (rules.mode == TO_POINT or rules.mode == TO_VECTOR):
            last, refused_area, refused_zone = _close(
                nodes, parents, depths, node, count, directed, goal, space, rules
            )
            outside += refused_area
            forbidden += refused_zone
            if last >= 0:
                states[count] = _CLOSED
                states[last] = _GOAL
                costs[last] = _actual(nodes[last], rules)
                size = push(keys, items, size, costs[last], last)
                count = last + 1

        width_rad = 2.0 * rules.max_turn_rad / rules.sectors
        branches = rules.sectors
        least_rad = angle - rules.max_turn_rad + 0.5 * width_rad
        if not directed:
            # the whole circle in sectors as wide as the fan-tail's, one of them towards the goal
            branches = math.ceil(2.0 * math.pi / width_rad - _SLACK_RAD)
            width_rad = 2.0 * math.pi / branches
            least_rad = math.atan2(goal[NORTH] - n0, goal[EAST] - e0)
        for branch in range(branches):
            if count >= rules.max_nodes:
                return SPENT, count, outside, forbidden, _trace(nodes, parents, deepest)
            towards_rad = least_rad + branch * width_rad
            e1 = e0 + rules.leg_m * math.cos(towards_rad)
            n1 = n0 + rules.leg_m * math.sin(towards_rad)
            if rules.mode == INVERSE:
                bearing_rad = math.atan2(n1 - nodes[0, NORTH], e1 - nodes[0, EAST])
                if not _turn_ok(nodes[0, ANGLE], bearing_rad, rules.max_turn_rad):
                    continue
            child = count
            nodes[child, EAST] = e1
            nodes[child, NORTH] = n1
            nodes[child, ANGLE] = wrap(towards_rad)
            # lines 10 and 11 of Algorithm 3
            other = nearest(
                e1, n1, nodes[child, ANGLE], nodes, heads, chain, cell_m, rules.neighbour_angle_rad
            )
            if other >= 0:
                # risks only add: what its length alone makes too dear needs no look at the surroundings
                nodes[child, LENGTH] = nodes[node, LENGTH] + rules.leg_m
                nodes[child, KILL] = nodes[node, KILL]
                nodes[child, DETECTION] = nodes[node, DETECTION]
                if _estimate(nodes[child], goal, space, rules, False) >= costs[other]:
                    continue
            verdict = _verdict(e0, n0, e1, n1, space)
            if verdict != CLEAR:
                if verdict == OUTSIDE:
                    outside += 1
                else:
                    forbidden += 1
                continue
            _advance(nodes, node, child, e1, n1, space, rules)
            nodes[child, ANGLE] = wrap(towards_rad)
            cost = _estimate(nodes[child], goal, space, rules, True)
            if other >= 0:
                if cost >= costs[other]:
                    continue
                if states[other] == _OPEN:
                    states[other] = _REPLACED
                forget(nodes[other, EAST], nodes[other, NORTH], other, heads, chain, cell_m)
            parents[child] = node
            depths[child] = depths[node] + 1
            states[child] = _OPEN
            costs[child] = cost
            remember(e1, n1, child, heads, chain, cell_m)
            size = push(keys, items, size, cost, child)
            count += 1
    return EMPTY, count, outside, forbidden, _trace(nodes, parents, deepest)
