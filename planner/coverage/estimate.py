"""What a tour through a few targets costs, about: for comparing divisions of one region."""

from __future__ import annotations

import itertools

import numpy as np
from numpy.typing import NDArray

from planner.airspace.surroundings import Surroundings
from planner.dubins.estimate_kernels import transit_costs
from planner.orders_kernels import best_orders

Floats = NDArray[np.float64]

#: Entries (K, 3), exits (K, 3) and costs between them (K,) of some options of one target.
Ends = tuple[Floats, Floats, Floats]

#: Every order is tried up to this many targets.
EXACT_UP_TO = 4


def least_tour_m(found: list[Ends], around: Surroundings) -> float:
    """Length of the cheapest open tour through one option of each target."""
    if len(found) > EXACT_UP_TO:
        return _in_order_m(found, around)
    entries, exits, inner_m = (np.concatenate(column) for column in zip(*found, strict=True))
    offsets = np.concatenate([[0], np.cumsum([len(part[2]) for part in found])]).astype(np.int64)
    if len(found) == 1:
        return float(inner_m.min())
    between = transit_costs(exits, entries, around.radius_m, around.discs) + inner_m[None, :]
    nothing = np.zeros(len(inner_m))
    costs, _ = best_orders(inner_m, between, nothing, offsets)
    return float(costs.min())


def _in_order_m(found: list[Ends], around: Surroundings) -> float:
    """The same through the targets in their order."""
    cost_m = found[0][2]
    for (_, leaving, _), (arriving, _, inner_m) in itertools.pairwise(found):
        between_m = transit_costs(leaving, arriving, around.radius_m, around.discs)
        cost_m = (cost_m[:, None] + between_m).min(axis=0) + inner_m
    return float(cost_m.min())
