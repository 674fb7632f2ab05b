"""``auto`` assignment."""

from benchmarks.fleet_cases import case as problem
from planner.fleet.assign import assign
from planner.fleet.schedule import broken


def test_the_answer_keeps_every_limit_and_does_each_target_once() -> None:
    """Whatever is assigned keeps windows and limits, and nothing is done twice or lost."""
    for seed in range(10):
        given = problem(seed, targets=8, range_m=30_000.0)
        answer = assign(given)
        assert broken(given, answer.trips) == ()
        done = [visit.target for trip in answer.trips for visit in trip.visits]
        assert sorted([*done, *(each.target for each in answer.left_out)]) == list(range(8))


def test_the_same_seed_gives_the_same_answer() -> None:
    """Nothing but problem and seed decides."""
    given = problem(3, targets=8)
    assert assign(given, seed=4) == assign(given, seed=4)
