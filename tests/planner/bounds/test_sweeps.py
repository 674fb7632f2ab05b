"""The lower bound for regions of many strips: its turns by brute force, and no tour over strips below it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely import affinity
from shapely.geometry import Polygon

from planner.bounds import sweeps_kernels as kernels
from planner.bounds.nodes import nodes
from planner.bounds.sweeps import MOST_ORDERED, sweeps_bound_m
from planner.coverage.strips.sweeps import Sweep, lanes_at, sweeps
from planner.dubins.kernels import dubins_length
from planner.route import Look
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, box, paper_sensor
from tests.planner.coverage.strips.test_sweeps import stars

Floats = NDArray[np.float64]

RADIUS_M = 100.0
#: Of a lane: begin and end, heading.
Lane = tuple[Floats, float]


def never() -> bool:
    return False


@given(least=st.floats(0.0, 600.0), width=st.sampled_from([0.0, 20.0, 200.0]))
@settings(max_examples=30, deadline=None)
def test_turning_back_onto_a_line_takes_no_less(least: float, width: float) -> None:
    """Dubins lines to places along lines at such distances: none is shorter, the shortest hardly longer."""
    along = np.linspace(-500.0, 500.0, 401)
    shortest = min(
        dubins_length(0.0, 0.0, 0.0, x, off, math.pi, RADIUS_M)
        for off in np.linspace(least, least + width, 1 if width == 0.0 else 21)
        for x in along
    )
    bound = kernels.back_m(least, least + width, RADIUS_M)
    assert bound - 1e-6 <= shortest <= bound + 25.0


@given(count=st.integers(2, 5), seed=st.integers(0, 99), both=st.booleans())
@settings(max_examples=30, deadline=None)
def test_turns_are_those_of_the_best_order(count: int, seed: int, both: bool) -> None:
    """Every order of strips, every way to fly each: by half and way at either end, none turns less."""
    rng = np.random.default_rng(seed)
    backs, on = rng.uniform(300.0, 900.0, (2, 2 * count - 1)), float(rng.uniform(300.0, 2000.0))
    best = np.full((4, 4), np.inf)
    for order in itertools.permutations(range(count)):
        for ways in itertools.product((0, 1) if both else (0,), repeat=count):
            legs = itertools.pairwise(zip(order, ways, strict=True))
            cost = sum(on if v == w else backs[v, j - i + count - 1] for (i, v), (j, w) in legs)
            ends = [2 * ways[k] + (0 if 2 * order[k] < count else 1) for k in (0, -1)]
            best[ends[0], ends[1]] = min(best[ends[0], ends[1]], cost)
    out = np.empty((4, 4))
    kernels.turns_m(count, backs, on, np.array([True, both]), out)
    assert out == pytest.approx(best)


def some_lanes(sweep: Sweep, theta: float, eta: float, rng: np.random.Generator) -> list[Lane]:
    """All lanes at a heading and offset, each in any of its states."""
    angles = np.array([theta])
    count = int(sweep.lanes(angles)[0])
    lanes = lanes_at(sweep, angles, np.array([eta]), count)
    states = rng.integers(0, len(lanes.looks), count)
    return [
        (lanes.lines[0, 0, lane, state], float(lanes.headings_rad[0, state]))
        for lane, state in enumerate(states)
    ]


def length_m(begin: Floats, tour: list[Lane], end: Floats) -> float:
    """Of the lanes and the Dubins lines between, from place to place straight on."""
    total = math.dist(begin, tour[0][0][0]) + math.dist(tour[-1][0][1], end)
    total += sum(math.dist(*line) for line, _ in tour)
    for (one, out), (other, into) in itertools.pairwise(tour):
        total += dubins_length(one[1, 0], one[1, 1], out, other[0, 0], other[0, 1], into, RADIUS_M)
    return total


def bound_m(families: Sequence[Sequence[Sweep]], begin: Floats, end: Floats) -> float:
    """The bound for regions by their sweeps, from place to place."""
    passes = [nodes(family, 0.0, k)[0] for k, family in enumerate(families)]
    places = [np.array([*place, 0.0, 0.0]) for place in (begin, end)]
    return sweeps_bound_m(passes, places[0], places[1], RADIUS_M, math.inf, never)


@given(
    areas=st.lists(stars(most_swaths=4.0), min_size=1, max_size=3),
    away=st.floats(0.0, 5000.0),
    looks=st.sampled_from([("right",), ("left",), ("right", "left")]),
    extra=st.integers(0, 1),
    seed=st.integers(0, 999),
)
@settings(max_examples=25, deadline=None)
def test_no_tour_over_strips_is_shorter(
    areas: list[Polygon], away: float, looks: tuple[Look, ...], extra: int, seed: int
) -> None:
    """Passes of several regions in any order, those of one together or parted by others: none is below."""
    rng = np.random.default_rng(seed)
    regions = [affinity.translate(area, k * away, 0.3 * k * away) for k, area in enumerate(areas)]
    families = [sweeps(as_merged(region), paper_sensor(*looks), HEIGHT_M, extra) for region in regions]
    begin, end = rng.uniform(-4000.0, 4000.0, (2, 2))
    bound = bound_m(families, begin, end)
    assert bound > 0.0
    for _ in range(60):
        stays = [
            some_lanes(family[0], rng.uniform(-math.pi, math.pi), rng.choice([0.0, 0.4, 1.0]), rng)
            for family in families
        ]
        tour = [lane for stay in stays for lane in stay]
        # Better and better by moves of one lane, whatever region it is of.
        best = length_m(begin, tour, end)
        for _ in range(12):
            i, j = rng.integers(0, len(tour), 2)
            trial = tour[:i] + tour[i + 1 :]
            trial.insert(j, tour[i])
            if (length := length_m(begin, trial, end)) < best:
                best, tour = length, trial
        assert bound <= best + 1e-6


def test_two_regions_flown_as_one_by_parted_strips_are_not_shorter() -> None:
    """Side by side and in line, both seen with each pass over the gap: the turns saved are allowed for."""
    family = [
        sweeps(as_merged(affinity.translate(box(1500.0, 1700.0), east_m)), paper_sensor(), HEIGHT_M)
        for east_m in (0.0, 1750.0)
    ]
    begin = end = np.array([-500.0, -3500.0])
    lanes = [lanes_at(sweep[0], np.zeros(1), np.zeros(1), 3) for sweep in family]
    best = math.inf
    for order in itertools.permutations(range(3)):
        for way in (0, 1):
            tour: list[Lane] = []
            for k, lane in enumerate(order):
                state = (way + k) % 2
                both = [(of.lines[0, 0, lane, state], float(of.headings_rad[0, state])) for of in lanes]
                tour += both if state == 0 else both[::-1]
            best = min(best, length_m(begin, tour, end))
    bound = bound_m(family, begin, end)
    assert 0.5 * best < bound <= best


def test_a_sweep_of_one_region_is_proved_closely() -> None:
    """A rectangle of four strips seen from near: the best of its sweeps is little above the bound."""
    family = sweeps(as_merged(box(2600.0, 2200.0)), paper_sensor(), HEIGHT_M)
    place = np.array([1000.0 - 2200.0, -2000.0 - 900.0])
    lanes = lanes_at(family[0], np.zeros(1), np.zeros(1), 4)
    best = math.inf
    for order in itertools.permutations(range(4)):
        for way in (0, 1):
            states = [(way + k) % 2 for k in range(4)]
            tour = [
                (lanes.lines[0, 0, lane, state], float(lanes.headings_rad[0, state]))
                for lane, state in zip(order, states, strict=True)
            ]
            best = min(best, length_m(place, tour, place))
    bound = bound_m([family], place, place)
    assert 0.85 * best < bound <= best


def test_more_regions_than_are_ordered_are_bounded_by_trees() -> None:
    """In a row, one more than are searched in order: at least all passes, and not above flying along."""
    count = MOST_ORDERED + 1
    family = [
        sweeps(as_merged(affinity.translate(box(300.0, 800.0), 4000.0 * k)), paper_sensor(), HEIGHT_M)
        for k in range(count)
    ]
    begin, end = np.array([0.0, -2000.0]), np.array([4000.0 * count, -2000.0])
    tour: list[Lane] = []
    for sweep in family:
        lanes = lanes_at(sweep[0], np.zeros(1), np.zeros(1), 2)
        tour += [(lanes.lines[0, 0, lane, lane], float(lanes.headings_rad[0, lane])) for lane in (0, 1)]
    bound = bound_m(family, begin, end)
    assert 0.3 * length_m(begin, tour, end) < bound <= length_m(begin, tour, end)
