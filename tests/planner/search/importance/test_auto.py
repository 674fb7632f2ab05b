"""The most that a battery collects, against every walk of small grids, and its bounds."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.importance_exact import optimum
from benchmarks.importance_maps import maps
from planner.search.importance.auto import Pay, auto
from planner.search.importance.bound import bounded
from planner.search.importance.grid import ImportanceGrid
from planner.search.importance.snyder2021 import snyder2021
from planner.search.importance.walk import measured
from tests.planner.search.importance.brute import closed_walks, paid

PAYS = (Pay(), Pay(1.0, 30.0, 1.0), Pay(0.6))


def _grid(seed: int) -> ImportanceGrid:
    generator = np.random.default_rng(seed)
    worth = generator.choice([0.0, 1.0, 10.0, 100.0], size=(4, 5))
    blocked = generator.random((4, 5)) < 0.2
    blocked[1, 2] = False
    return ImportanceGrid(worth, blocked)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("battery", [0, 1, 2, 9])
def test_small_grids_are_solved(seed: int, battery: int) -> None:
    """No closed walk at all is paid more, with a sensor that misses and with penalties, too."""
    grid, base = _grid(seed), 1 * 5 + 2
    walks = list(closed_walks(grid, base, battery))
    for pay in PAYS:
        found = auto(grid, base, battery, pay, seed=1)
        terms = (battery, pay.detection, pay.revisit, pay.unspent)
        assert tuple(found.cells.tolist()) in walks
        best = max(paid(grid, walk, *terms) for walk in walks)
        assert paid(grid, tuple(found.cells.tolist()), *terms) == pytest.approx(best)
        if pay.detection == 1.0:
            assert bounded(grid, base, battery, pay.revisit, pay.unspent).total >= best - 1e-6
            closed = optimum(grid, base, battery, pay.revisit, pay.unspent, best - 5.0, 10.0)
            assert closed.value == pytest.approx(best)


def test_the_measures_are_those_of_the_looks() -> None:
    """The reward of figure 7 is what counting looks comes to."""
    grid = _grid(3)
    walk = auto(grid, 7, 9)
    assert measured(grid, walk).total_reward(30.0, 2.0) == pytest.approx(
        paid(grid, tuple(walk.cells.tolist()), 9, 1.0, 30.0, 2.0)
    )


@pytest.mark.parametrize("index", [1, 2, 7])
def test_more_than_published_and_no_more_than_the_bound(index: int) -> None:
    """On pinned maps more is collected than by the published algorithm, within the battery and the bound."""
    one = list(maps())[index]
    ours = auto(one.grid, one.base, one.battery, seed=3)
    theirs = snyder2021(one.grid, one.base, one.battery)
    collected = measured(one.grid, ours).importance
    assert collected > measured(one.grid, theirs).importance
    assert collected <= bounded(one.grid, one.base, one.battery).total + 1e-6
    assert ours.moves <= one.battery
    assert ours.cells[0] == ours.cells[-1] == one.base
    row, column = np.divmod(ours.cells, one.grid.shape[1])
    assert (np.abs(np.diff(row)) + np.abs(np.diff(column)) == 1).all()


@pytest.mark.parametrize("seed", [4, 8])
def test_worth_that_lies_scattered_is_collected_whatever_else_is_asked(seed: int) -> None:
    """Penalties and seeds lead elsewhere; none of these ways collects a hundredth more than what is asked."""
    generator = np.random.default_rng(seed)
    worth = generator.lognormal(1.0, 1.5, (15, 15))
    grid, base = ImportanceGrid(worth, np.zeros(worth.shape, dtype=np.bool_)), 6 * 15 + 7
    asked = measured(grid, auto(grid, base, 50)).importance
    others = [
        auto(grid, base, 50, Pay(1.0, revisit, 1.0), seed=k) for k, revisit in enumerate((1.0, 100.0), 1)
    ]
    assert asked >= 0.99 * max(measured(grid, other).importance for other in others)


def test_the_same_seed_gives_the_same_walk() -> None:
    """Twice the same."""
    one = list(maps())[5]
    first, second = (auto(one.grid, one.base, one.battery, seed=9) for _ in range(2))
    assert (first.cells == second.cells).all()


def test_enough_ends_with_a_walk_home() -> None:
    """A search told that it is enough at once still answers with a walk home."""
    one = next(maps())
    walk = auto(one.grid, one.base, one.battery, enough=lambda: True)
    assert walk.cells[0] == walk.cells[-1] == one.base


@pytest.mark.parametrize(
    "bad", [{"detection": 0.0}, {"detection": 1.1}, {"revisit": -1.0}, {"unspent": np.nan}]
)
def test_pay_that_makes_no_sense_is_refused(bad: dict[str, float]) -> None:
    """Probabilities beyond 0 to 1 and penalties that are none."""
    with pytest.raises(ValueError, match="|".join(bad)):
        Pay(**bad)
