"""Equations (19) to (33) as rows of a mixed integer linear program, in what the text means or as printed.

Where text and formulas differ (docs/fleet.md shows each on three targets):

- (21) ``y_ij - 1 <= M f_ijw`` holds whatever f is; the text: who flies a segment uses its sensor, ``y_ij <=
  f_ijw``.
- (29) ``x_i = x_j`` for i of {k, l} and j of {m, n} makes all four alike, so that both segments are flown or
  none; the text: one of the two is chosen. Meant: ``x_k = x_m``, ``x_l = x_n``, ``x_k + x_l <= 1``.
- (30), (31) ``y_km + y_mk <= 1`` lets a line visit k and m without flying between them; the text: they
  enforce the edge, not its direction. Meant: ``y_km + y_mk = x_k``.
- (32), (33) the text tells of ``y_ijh``, an index of the aircraft that the formulas have lost: here it is
  back, and (20), (30) to (33) sum over it. For bases x is 1, for (32) is stated for them and nothing else
  sets it.
- (24) is stated for bases too, where with (23) it would have the line come back to where it started, and (26)
  around that circle cannot hold: in both forms it is for waypoints, and (25) makes each aircraft land once.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.sparse import csr_array

from planner.fleet.problem import FloatArray
from planner.fleet.stecz2020.network import Flyer, Network, Segment

Form = Literal["meant", "printed"]


@dataclass
class Rows:
    """A program as it is written down, a row at a time."""

    cost: list[float] = field(default_factory=list)
    low: list[float] = field(default_factory=list)
    high: list[float] = field(default_factory=list)
    whole: list[int] = field(default_factory=list)
    entries: list[tuple[int, int, float]] = field(default_factory=list)
    least: list[float] = field(default_factory=list)
    most: list[float] = field(default_factory=list)

    def variable(self, low: float, high: float, cost: float = 0.0, *, whole: bool = False) -> int:
        """A new variable's number."""
        self.cost.append(cost)
        self.low.append(low)
        self.high.append(high)
        self.whole.append(int(whole))
        return len(self.cost) - 1

    def row(self, terms: list[tuple[int, float]], least: float, most: float) -> None:
        """``least <= sum of the terms <= most``."""
        number = len(self.least)
        self.entries += [(number, variable, factor) for variable, factor in terms]
        self.least.append(least)
        self.most.append(most)

    def matrix(self) -> csr_array:
        """Rows by variables."""
        rows, columns, values = zip(*self.entries, strict=True)
        return csr_array((values, (rows, columns)), shape=(len(self.least), len(self.cost)))


@dataclass(frozen=True, slots=True)
class Model:
    """The program and which of its variables are what.

    ``y``: by aircraft, from, to. ``x`` and ``t``: by waypoint. ``missed``: by required target, 1 when it is
    not recognised, at ``penalty`` each.
    """

    rows: Rows
    y: dict[tuple[int, int, int], int]
    x: tuple[int, ...]
    missed: dict[int, int]
    penalty: float
    f: tuple[int, ...]


def horizon_s(network: Network) -> float:
    """No optimal flight lands later."""
    latest = max(
        [flyer.ready_s for flyer in network.flyers] + [each.window_s[0] for each in network.waypoints]
    )
    steps = np.array(
        [np.where(np.isfinite(flyer.seconds), flyer.seconds, 0.0).max(axis=1) for flyer in network.flyers]
    )
    worked = float(steps.max(axis=0).sum()) + sum(each.isr_s for each in network.waypoints)
    ends = [flyer.land_by_s for flyer in network.flyers]
    return min(latest + worked, max(ends))


