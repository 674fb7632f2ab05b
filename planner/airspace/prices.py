"""What the weights of the objective make of soft threats, in metres of way.

A metre inside a threat's disc costs ``INSIDE_FACTOR`` metres of way where the weights are equal, else by the
weight of its risk over that of way, as a metre at risk 1 does in ``planner.transit.refine``; SSAS weighs them
by eq 25 of Li, Chen, Wang, Li (2018). Way, time and energy are in proportion, as far as one line and another
go: the weights of length and energy add up.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from planner.airspace.airspace import Airspace, Level
from planner.airspace.room_kernels import inside_m
from planner.airspace.shapes import acts
from planner.wishes import Objective

Floats = NDArray[np.float64]

#: A metre inside a threat disc costs as much as this many outside, where the weights are equal.
INSIDE_FACTOR = 20.0


def way_weight(objective: Objective) -> float:
    """Of a metre of way; 1 where the objective gives it none, so that prices stay finite."""
    weight = objective.length + objective.energy
    return weight if weight > 0.0 else 1.0


def soft_prices(airspace: Airspace, level: Level, objective: Objective) -> Floats:
    """Discs of soft threats whose risk has weight, with what a metre inside costs besides, (K, 4)."""
    weights = {"missile": objective.missile, "radar": objective.radar}
    way = way_weight(objective)
    rows = [
        (*threat.centre, threat.radius_m, INSIDE_FACTOR * weights[threat.model] / way)
        for threat in airspace.threats
        if not threat.hard and weights[threat.model] > 0.0 and acts(threat, level.height_m)
    ]
    return np.array(rows, dtype=np.float64).reshape(-1, 4)


def risk_m(line: Floats, priced: Floats) -> float:
    """What of a polyline (N, 2) lies in priced discs (K, 4), by price; overlaps of one price count once."""
    return float(risks_m(line[None], priced)[0])


def risks_m(lines: Floats, priced: Floats) -> Floats:
    """The same of many polylines (M, N, 2), (M,)."""
    costs_m = np.zeros(len(lines))
    for price in np.unique(priced[:, 3]).tolist():
        of_price = np.ascontiguousarray(priced[priced[:, 3] == price, :3])
        costs_m += price * inside_m(np.ascontiguousarray(lines), of_price)
    return costs_m
