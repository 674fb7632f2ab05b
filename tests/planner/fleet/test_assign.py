"""``auto`` assignment."""

from dataclasses import replace
from itertools import pairwise

import pytest

from benchmarks.fleet_cases import case as problem
from planner.errors import CancelledError
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


def test_visits_of_one_target_are_apart() -> None:
    """Each of three visits starts the asked time after the end of the one before, whoever flies it."""
    given = problem(4, targets=10, windows=0.0)
    often = tuple(
        replace(target, visits=3, revisit_after_s=900.0) if number < 2 else target
        for number, target in enumerate(given.targets)
    )
    answer = assign(replace(given, targets=often), iterations=300)
    assert broken(replace(given, targets=often), answer.trips) == ()
    assert answer.left_out == ()
    for number in range(2):
        visits = sorted(
            (visit.start_s, visit.end_s)
            for trip in answer.trips
            for visit in trip.visits
            if visit.target == number
        )
        assert len(visits) == 3
        assert all(later[0] - former[1] >= 900.0 - 1e-6 for former, later in pairwise(visits))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("revisits", [1, 3])
def test_windows_too_short_for_what_they_ask_are_left_out(seed: int, revisits: int) -> None:
    """A window that is over before a visit can be, or the last of three, is never kept by waiting."""
    given = problem(seed, targets=5, windows=0.0)
    asked = []
    for number, target in enumerate(given.targets):
        service_s = max(s.service_s for way in target.alternatives for s in way.services if s is not None)
        apart_s = 200.0 if revisits > 1 else 0.0
        # For some targets what they ask for fits, for others it does not, by less than one visit.
        short_s = (0.2 + 0.2 * number) * service_s if number % 2 else -300.0
        window_s = (4000.0, 4000.0 + revisits * service_s + (revisits - 1) * apart_s - short_s)
        asked.append(replace(target, window_s=window_s, visits=revisits, revisit_after_s=apart_s))
    tight = replace(given, targets=tuple(asked))
    answer = assign(tight, iterations=1500)
    assert broken(tight, answer.trips) == ()
    done = [visit.target for trip in answer.trips for visit in trip.visits]
    left = {each.target for each in answer.left_out}
    assert all(done.count(number) == revisits for number in range(5) if number not in left)
    assert left


def test_work_beyond_one_battery_takes_further_trips() -> None:
    """What one trip's energy does not suffice for is flown in several, a turnaround apart."""
    given = problem(6, targets=12, members=1, windows=0.0, energy_wh=700.0)
    more = replace(given, members=(replace(given.members[0], trips=5, turnaround_s=300.0),))
    one, several = assign(given, iterations=1500), assign(more, iterations=1500)
    assert one.status == "infeasible"
    assert several.status == "feasible"
    assert broken(more, several.trips) == ()
    assert len(several.trips) > 1
    for former, later in pairwise(several.trips):
        assert later.take_off_s >= former.landing_s + 300.0 - 1e-6


def test_what_is_left_out_has_its_limit_and_the_margin_that_would_do() -> None:
    """Giving the limit its margin makes the target possible, a little less does not."""
    given = problem(6, targets=1, members=1, windows=0.0, energy_wh=50.0)
    (left,) = assign(given).left_out
    assert (left.limit, left.aircraft, left.required) == ("energy", "a0", True)
    enough = replace(given.members[0], energy_wh=50.0 + left.margin + 1e-6)
    assert assign(replace(given, members=(enough,))).left_out == ()
    short = replace(given.members[0], energy_wh=50.0 + left.margin - 1.0)
    assert assign(replace(given, members=(short,))).status == "infeasible"


def test_a_stopped_search_says_so() -> None:
    """Stop is asked while searching."""
    with pytest.raises(CancelledError):
        assign(problem(1, targets=12), stop=lambda: True)
