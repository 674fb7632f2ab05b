"""What looks find of a drifting target, against counting by hand and dense sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planner.search.belief.kernels import home_m, looks_by_time
from planner.search.belief.lines import homeward, timed
from planner.search.belief.patterns import Searcher
from planner.search.belief.success import success
from planner.search.belief.target import Belief, Target

STILL = np.zeros((1, 2))


def _searcher(detection: float = 0.5) -> Searcher:
    return Searcher((0.0, 0.0), 20.0, 50.0, 600.0, 100.0, detection)


def test_looks_are_counted_by_time() -> None:
    """Two passes over a place and one too far beside it: one look, then two."""
    there = timed(np.array([[0.0, 0.0], [1000.0, 0.0], [1000.0, 250.0], [0.0, 50.0]]), 20.0)
    places = np.array([[500.0, 60.0], [500.0, -120.0]])
    times = np.array([20.0, 51.0, 200.0])
    looks = looks_by_time(there, places, np.zeros((2, 2)), 100.0, times)
    assert looks.tolist() == [[0, 0], [1, 0], [2, 0]]


def test_drifting_places_are_looked_at_where_they_are_then() -> None:
    """One that drifts out of the way is not seen; one that drifts in is; as sampled every half metre."""
    generator = np.random.default_rng(8)
    places = generator.uniform(-200.0, 1200.0, (300, 2))
    drifts = generator.normal(0.0, 2.0, (300, 2))
    line = timed(np.array([[0.0, 0.0], [1000.0, 0.0]]), 20.0)
    looks = looks_by_time(line, places, drifts, 100.0, line[-1:, 2])[0]
    times = np.arange(0.0, line[-1, 2], 0.025)
    at = places[:, None] + times[:, None] * drifts[:, None]
    ahead = at[..., 0] - 20.0 * times
    crossed = (ahead[:, :-1] >= 0.0) & (ahead[:, 1:] < 0.0)
    beside = np.abs(at[:, :-1, 1]) <= 100.0
    sampled = (crossed & beside).sum(axis=1)
    edge = np.abs(
        np.abs(np.where(crossed.any(1), (np.where(crossed, at[:, :-1, 1], 0.0)).sum(1), 1e9)) - 100.0
    )
    moved = np.abs(drifts[:, 1]) * line[-1, 2]
    sure = edge > moved
    assert sure.sum() > 200
    assert (looks[sure] == sampled[sure]).all()


@pytest.mark.parametrize("looks", [1, 2, 3])
def test_looks_again_pay_less(looks: int) -> None:
    """1 - (1 - p)^k after k looks, together of several aircraft."""
    belief = Belief(np.array([[500.0, 0.0]]), STILL, np.ones(1))
    line = timed(np.array([[0.0, 0.0], [1000.0, 0.0]]), 20.0)
    one = _searcher(0.4)
    found = success([line] * looks, [one] * looks, belief, line[-1:, 2])
    assert found == pytest.approx([1.0 - 0.6**looks])


def test_belief_is_where_the_target_was_known_and_drifts() -> None:
    """Mean and spread are those of the datum and its error at each time."""
    target = Target((100.0, -50.0), 300.0, (0.5, -0.2), 0.1, 1800.0)
    belief = Belief.drawn(target, 20_000, 3)
    for time_s in (0.0, 1200.0):
        places = belief.places_m + time_s * belief.drifts_m_s
        assert places.mean(axis=0) == pytest.approx(target.datum_m(time_s), abs=15.0)
        assert places.std(axis=0) == pytest.approx([target.error_m(time_s)] * 2, rel=0.03)


def test_what_was_seen_is_believed_less() -> None:
    """After looks that found nothing, weights are Bayes' but for their sum, which is that of a miss."""
    belief = Belief(np.array([[0.0, 0.0], [10.0, 0.0]]), np.ones((2, 2)), np.array([0.5, 0.5]))
    after = belief.after(np.array([2, 0]), 0.5, 10.0)
    assert after.weights.tolist() == [0.125, 0.5]
    assert after.places_m.tolist() == [[10.0, 10.0], [20.0, 10.0]]


@pytest.mark.parametrize("seed", range(5))
def test_ways_home_are_as_short_as_said_and_bend_no_tighter(seed: int) -> None:
    """The line home is as long as priced, arrives, in time, and its arcs are of the radius."""
    generator = np.random.default_rng(seed)
    out = timed(
        np.cumsum(np.vstack([[0.0, 0.0], np.tile(generator.normal(0.0, 80.0, 2), (30, 1))]), axis=0), 20.0
    )
    end = tuple(generator.uniform(-400.0, 400.0, 2).tolist())
    line = homeward(out, end, 20.0, 50.0, 200.0)
    assert line[-1, :2] == pytest.approx(end, abs=1e-6)
    assert line[-1, 2] <= 200.0 + 1e-6
    lengths = np.hypot(*np.diff(line[:, :2], axis=0).T)
    assert lengths.sum() / 20.0 == pytest.approx(line[-1, 2], rel=0.01)
    turns = np.abs(np.diff(np.unwrap(np.arctan2(*np.diff(line[:, :2], axis=0).T[::-1]))))
    # Chords of an arc turn by length over radius.
    assert (turns <= 0.5 * (lengths[:-1] + lengths[1:]) / 50.0 * 1.1 + 1e-6).all()


def test_a_place_within_both_turns_cannot_be_reached_so() -> None:
    """Half a radius beside the aircraft no arc and straight line ends."""
    assert home_m(0.0, 0.0, 0.0, 0.0, 25.0, 50.0) < math.inf
    assert home_m(0.0, 0.0, 0.0, 0.0, 0.0, 50.0) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("bad", [{"spread_m": -1.0}, {"spread_m": math.nan}, {"elapsed_s": -5.0}])
def test_targets_that_make_no_sense_are_refused(bad: dict[str, float]) -> None:
    """Spreads and times below 0, not a number."""
    with pytest.raises(ValueError, match="finite"):
        Target((0.0, 0.0), **({"spread_m": 1.0} | bad))
