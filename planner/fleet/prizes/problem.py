"""What there is to collect, and what was."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Prizes:
    """Places with rewards, and what it costs to get from one to another.

    Parameters
    ----------
    costs
        Shape (N, N): from each place to each, inf where there is no way. The first is the start, the last the
        end; a closed route has its depot as both.
    rewards
        Shape (N,), each counted once, at the first visit; 0 at start and end where they bring none.
    budget
        What the route may cost.
    """

    costs: Floats
    rewards: Floats
    budget: float

    def __post_init__(self) -> None:
        places = len(self.rewards)
        if self.costs.shape != (places, places):
            raise ValueError(f"costs are {self.costs.shape}, there are {places} places")
        # Kernels take C-ordered floats.
        object.__setattr__(self, "costs", np.ascontiguousarray(self.costs, dtype=np.float64))
        object.__setattr__(self, "rewards", np.ascontiguousarray(self.rewards, dtype=np.float64))
        if places < 2:
            raise ValueError("a route has a start and an end")
        if np.isnan(self.costs).any() or not np.isfinite(self.rewards).all():
            raise ValueError("costs and rewards are numbers")

    def cost(self, order: tuple[int, ...]) -> float:
        """Of a route from start to end."""
        steps = np.array(order)
        return float(self.costs[steps[:-1], steps[1:]].sum())

    def reward(self, order: tuple[int, ...]) -> float:
        """Of the places on a route."""
        return float(self.rewards[list(order)].sum())


@dataclass(frozen=True, slots=True)
class Gathered:
    """A route from start to end.

    Parameters
    ----------
    order
        Places in order, start and end among them.
    reward, cost
        What it brings and takes.
    """

    order: tuple[int, ...]
    reward: float
    cost: float

    def better_than(self, other: Gathered) -> bool:
        """More reward, or as much for less."""
        return (self.reward, -self.cost) > (other.reward, -other.cost)
