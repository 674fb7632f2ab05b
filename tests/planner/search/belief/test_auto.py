"""Lines that search for a target: flyable, home in time, and ahead of the manuals' patterns."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from planner.search.belief import auto as planning
from planner.search.belief.auto import Map, auto
from planner.search.belief.patterns import PATTERNS, Searcher, pattern_lines
from planner.search.belief.success import success
from planner.search.belief.target import Belief, Target

TARGET = Target((0.0, 0.0), 350.0, (0.4, 0.1), 0.1, 900.0)
ONE = Searcher((-900.0, 300.0), 20.0, 60.0, 700.0, 100.0, 0.8)


@pytest.fixture(autouse=True)
def few_tries(monkeypatch: pytest.MonkeyPatch) -> None:
    """A part of the usual tries."""
    for name, value in (
        ("PLACES", 512),
        ("SEARCHED", 128),
        ("FIRST", 30),
        ("LEGS", 200),
        ("ROUNDS", 5),
        ("VARIED", 5),
        ("COURSES", 2),
    ):
        monkeypatch.setattr(planning, name, value)


@pytest.mark.parametrize("count", [1, 2])
def test_ahead_of_every_pattern_and_home_in_time(count: int) -> None:
    """By places drawn anew, over the quarters of the flight; lines end where they began, in time."""
    searchers = tuple(replace(ONE, base_m=(-900.0, 300.0 + 150.0 * k)) for k in range(count))
    found = auto(TARGET, searchers, seed=2)
    judge = Belief.drawn(TARGET, 4_000, 77)
    times = 700.0 * np.array([0.25, 0.5, 0.75, 1.0])
    ours = success(found.lines, searchers, judge, times)
    for name in PATTERNS:
        theirs = success(pattern_lines(name, TARGET, searchers), searchers, judge, times)
        assert ours.mean() > theirs.mean(), name
    for line, one in zip(found.lines, searchers, strict=True):
        assert line[0, :2] == pytest.approx(one.base_m)
        assert line[-1, :2] == pytest.approx(one.base_m, abs=1e-6)
        assert line[-1, 2] <= one.until_s + 1e-6
        lengths = np.hypot(*np.diff(line[:, :2], axis=0).T)
        assert lengths.sum() <= one.track_m * (1.0 + 1e-9)
    assert success(found.lines, searchers, Belief.drawn(TARGET, 512, 2), found.times_s) == pytest.approx(
        found.success
    )


def test_lines_keep_out_of_what_is_blocked() -> None:
    """No sample of a line is in the blocked cells, though the target may be there."""
    blocked = np.zeros((80, 80), dtype=np.bool_)
    blocked[40:46, 38:60] = True
    free = Map(blocked, -2000.0, -2000.0, 50.0)
    found = auto(TARGET, (ONE,), free=free, seed=1)
    assert all(free.clear(line) for line in found.lines)
    assert found.success[-1] > 0.1


def test_the_same_seed_gives_the_same_lines() -> None:
    """Twice the same; a search told at once that it is enough still comes home."""
    first, second = (auto(TARGET, (ONE,), seed=4, enough=lambda: True) for _ in range(2))
    assert (first.lines[0] == second.lines[0]).all()
    assert first.lines[0][-1, :2] == pytest.approx(ONE.base_m, abs=1e-6)


@pytest.mark.parametrize("name", PATTERNS)
def test_patterns_are_flown_from_the_base_and_back(name: str) -> None:
    """For one aircraft and for three, within their time; three see more than one."""
    judge = Belief.drawn(TARGET, 2_000, 5)
    by_count = []
    for count in (1, 3):
        searchers = (ONE,) * count
        lines = pattern_lines(name, TARGET, searchers)
        assert all(line[-1, 2] <= ONE.until_s + 1e-6 for line in lines)
        assert all(line[0, :2] == pytest.approx(ONE.base_m) for line in lines)
        by_count.append(success(lines, searchers, judge, np.array([700.0]))[0])
    assert 0.0 < by_count[0] < by_count[1]
