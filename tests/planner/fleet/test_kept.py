"""An order that is kept: nothing of it moves, what is new is put in, all within the limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planner.fleet.assign import assign
from planner.fleet.kept import MOST_NEW, kept
from planner.fleet.problem import Alternative, Member, Objective, Problem, Service, Target, Travel
from planner.fleet.schedule import broken

FLEET = 2


def drawn(seed: int, targets: int, most_s: float = math.inf) -> Problem:
    """Targets at random places, two ways to do each, for two aircraft of different speed."""
    rng = np.random.default_rng(seed)
    places = np.concatenate(
        [np.zeros((1, 2)), np.repeat(rng.uniform(-1000.0, 1000.0, (targets, 2)), 2, axis=0)]
    )
    apart_m = np.hypot(*(places[:, None] - places[None, :]).transpose(2, 0, 1))
    apart_m = apart_m * rng.uniform(1.0, 1.3, apart_m.shape)
    np.fill_diagonal(apart_m, 0.0)
    members = tuple(
        Member(f"m{k}", Travel(apart_m / (20.0 + 5.0 * k)), max_flight_s=most_s) for k in range(FLEET)
    )
    both = tuple(Alternative(f"way {k}", (Service(20.0), Service(16.0))) for k in range(2))
    wanted = tuple(Target(f"t{k}", both, required=bool(rng.integers(2))) for k in range(targets))
    return Problem(("home",), wanted, members, Objective(1.0, 0.1, priority=1e4))


@pytest.mark.parametrize("seed", range(12))
def test_the_old_order_stays_and_what_is_new_is_put_in(seed: int) -> None:
    """Of each aircraft the old targets in their order; no limit broken; never better than what is free."""
    problem = drawn(seed, 7)
    rng = np.random.default_rng(seed)
    old = rng.permutation(7)[:5].tolist()
    orders = {0: old[:3], 1: old[3:]}
    found = kept(problem, orders)
    assert found is not None
    assert broken(problem, found.trips) == ()
    for trip in found.trips:
        own = [visit.target for visit in trip.visits if visit.target in old]
        assert own == orders[trip.member]
    assert found.left_out == ()
    assert found.cost >= assign(problem, seed).cost - 1e-6
    again = kept(problem, {trip.member: [visit.target for visit in trip.visits] for trip in found.trips})
    assert again is not None
    assert again.cost == pytest.approx(found.cost)


def test_what_breaks_a_limit_or_is_all_new_is_not_kept() -> None:
    """An order longer than a flight may last; more that is new than is put in; nothing that is old."""
    short = drawn(3, 6, most_s=60.0)
    assert kept(short, {0: [0, 1, 2, 3, 4, 5]}) is None
    assert kept(drawn(4, MOST_NEW + 2), {0: [0]}) is None
    assert kept(drawn(4, 3), {}) is None
