"""More reward than this no route within the budget brings: a linear relaxation, solved by HiGHS.

Every place is left as often as it is come to, at most once; the start is left once, the end come to once; the
way is within the budget. Tours apart from the start are not forbidden and places may be visited in part: the
relaxation only adds routes, so that its optimum bounds them all.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array

from planner.errors import PlannerError
from planner.fleet.prizes.problem import Prizes

#: What the solver's tolerances may take from its optimum, of all rewards.
TOLERANCE = 1e-6


def reward_bound(prizes: Prizes) -> float:
    """An upper bound of the reward of any route within the budget.

    Raises
    ------
    ValueError
        Where no route is within the budget.
    PlannerError
        Where the solver gives up.
    """
    count = len(prizes.rewards)
    usable = np.isfinite(prizes.costs) & ~np.eye(count, dtype=bool)
    # Nothing leads to the start or on from the end.
    usable[:, 0] = usable[-1, :] = False
    leaving, arriving = np.nonzero(usable)
    steps = len(leaving)
    if steps == 0:
        raise ValueError("no route is within the budget")
    columns, ones = np.arange(steps), np.ones(steps)
    out = csr_array((ones, (leaving, columns)), shape=(count, steps))
    into = csr_array((ones, (arriving, columns)), shape=(count, steps))
    balance = csr_array(out - into)
    wanted = np.zeros(count)
    wanted[0], wanted[-1] = 1.0, -1.0
    way = prizes.costs[leaving, arriving][None, :]
    gained = np.where(arriving < count - 1, np.maximum(prizes.rewards[arriving], 0.0), 0.0)
    found = milp(
        -gained,
        constraints=[
            LinearConstraint(balance, wanted, wanted),
            LinearConstraint(into, -np.inf, 1.0),
            LinearConstraint(way, -np.inf, prizes.budget),
        ],
        bounds=Bounds(0.0, 1.0),
    )
    if found.status == 2:
        raise ValueError("no route is within the budget")
    if found.status != 0:
        raise PlannerError(f"no bound of the reward: {found.message}")
    ends = float(prizes.rewards[0] + prizes.rewards[-1])
    return ends - float(found.fun) + TOLERANCE * float(np.abs(prizes.rewards).sum())