def write(network: Network, form: Form) -> Model:
    """Write the model down."""
    rows = Rows()
    flyers, waypoints = network.flyers, range(len(network.waypoints))
    horizon = horizon_s(network)
    worth = {(s.k, s.m): s.priority for s in network.segments}
    y: dict[tuple[int, int, int], int] = {}
    for h, flyer in enumerate(flyers):
        for i, j in _arcs(network, flyer, form):
            cost = network.goal.rho * flyer.seconds[i, j] - worth.get((i, j), worth.get((j, i), 0.0))  # (19)
            if flyer.risk is not None:
                cost += network.goal.risk * flyer.risk[i, j]
            y[h, i, j] = rows.variable(0.0, 1.0, float(cost), whole=True)
    x = tuple(rows.variable(0.0, 1.0, -each.priority, whole=True) for each in network.waypoints)  # (19)
    t = [rows.variable(0.0, min(each.window_s[1], horizon)) for each in network.waypoints]
    for i in waypoints:
        _visits(network, rows, y, x, i)
        opens, closes = network.waypoints[i].window_s
        rows.row([(t[i], 1.0), (x[i], -opens)], 0.0, math.inf)  # (27)
        rows.row([(t[i], 1.0), (x[i], -min(closes, horizon))], -math.inf, 0.0)  # (28)
    _orders(network, rows, y, x)
    last = rows.variable(0.0, math.inf, network.goal.last_landing)
    for h in range(len(flyers)):
        _flight(network, rows, y, t, h, last, horizon, form)
    return _segments(network, rows, y, x, form)


def _arcs(network: Network, flyer: Flyer, form: Form) -> list[tuple[int, int]]:
    """E of one aircraft without loops, (22), nor what windows or, as meant, (29) leave no use for."""
    inner = len(network.waypoints)
    of = {vertex: (s.target, s.alternative) for s in network.segments for vertex in (s.k, s.m)}
    earliest = [max(each.window_s[0], flyer.ready_s) + each.isr_s for each in network.waypoints]
    latest = [each.window_s[1] for each in network.waypoints]

    def useful(i: int, j: int) -> bool:
        begin = flyer.ready_s if i == flyer.start else earliest[i]
        if begin + flyer.seconds[i, j] > (flyer.land_by_s if j in flyer.ends else latest[j]):
            return False
        one, other = of.get(i), of.get(j)
        return form == "printed" or one is None or other is None or one[0] != other[0] or one == other

    sources, targets = [*range(inner), flyer.start], [*range(inner), *flyer.ends]
    return [
        (i, j)
        for i, j in itertools.product(sources, targets)
        if i != j
        and not (i == flyer.start and j >= inner)
        and math.isfinite(flyer.seconds[i, j])
        and useful(i, j)
    ]


def _visits(
    network: Network, rows: Rows, y: dict[tuple[int, int, int], int], x: tuple[int, ...], i: int
) -> None:
    """(20), (24) and (33) at a waypoint."""
    out = [(key, v) for key, v in y.items() if key[1] == i]
    into = [(key, v) for key, v in y.items() if key[2] == i]
    rows.row([(v, 1.0) for _, v in out], -math.inf, 1.0)  # (20)
    rows.row([*((v, 1.0) for _, v in into), (x[i], -1.0)], 0.0, 0.0)  # (33)
    for h in range(len(network.flyers)):
        terms = [(v, 1.0) for key, v in into if key[0] == h] + [(v, -1.0) for key, v in out if key[0] == h]
        rows.row(terms, 0.0, 0.0)  # (24)


def _orders(network: Network, rows: Rows, y: dict[tuple[int, int, int], int], x: tuple[int, ...]) -> None:
    """(32), and no circles: C. E. Miller, A. W. Tucker, R. A. Zemlin, Journal of the ACM 7 (1960)."""
    count = len(network.waypoints)
    order = [rows.variable(0.0, count - 1.0) for _ in range(count)]
    pairs: dict[tuple[int, int], list[int]] = {}
    for (_, i, j), v in y.items():
        pairs.setdefault((i, j), []).append(v)
    for (i, j), flown in pairs.items():
        ends = [(x[k], 1.0) for k in (i, j) if k < count]
        rows.row([*ends, *((v, -2.0) for v in flown)], -(2.0 - len(ends)), math.inf)  # (32)
        if i < count and j < count:
            terms = [(order[j], 1.0), (order[i], -1.0), *((v, -float(count)) for v in flown)]
            rows.row(terms, 1.0 - count, math.inf)


