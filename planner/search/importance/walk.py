"""A closed walk over the grid, and its measures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.search.importance.grid import ImportanceGrid, Ints


@dataclass(frozen=True, slots=True, eq=False)
class Walk:
    """Cells in the order flown, the base first and last.

    Parameters
    ----------
    cells
        int64 (moves + 1,): indices of cells, row by row.
    battery
        Moves that the battery would have allowed.
    """

    cells: Ints
    battery: int

    @property
    def moves(self) -> int:
        """Moves from a cell to the next."""
        return len(self.cells) - 1


@dataclass(frozen=True, slots=True)
class Measures:
    """Measures of a walk as Snyder et al. (2021) define them.

    Parameters
    ----------
    covered_m2
        J1, equation (1): the area of the cells seen.
    unspent
        J2, equation (2): moves left in the battery at the base.
    importance
        Sum of the worth of the cells seen; J3, equation (3), where the worth is of the cell's area.
    revisits
        Moves onto a cell seen before, the last onto the base left out.
    """

    covered_m2: float
    unspent: int
    importance: float
    revisits: int

    def cost(self, weights: tuple[float, float, float] = (1.0, 1.0, 1.0)) -> float:
        """J_total, equation (4), lower is better."""
        alpha_1, alpha_2, alpha_3 = weights
        return -alpha_1 * self.covered_m2 + alpha_2 * self.unspent - alpha_3 * self.importance

    def total_reward(self, revisit: float = 100.0, unspent: float = 1.0) -> float:
        """The total of the paper's figure 7: importance less penalties of revisits and of unspent moves."""
        return self.importance - revisit * self.revisits - unspent * self.unspent


def measured(grid: ImportanceGrid, walk: Walk) -> Measures:
    """Measure a walk; the worth of each cell counts once."""
    seen = np.unique(walk.cells)
    closing = int(walk.moves > 0)
    return Measures(
        covered_m2=len(seen) * grid.cell_m**2,
        unspent=walk.battery - walk.moves,
        importance=float(grid.worth.reshape(-1)[seen].sum()),
        revisits=len(walk.cells) - closing - len(seen),
    )
