"""What is found of sorted places, held against counting all of them, and lines against their plain twins."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from planner.search.belief.indexed import Indexed, Running, flown_by
from planner.search.belief.legs import improve, reached
from planner.search.belief.patterns import PATTERNS, Searcher, Shape, pattern_corners, pattern_lines
from planner.search.belief.success import success
from planner.search.belief.target import Belief, Target

TARGET = Target((100.0, -50.0), 500.0, (0.6, -0.3), 0.25, 1800.0)
SEARCHERS = (
    Searcher((-900.0, 300.0), 20.0, 60.0, 900.0, 100.0, 0.8),
    Searcher((-700.0, 500.0), 16.0, 45.0, 1100.0, 70.0, 0.6),
)
TIMES = 1100.0 * np.arange(1, 13) / 12.0


def indexed(soft_m: float = 0.0) -> Indexed:
    """Two thousand places."""
    return Indexed.of(Belief.drawn(TARGET, 2_000, 3), TIMES, 70.0, soft_m)


@pytest.mark.parametrize("name", PATTERNS)
@pytest.mark.parametrize("shape", [Shape(), Shape(1.3, 0.7, 0.8, True, 0.3, True)])
def test_lines_and_what_they_find_are_those_of_the_plain_ways(name: str, shape: Shape) -> None:
    """Lines to a micrometre; what they find by each time as if all places were looked through."""
    lines = pattern_lines(name, TARGET, SEARCHERS, shape)
    drawn = pattern_corners(name, TARGET, SEARCHERS, shape)
    for line, corners, one in zip(lines, drawn, SEARCHERS, strict=True):
        own = flown_by(reached(corners, one), one)
        assert own.shape == line.shape
        assert np.abs(own - line).max() < 1e-6
    plain = success(lines, SEARCHERS, Belief.drawn(TARGET, 2_000, 3), TIMES)
    assert indexed().success(lines, SEARCHERS) == pytest.approx(plain, abs=1e-12)


def test_softened_edges_find_what_many_places_would() -> None:
    """A pass beside one place that stands for ground round it: as much as of ground that wide is seen."""
    line = np.array([[0.0, 0.0, 0.0], [1000.0, 0.0, 50.0]])
    one = Searcher((0.0, 0.0), 20.0, 60.0, 900.0, 100.0, 0.5)
    for aside_m, part in ((85.0, 1.0), (95.0, 0.75), (100.0, 0.5), (108.0, 0.1), (111.0, 0.0)):
        places = np.array([[500.0, aside_m], [-5000.0, 0.0]])
        belief = Belief(places, np.zeros((2, 2)), np.array([1.0, 0.0]))
        soft = Indexed.of(belief, TIMES, 100.0, 20.0)
        assert soft.success([line], [one])[-1] == pytest.approx(0.5 * part)


def test_a_changed_line_is_reckoned_from_where_it_differs() -> None:
    """After many changes, kept or not, the value is that of the lines anew; they are home in time."""
    found = indexed(10.0)

    def worth(by_time: NDArray[np.float64]) -> float:
        return float(by_time.mean())

    drawn = pattern_corners("sector", TARGET, SEARCHERS)
    corners = [reached(each, one) for each, one in zip(drawn, SEARCHERS, strict=True)]
    running = Running(
        found, SEARCHERS, worth, [flown_by(each, one) for each, one in zip(corners, SEARCHERS, strict=True)]
    )
    before = running.value
    improve(running, corners, SEARCHERS, lambda _: True, 300, np.random.default_rng(2), lambda: False)
    assert running.value > before
    assert running.value == pytest.approx(worth(found.success(running.lines, SEARCHERS)), abs=1e-12)
    for line, each, one in zip(running.lines, corners, SEARCHERS, strict=True):
        assert (line == flown_by(each, one)).all()
        assert line[-1, 2] <= one.until_s + 1e-6
        assert math.dist(line[-1, :2], one.base_m) < 1e-6


def test_lines_are_not_changed_to_what_is_not_clear() -> None:
    """Where nothing else is free the lines stay."""
    corners = [reached(pattern_corners("sector", TARGET, SEARCHERS[:1])[0], SEARCHERS[0])]
    line = flown_by(corners[0], SEARCHERS[0])
    running = Running(indexed(), SEARCHERS[:1], lambda by_time: float(by_time.mean()), [line])
    improve(running, corners, SEARCHERS[:1], lambda _: False, 50, np.random.default_rng(2), lambda: False)
    assert running.lines[0] is line