def _flight(
    network: Network,
    rows: Rows,
    y: dict[tuple[int, int, int], int],
    t: list[int],
    h: int,
    last: int,
    horizon: float,
    form: Form,
) -> None:
    """(23), (25), (26) of one aircraft, and how long and far it can fly."""
    flyer = network.flyers[h]
    own = {(i, j): v for (g, i, j), v in y.items() if g == h}
    away = [(v, 1.0) for (i, _), v in own.items() if i == flyer.start]
    home = [(v, 1.0) for (_, j), v in own.items() if j in flyer.ends]
    rows.row(away, 1.0 if flyer.must_fly or form == "printed" else 0.0, 1.0)  # (23)
    rows.row([*home, *((v, -1.0) for v, _ in away)], 0.0, 0.0)  # (25)
    off = rows.variable(flyer.ready_s, max(horizon, flyer.ready_s), -network.goal.in_air)
    landed = rows.variable(0.0, min(flyer.land_by_s, max(horizon, flyer.ready_s)), network.goal.in_air)
    for (i, j), v in own.items():
        leg = float(flyer.seconds[i, j])
        isr = network.waypoints[i].isr_s if i != flyer.start else 0.0
        begin, end = (off if i == flyer.start else t[i]), (landed if j in flyer.ends else t[j])
        big = rows.high[begin] - rows.low[end] + leg + isr
        rows.row([(end, 1.0), (begin, -1.0), (v, -big)], leg + isr - big, math.inf)  # (26)
    rows.row([(landed, 1.0), (off, -1.0)], 0.0, flyer.max_flight_s)
    # An aircraft that stays has landed when it is ready, and counts for nothing.
    late = rows.high[landed]
    rows.row([(last, 1.0), (landed, -1.0), *((v, -late) for v, _ in away)], -late, math.inf)
    if flyer.length_m is not None and math.isfinite(flyer.range_m):
        rows.row([(v, float(flyer.length_m[a])) for a, v in own.items()], -math.inf, flyer.range_m)
    if flyer.energy_wh is not None and math.isfinite(flyer.budget_wh):
        waiting = flyer.waiting_w / 3600.0
        used = [(v, float(flyer.energy_wh[a] - waiting * flyer.seconds[a])) for a, v in own.items()]
        rows.row([*used, (landed, waiting), (off, -waiting)], -math.inf, flyer.budget_wh)


def _segments(
    network: Network, rows: Rows, y: dict[tuple[int, int, int], int], x: tuple[int, ...], form: Form
) -> Model:
    """(21), (29), (30) and (31), and what is required."""
    by_target: dict[int, list[Segment]] = {}
    f: list[int] = []
    for segment in network.segments:
        by_target.setdefault(segment.target, []).append(segment)
        k, m = segment.k, segment.m
        for i, j in ((k, m), (m, k)):
            flown = [y[h, i, j] for h in range(len(network.flyers)) if (h, i, j) in y]
            if flown:
                sensor = rows.variable(0.0, 1.0, whole=True)
                f.append(sensor)
                factor = -2.0 if form == "printed" else -1.0
                most = 1.0 if form == "printed" else 0.0
                rows.row([*((v, 1.0) for v in flown), (sensor, factor)], -math.inf, most)  # (21)
        between = [v for (_, i, j), v in y.items() if {i, j} == {k, m}]
        if form == "printed":
            rows.row([(v, 1.0) for v in between], -math.inf, 1.0)  # (30), (31)
        else:
            rows.row([*((v, 1.0) for v in between), (x[k], -1.0)], 0.0, 0.0)  # (30), (31)
            rows.row([(x[k], 1.0), (x[m], -1.0)], 0.0, 0.0)  # (29)
    costs: FloatArray = np.abs(np.array(rows.cost))
    penalty = 10.0 * (1.0 + float(costs.max())) * (1.0 + len(network.waypoints)) + 10.0 * (
        network.goal.in_air + network.goal.last_landing
    ) * horizon_s(network)
    missed: dict[int, int] = {}
    for target, ways in by_target.items():
        if form == "printed":
            for one, other in itertools.product(ways, ways):
                rows.row([(x[one.k], 1.0), (x[other.m], -1.0)], 0.0, 0.0)  # (29)
        else:
            rows.row([(x[way.k], 1.0) for way in ways], -math.inf, 1.0)  # (29)
        if target in network.required:
            missed[target] = rows.variable(0.0, 1.0, penalty)
            rows.row([*((x[way.k], 1.0) for way in ways), (missed[target], 1.0)], 1.0, math.inf)
    return Model(rows, y, x, missed, penalty, tuple(f))
