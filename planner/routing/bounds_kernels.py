"""Compiled parts of the lower bound: cells of passes, lines between cells, tours over cells. Numbers only.

A *cell* is a box of passes: headings ``theta ± alpha`` times offsets. It is held as float64 (10,): theta,
alpha, entry east and north, exit east and north (of its middle pass), how far entries and exits of its passes
may lie from those, the least cost from entry to exit, and 1 where it holds a pass at all.

A *family* of passes is float64 (8,): kind (below), side (1 looks right, −1 left), near edge, swath, half an
aperture, settling run, and east and north of the middle of its region.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: What a pass of a family sees: the whole region; of several passes, the strip furthest on the side the line
#: is on, or furthest on the other side; of several each as long as the whole region, the first of these.
WHOLE, NEAR_STRIP, FAR_STRIP, NEAR_LONG = 0.0, 1.0, 2.0, 3.0

THETA, ALPHA, E_IN, N_IN, E_OUT, N_OUT, SLACK_IN, SLACK_OUT, INNER, HOLDS = range(10)
TWO_PI = 2.0 * math.pi


@njit(cache=True)
def extent(x: Floats, y: Floats, least: float) -> tuple[float, float]:
    """From where to where in x a closed ring reaches whose y is ``least`` or more; inf, −inf if none."""
    low, high = np.inf, -np.inf
    for k in range(len(x)):
        m = k + 1 if k + 1 < len(x) else 0
        if y[k] >= least:
            low, high = min(low, x[k]), max(high, x[k])
        if (y[k] - least) * (y[m] - least) < 0.0:
            at = x[k] + (x[m] - x[k]) * (least - y[k]) / (y[m] - y[k])
            low, high = min(low, at), max(high, at)
    return low, high


@njit(cache=True)
def cell(points: Floats, family: Floats, theta: float, alpha: float, eta: float, half_eta: float) -> Floats:
    """The cell of headings ``theta ± alpha`` and offsets ``eta ± half_eta``, η from 0 to 1.

    ``points`` are the region's ring, (V, 2), relative to its middle. Its extents are the largest of its
    vertices' coordinates, so turning by α moves each by at most α times the distance D of the farthest
    vertex. An offset η lays the line η times what n strips have to spare beyond where the first would just
    see the edge.
    """
    kind, side, near, swath, half, settle = family[0], family[1], family[2], family[3], family[4], family[5]
    out = np.zeros(10)
    cos, sin = math.cos(theta), math.sin(theta)
    # Mirrored for a sensor that looks left: the line is always to the side of larger y.
    x = cos * points[:, 0] + sin * points[:, 1]
    y = side * (-sin * points[:, 0] + cos * points[:, 1])
    moved = alpha * math.sqrt((points[:, 0] ** 2 + points[:, 1] ** 2).max())
    x_min, x_max, y_min, y_max = x.min(), x.max(), y.min(), y.max()
    across = y_max - y_min
    along_slack = moved
    if kind == WHOLE:
        if across - 2.0 * moved > swath:
            return out
        spare = max(swath - across, 0.0)
        line = y_max + near + eta * spare
        # Where the region is a little too wide at the middle heading, the offset is off by what is lacking.
        across_slack = moved + half_eta * (spare + 2.0 * moved) + max(across - swath, 0.0)
    else:
        fewest = max(math.ceil((across - 2.0 * moved - 1e-6) / swath), 1.0)
        strips = max(math.ceil((across + 2.0 * moved) / swath), 1.0)
        spare = strips * swath - across
        across_slack = moved + half_eta * (spare + 2.0 * moved) + (strips - fewest) * swath
        line = y_max + near + eta * spare
        if kind == FAR_STRIP:
            line = y_min + swath + near - eta * spare
        if kind != NEAR_LONG:
            # What the outermost strip sees at every heading of the cell however the spare is shared out.
            seen = swath - 0.5 * (spare + 2.0 * moved)
            if kind == NEAR_STRIP:
                x_min, x_max = extent(x, y, y_max - seen + 2.0 * moved)
            else:
                x_min, x_max = extent(x, -y, -y_min - seen + 2.0 * moved)
            if not x_min <= x_max:
                # At the least one of the vertices that are outermost at some heading.
                top = y if kind == NEAR_STRIP else -y
                x_min, x_max = np.inf, -np.inf
                for k in range(len(x)):
                    if top[k] >= top.max() - 2.0 * moved - 1e-9:
                        x_min, x_max = min(x_min, x[k]), max(x_max, x[k])
                along_slack += 0.5 * (x_max - x_min)
                x_min = 0.5 * (x_min + x_max)
                x_max = x_min
    begin, end = x_min - half - settle, x_max + half
    line *= side
    slack = math.hypot(along_slack, across_slack)
    out[THETA], out[ALPHA] = theta, alpha
    out[E_IN] = family[6] + cos * begin - sin * line
    out[N_IN] = family[7] + sin * begin + cos * line
    out[E_OUT] = family[6] + cos * end - sin * line
    out[N_OUT] = family[7] + sin * end + cos * line
    out[SLACK_IN] = slack + alpha * math.hypot(begin, line)
    out[SLACK_OUT] = slack + alpha * math.hypot(end, line)
    out[INNER], out[HOLDS] = max(x_max - x_min - 2.0 * moved, 0.0) + 2.0 * half + settle, 1.0
    return out


@njit(cache=True)
def _turn_least(turn: float, slack: float) -> float:
    """Least of a turn known to within ``slack``: none at all where it may be a full one or less than none."""
    turn -= TWO_PI * math.floor(turn / TWO_PI)
    if turn + slack >= TWO_PI:
        return 0.0
    return max(turn - slack, 0.0)


@njit(cache=True)
def between_least(
    e0: float,
    n0: float,
    t0: float,
    a0: float,
    r0: float,
    e1: float,
    n1: float,
    t1: float,
    a1: float,
    r1: float,
    radius: float,
) -> float:
    """No line with turns of ``radius`` between these sets of poses is shorter than this.

    The sets are all poses within r of (e, n) at headings t ± a. Each word turn–straight–turn is evaluated
    with intervals: the centres of its turns are known to within r + radius·a each, so is the straight between
    them, and its direction to within the angle under which that is seen. Where sets are so close that three
    turns may be shorter, only their distance counts.
    """
    apart = max(math.hypot(e1 - e0, n1 - n0) - r0 - r1, 0.0)
    slack = r0 + r1 + radius * (a0 + a1)
    best = np.inf
    for k in range(4):
        s0 = 1.0 if k < 2 else -1.0
        s1 = 1.0 if k % 2 == 0 else -1.0
        ce = e1 - s1 * radius * math.sin(t1) - e0 + s0 * radius * math.sin(t0)
        cn = n1 + s1 * radius * math.cos(t1) - n0 - s0 * radius * math.cos(t0)
        d = math.hypot(ce, cn)
        low = d - slack
        if s0 == s1:
            if low <= 4.0 * radius:
                return apart
            straight, lean, lean_slack = low, 0.0, 0.0
        else:
            if low <= 2.0 * radius:
                return apart
            straight = math.sqrt(low * low - 4.0 * radius * radius)
            lean = math.asin(2.0 * radius / d)
            lean_slack = math.asin(2.0 * radius / low) - lean
        if straight >= best:
            continue
        direction = math.atan2(cn, ce) + s0 * lean
        off = math.asin(slack / d) + lean_slack
        turned = _turn_least(s0 * (direction - t0), off + a0) + _turn_least(s1 * (t1 - direction), off + a1)
        best = min(best, straight + radius * turned)
    return max(best, apart)


@njit(cache=True)
def place_least(
    e0: float, n0: float, e1: float, n1: float, t1: float, a1: float, r1: float, radius: float
) -> float:
    """The same from a place left in any direction: a straight and a turn, unless close by."""
    apart = max(math.hypot(e1 - e0, n1 - n0) - r1, 0.0)
    slack = r1 + radius * a1
    best = np.inf
    for k in range(2):
        s = 1.0 - 2.0 * k
        ce = e1 - s * radius * math.sin(t1) - e0
        cn = n1 + s * radius * math.cos(t1) - n0
        d = math.hypot(ce, cn)
        low = d - slack
        if low <= 3.0 * radius:
            return apart
        lean = math.asin(radius / d)
        off = math.asin(slack / d) + math.asin(radius / low) - lean
        direction = math.atan2(cn, ce) - s * lean
        turned = _turn_least(s * (t1 - direction), off + a1)
        best = min(best, math.sqrt(low * low - radius * radius) + radius * turned)
    return max(best, apart)


@njit(cache=True)
def cells_least(here: Floats, there: Floats, radius: float) -> float:
    """The same from the exits of one cell to the entries of another."""
    return between_least(
        here[E_OUT],
        here[N_OUT],
        here[THETA],
        here[ALPHA],
        here[SLACK_OUT],
        there[E_IN],
        there[N_IN],
        there[THETA],
        there[ALPHA],
        there[SLACK_IN],
        radius,
    )


@njit(cache=True)
def terminal_least(terminal: Floats, cells: Floats, arriving: bool, radius: float) -> Floats:
    """From a terminal to the entries of cells (N, 10), or from their exits to it where ``arriving``.

    ``terminal`` is (4,): east, north, 1 where its heading is fixed, heading.
    """
    out = np.empty(cells.shape[0])
    for k in range(cells.shape[0]):
        c = cells[k]
        # A line flown backwards is as long.
        turned = c[THETA] + math.pi if arriving else c[THETA]
        e, n, slack = c[E_IN], c[N_IN], c[SLACK_IN]
        if arriving:
            e, n, slack = c[E_OUT], c[N_OUT], c[SLACK_OUT]
        if terminal[2] > 0.0:
            heading = terminal[3] + math.pi if arriving else terminal[3]
            out[k] = between_least(
                terminal[0], terminal[1], heading, 0.0, 0.0, e, n, turned, c[ALPHA], slack, radius
            )
        else:
            out[k] = place_least(terminal[0], terminal[1], e, n, turned, c[ALPHA], slack, radius)
    return out


@njit(cache=True)
def matrix_least(cells: Floats, node: Ints, region: Ints, radius: float) -> Floats:
    """From each cell's exits to each other's entries, the latter's own cost included, (N, N).

    inf between cells of the same node, given by ``node``, int64 (N,), and between those of one ``region``
    that hold no two passes at the same or at opposite headings: strips of one region lie side by side.
    """
    count = cells.shape[0]
    out = np.full((count, count), np.inf)
    for i in range(count):
        for j in range(count):
            if node[i] == node[j]:
                continue
            if region[i] == region[j]:
                apart = cells[i, THETA] - cells[j, THETA]
                apart -= math.pi * math.floor(apart / math.pi + 0.5)
                if abs(apart) > cells[i, ALPHA] + cells[j, ALPHA] + 1e-9:
                    continue
            out[i, j] = cells_least(cells[i], cells[j], radius) + cells[j, INNER]
    return out


@njit(cache=True)
def subset_costs(first: Floats, between: Floats, offsets: Ints) -> Floats:
    """Least cost (2^C, N) of visiting a set of clusters, the last option given, as ``best_orders``."""
    clusters = len(offsets) - 1
    count = len(first)
    full = 1 << clusters
    best = np.full((full, count), np.inf)
    for c in range(clusters):
        for j in range(offsets[c], offsets[c + 1]):
            best[1 << c, j] = first[j]
    for visited in range(1, full):
        for c in range(clusters):
            if not visited >> c & 1 or visited == 1 << c:
                continue
            before = visited ^ (1 << c)
            for b in range(clusters):
                if not before >> b & 1:
                    continue
                for i in range(offsets[b], offsets[b + 1]):
                    so_far = best[before, i]
                    if so_far < np.inf:
                        for j in range(offsets[c], offsets[c + 1]):
                            cost = so_far + between[i, j]
                            if cost < best[visited, j]:
                                best[visited, j] = cost
    return best


@njit(cache=True)
def through_costs(ahead: Floats, behind: Floats, inner: Floats, offsets: Ints) -> Floats:
    """Least cost (N,) of a whole tour through each option.

    ``ahead`` and ``behind`` are ``subset_costs`` from the start and, with every line turned round, from the
    end; both count the option's own cost ``inner``.
    """
    clusters = len(offsets) - 1
    full = (1 << clusters) - 1
    out = np.full(len(inner), np.inf)
    for c in range(clusters):
        for visited in range(1, full + 1):
            if not visited >> c & 1:
                continue
            rest = (full ^ visited) | (1 << c)
            for j in range(offsets[c], offsets[c + 1]):
                cost = ahead[visited, j] + behind[rest, j] - inner[j]
                if cost < out[j]:
                    out[j] = cost
    return out


@njit(cache=True)
def pair_least(
    points0: Floats,
    families0: Floats,
    boxes0: Floats,
    points1: Floats,
    families1: Floats,
    boxes1: Floats,
    radius: float,
    splits: int,
) -> float:
    """Least of half of one pass, the line to another and half of that, over all passes of two families.

    Boxes are float64 (B, 5): family, theta, alpha, eta, half_eta. The pair of cells with the least bound is
    split in sixteen, ``splits`` times.
    """
    most = boxes0.shape[0] * boxes1.shape[0] + 16 * splits
    least = np.empty(most)
    left, right = np.empty((most, 5)), np.empty((most, 5))
    count = 0
    for i in range(boxes0.shape[0]):
        here = box_cell(points0, families0, boxes0[i])
        if here[HOLDS] == 0.0:
            continue
        for j in range(boxes1.shape[0]):
            there = box_cell(points1, families1, boxes1[j])
            if there[HOLDS] == 0.0:
                continue
            least[count] = cells_least(here, there, radius) + 0.5 * (here[INNER] + there[INNER])
            left[count], right[count] = boxes0[i], boxes1[j]
            count += 1
    if count == 0:
        return np.inf
    for _ in range(splits):
        k = int(np.argmin(least[:count]))
        box0, box1 = left[k].copy(), right[k].copy()
        children0, children1 = quarters(box0), quarters(box1)
        least[k] = np.inf
        for i in range(4):
            here = box_cell(points0, families0, children0[i])
            if here[HOLDS] == 0.0:
                continue
            for j in range(4):
                there = box_cell(points1, families1, children1[j])
                if there[HOLDS] == 0.0:
                    continue
                least[count] = cells_least(here, there, radius) + 0.5 * (here[INNER] + there[INNER])
                left[count], right[count] = children0[i], children1[j]
                count += 1
    return float(least[:count].min())


@njit(cache=True)
def box_cell(points: Floats, families: Floats, box: Floats) -> Floats:
    """The cell of one box (5,)."""
    return cell(points, families[int(box[0])], box[1], box[2], box[3], box[4])


@njit(cache=True)
def quarters(box: Floats) -> Floats:
    """A box in four, (4, 5): half the headings times half the offsets."""
    out = np.empty((4, 5))
    for k in range(4):
        out[k] = box
        out[k, 2] = 0.5 * box[2]
        out[k, 1] = box[1] + (0.5 if k < 2 else -0.5) * box[2]
        out[k, 4] = 0.5 * box[4]
        out[k, 3] = box[3] + (0.5 if k % 2 == 0 else -0.5) * box[4]
    return out


@njit(cache=True)
def ascent(edges: Floats, first: Floats, last: Floats, target: float, steps: int) -> float:
    """Held and Karp's bound on a tour from the start through all nodes to the end, by subgradient ascent.

    A tour is a tree over the nodes with an edge to the start and one to the end; prices on nodes change all
    tours alike and make the least tree more like a tour. Any prices give a bound; the best met is returned.

    Parameters
    ----------
    edges, first, last
        Least costs between nodes, symmetric (N, N), from the start (N,) and to the end (N,).
    target
        Length of a known tour: sets the step.
    """
    n = len(first)
    price = np.zeros(n)
    best = -np.inf
    scale, idle = 2.0, 0
    key, parent = np.empty(n), np.empty(n, dtype=np.int64)
    done = np.empty(n, dtype=np.bool_)
    for _ in range(steps):
        degree = np.zeros(n, dtype=np.int64)
        key[:] = np.inf
        parent[:] = -1
        done[:] = False
        key[0] = 0.0
        total = 0.0
        for _ in range(n):
            u = -1
            for v in range(n):
                if not done[v] and (u < 0 or key[v] < key[u]):
                    u = v
            done[u] = True
            total += key[u]
            if parent[u] >= 0:
                degree[u] += 1
                degree[parent[u]] += 1
            for v in range(n):
                if not done[v]:
                    cost = edges[u, v] + price[u] + price[v]
                    if cost < key[v]:
                        key[v], parent[v] = cost, u
        begin, end = int(np.argmin(first + price)), int(np.argmin(last + price))
        total += first[begin] + price[begin] + last[end] + price[end]
        degree[begin] += 1
        degree[end] += 1
        bound = total - 2.0 * price.sum()
        if bound > best + 1e-6:
            best, idle = bound, 0
        else:
            idle += 1
            if idle >= 10:
                scale, idle = scale * 0.7, 0
        norm = 0.0
        for v in range(n):
            norm += float((degree[v] - 2) ** 2)
        if norm == 0.0:
            break
        step = scale * max(target - bound, 1e-3 * target) / norm
        for v in range(n):
            price[v] += step * (degree[v] - 2)
    return best
