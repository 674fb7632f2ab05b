"""Assignments over measured legs."""

from __future__ import annotations

from dataclasses import replace

import pytest

from benchmarks.fleet_cases import case
from planner.errors import OutOfBudgetError
from planner.fleet.assign import assign
from planner.fleet.flyable import Leg, assign_flyable
from planner.fleet.problem import Problem, Travel


def longer(given: Problem, number: int, a: int, b: int) -> Leg:
    """Up to half more than the matrix says, by the arc's numbers."""
    travel = given.members[number].travel
    factor = 1.0 + 0.1 * ((7 * number + 3 * a + 5 * b) % 6)
    assert travel.length_m is not None
    return Leg(float(travel.seconds[a, b]) * factor, float(travel.length_m[a, b]) * factor)


@pytest.mark.parametrize("seed", range(4))
def test_it_is_the_best_over_all_legs_measured(seed: int) -> None:
    """Measuring what is flown alone comes to the same as measuring everything beforehand."""
    given = case(seed, targets=5)
    asked: set[tuple[int, int, int]] = set()

    def measure(number: int, a: int, b: int) -> Leg:
        asked.add((number, a, b))
        return longer(given, number, a, b)

    answer, _ = assign_flyable(given, measure)
    members = []
    for number, member in enumerate(given.members):
        seconds = member.travel.seconds.copy()
        for a in range(len(seconds)):
            for b in range(len(seconds)):
                seconds[a, b] = longer(given, number, a, b).seconds
        members.append(replace(member, travel=Travel(seconds, member.travel.length_m)))
    every = assign(replace(given, members=tuple(members)))
    assert answer.cost == pytest.approx(every.cost)
    assert len(asked) < given.node_count**2


def test_rounds_that_do_not_suffice_are_said() -> None:
    """No answer over guessed legs is given out as measured."""
    given = case(1, targets=5)
    with pytest.raises(OutOfBudgetError, match="measured"):
        assign_flyable(given, lambda number, a, b: longer(given, number, a, b), rounds=1)
