"""The ascent over trees: any prices give a bound, and the best of them is what the linear programme says."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import linprog

from planner.bounds import trees_kernels as kernels

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Problem:
    """Nodes of a few cells each; lines between cells, from the start and to the end."""

    offsets: Ints
    lines: Floats
    first: Floats
    last: Floats

    @property
    def nodes(self) -> range:
        return range(len(self.offsets) - 1)

    def node(self, cell: int) -> int:
        return int(np.searchsorted(self.offsets, cell, side="right")) - 1

    def cells(self, node: int) -> range:
        return range(self.offsets[node], self.offsets[node + 1])

    def shortest_m(self) -> float:
        """Over every order and every choice of cells."""
        best = np.inf
        for order in itertools.permutations(self.nodes):
            costs = self.first[list(self.cells(order[0]))]
            for b, c in itertools.pairwise(order):
                costs = (costs[:, None] + self.lines[np.ix_(self.cells(b), self.cells(c))]).min(axis=0)
            best = min(best, float((costs + self.last[list(self.cells(order[-1]))]).min()))
        return best

    def ascent(self, steps: int, price: Floats, potential: Floats, back: Floats) -> float:
        pairs = np.array(list(itertools.permutations(self.nodes, 2)), dtype=np.int64)
        flat = [self.lines[np.ix_(self.cells(b), self.cells(c))].ravel() for b, c in pairs.tolist()]
        begins = np.concatenate([[0], np.cumsum([len(block) for block in flat])]).astype(np.int64)
        base = np.full((len(self.nodes), len(self.nodes)), np.inf)
        slack = np.zeros(len(self.first))
        prices, state = kernels.Prices(price, potential, back), np.array([-np.inf, 1.0, 0.0])
        told = [np.full(len(self.first), fill, dtype=np.int64) for fill in (0, -2, -2)]
        given = (prices.copied(), prices.copied(), *told, state, self.shortest_m(), steps)
        ends = (self.first, self.last)
        args = (np.concatenate(flat), begins, pairs, base, *ends, slack, self.offsets, *given)
        kernels.ascent(*args)
        return float(state[0])


def problem(seed: int, nodes: int, cells: int) -> Problem:
    """Places in a square, cells at places round them: going back where one came from is short."""
    rng = np.random.default_rng(seed)
    offsets = np.arange(nodes + 1, dtype=np.int64) * cells
    middles = np.repeat(rng.uniform(0.0, 3000.0, (nodes, 2)), cells, axis=0)
    entries, exits = (middles + rng.normal(0.0, 500.0, middles.shape) for _ in range(2))
    lines = np.hypot(*(exits[:, None, :] - entries[None, :, :]).transpose(2, 0, 1))
    return Problem(offsets, lines, np.hypot(*entries.T), np.hypot(*exits.T))


def relaxed_m(of: Problem) -> float:
    """The linear programme whose dual the ascent climbs: flows, no subtours, no turning back at a cell."""
    count = len(of.first)
    arcs = [(i, j) for i in range(count) for j in range(count) if of.node(i) != of.node(j)]
    arcs += [(-1, i) for i in range(count)] + [(i, -1) for i in range(count)]
    cost = [of.lines[i, j] if min(i, j) >= 0 else of.first[j] if i < 0 else of.last[i] for i, j in arcs]
    where = [(of.node(i) if i >= 0 else -1, of.node(j) if j >= 0 else -1) for i, j in arcs]
    equal = [[float(j == k) - float(i == k) for i, j in arcs] for k in range(count)]
    equal += [[float(c == node) for _, c in where] for node in of.nodes]
    equal += [[float(i < 0) for i, _ in arcs], [float(j < 0) for _, j in arcs]]
    least = [0.0] * count + [1.0] * (len(of.nodes) + 2)
    above, most = [], []
    for size in range(2, len(of.nodes)):
        for inside in itertools.combinations(of.nodes, size):
            above.append([float(b in inside and c in inside) for b, c in where])
            most.append(size - 1.0)
    for k in range(count):
        for other in of.nodes:
            if other != of.node(k):
                here = [0.5 * (float(i == k) + float(j == k)) for i, j in arcs]
                there = [
                    float((i == k and c == other) or (j == k and b == other))
                    for (i, j), (b, c) in zip(arcs, where, strict=True)
                ]
                above.append([t - h for t, h in zip(there, here, strict=True)])
                most.append(0.0)
    found = linprog(cost, sparse.csr_array(above), most, sparse.csr_array(equal), least, method="highs")
    assert found.status == 0
    return float(found.fun)


@given(seed=st.integers(0, 10_000), nodes=st.integers(2, 5), cells=st.integers(1, 3))
@settings(max_examples=25, deadline=None)
def test_any_prices_give_a_bound(seed: int, nodes: int, cells: int) -> None:
    """Whatever prices, potentials and prices of turning back: no tour is shorter."""
    of = problem(seed, nodes, cells)
    rng = np.random.default_rng(seed)
    price, potential = rng.normal(0.0, 500.0, nodes), rng.normal(0.0, 500.0, nodes * cells)
    back = np.maximum(rng.normal(0.0, 500.0, (nodes - 1, nodes * cells)), 0.0)
    assert of.ascent(1, price, potential, back) <= of.shortest_m() * (1.0 + 1e-12)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=10, deadline=None)
def test_the_best_prices_reach_the_linear_programme(seed: int) -> None:
    """The ascent ends just below the optimum that HiGHS finds, and never above it."""
    of = problem(seed, 6, 3)
    none = np.zeros(6), np.zeros(18), np.zeros((5, 18))
    optimum = relaxed_m(of)
    assert optimum <= of.shortest_m() * (1.0 + 1e-9)
    assert 0.97 * optimum <= of.ascent(1500, *none) <= optimum * (1.0 + 1e-9)
