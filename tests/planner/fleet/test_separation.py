"""Delays that keep flights apart: against every moment looked at, and least."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from planner.fleet.separation import Track, least_delay_s
from planner.wishes import Separation

Floats = NDArray[np.float64]
KEPT = Separation(100.0, 30.0)


def line(
    start: tuple[float, float], end: tuple[float, float], altitude_m: float, from_s: float = 0.0
) -> Track:
    """A straight flown at 20 m/s, a place every 10 m."""
    length_m = float(np.hypot(end[0] - start[0], end[1] - start[1]))
    parts = np.linspace(0.0, 1.0, int(length_m / 10.0) + 1)
    places = np.array(start) + parts[:, None] * (np.array(end) - np.array(start))
    rows = np.column_stack([from_s + parts * length_m / 20.0, places, np.full(len(parts), altitude_m)])
    return Track(rows, np.zeros(len(parts)))


def least_m(one: Track, other: Track) -> float:
    """The nearest at any tenth of a second, flights at other heights left out."""
    times = np.arange(
        max(one.places[0, 0], other.places[0, 0]), min(one.places[-1, 0], other.places[-1, 0]), 0.1
    )
    if not len(times):
        return np.inf
    at = [
        np.column_stack([np.interp(times, t.places[:, 0], t.places[:, k]) for k in (1, 2, 3)])
        for t in (one, other)
    ]
    near = np.abs(at[0][:, 2] - at[1][:, 2]) < KEPT.vertical_m
    apart = np.hypot(*(at[0] - at[1])[:, :2].T)
    return float(apart[near].min(initial=np.inf))


@pytest.mark.parametrize("seed", range(20))
def test_delayed_flights_are_apart_at_every_moment(seed: int) -> None:
    """Three random straights that may cross: each put off by its least delay is apart from those before."""
    rng = np.random.default_rng(seed)
    placed: list[Track] = []
    for _ in range(3):
        ends = rng.uniform(-1500.0, 1500.0, (2, 2))
        track = line(tuple(ends[0]), tuple(ends[1]), float(rng.choice([100.0, 115.0, 140.0])))
        track = track.later(least_delay_s(placed, track, KEPT))
        assert all(least_m(track, other) >= KEPT.horizontal_m for other in placed)
        placed.append(track)


def test_the_delay_is_little_more_than_the_crossing_asks_for() -> None:
    """Of two that would meet where their lines cross one waits for as long as the other needs to be gone."""
    one = line((-1000.0, 0.0), (1000.0, 0.0), 100.0)
    other = line((0.0, -1000.0), (0.0, 1000.0), 100.0)
    delay_s = least_delay_s([one], other, KEPT)
    # At right angles and equal speeds they come no nearer than v t / √2 for a delay of t.
    exact_s = KEPT.horizontal_m * np.sqrt(2.0) / 20.0
    assert exact_s <= delay_s <= exact_s + 5.0


@pytest.mark.parametrize("other_m", [131.5, 68.0])
def test_flights_apart_in_height_wait_for_nothing(other_m: float) -> None:
    """The height between them is enough."""
    one = line((-1000.0, 0.0), (1000.0, 0.0), 100.0)
    assert least_delay_s([one], line((1000.0, 0.0), (-1000.0, 0.0), other_m), KEPT) == 0.0


def test_who_asks_for_no_distance_waits_for_nobody() -> None:
    """A separation of nothing rules out no delay."""
    one = line((-1000.0, 0.0), (1000.0, 0.0), 100.0)
    assert least_delay_s([one], one, Separation(0.0, 0.0)) == 0.0
