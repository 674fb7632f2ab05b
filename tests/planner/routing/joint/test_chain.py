"""Options of regions in a row: the cheapest way through, and true costs put in the place of estimates."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.coverage.strips.options import Options, collect_passes, make_options
from planner.coverage.strips.targets import StripTarget
from planner.dubins.words import shortest_between
from planner.errors import CancelledError
from planner.geojson import read_scenario
from planner.progress import never
from planner.route import Anchor, CollectPass
from planner.routing.joint.chain import (
    FADE_M,
    TRUE_WITHIN_M,
    Layers,
    from_start,
    layers_of,
    to_end,
    true_choice,
)
from planner.routing.legs import Legs
from tests.planner.scenarios import feature, small, square
from tests.planner.stages import ends_of, sides_of, surroundings
from tests.planner.stages import legs_of as legs_in

HEADINGS_RAD = np.arange(-math.pi, math.pi - 1e-9, math.radians(45.0))
ETAS = np.array([0.0, 0.5, 1.0])

C = feature("C", "roi", "Polygon", square(0.012, 0.03, 0.003))
SCENARIO = read_scenario(small(C))
AROUND = surroundings(SCENARIO)
SIDES = sides_of(SCENARIO)
OPTIONS = [options for of in SIDES if (options := make_options(of, HEADINGS_RAD, ETAS, AROUND)) is not None]


def all_ways(first: np.ndarray, between: list[np.ndarray], last: np.ndarray) -> np.ndarray:
    """What each way through the layers costs, one axis a layer."""
    cost = first
    for leg in between:
        cost = cost[..., :, None] + leg
    return cost + last


def at_random(rng: np.random.Generator, sizes: list[int], *, blocked: float = 0.0) -> Layers:
    """Layers with costs drawn from 0 to 1000 m, some of them inf, and options kilometres apart."""

    def costs(*shape: int) -> np.ndarray:
        drawn = rng.uniform(0.0, 1000.0, shape)
        return np.where(rng.uniform(size=shape) < blocked, np.inf, drawn)

    places = []
    for size in sizes:
        poses = np.column_stack([rng.uniform(0, 1e6, (size, 2)), rng.uniform(-3, 3, size)])
        places.append(bare(poses))
    between = tuple(costs(a, b) for a, b in itertools.pairwise(sizes))
    return Layers(tuple(places), costs(sizes[0]), between, costs(sizes[-1]))


class Table(Legs):
    """Legs whose costs stand in tables in the place of lines."""

    def __init__(self, options: tuple[Options, ...], truth: Layers) -> None:
        self.asked = 0
        self._truth = truth
        self._exits = {tuple(row): (k, i) for k, o in enumerate(options) for i, row in enumerate(o.exits)}
        self._entries = {tuple(row): (k, i) for k, o in enumerate(options) for i, row in enumerate(o.entries)}

    def between_m(self, leaving: np.ndarray | None, arriving: np.ndarray | None) -> float:
        """From the tables."""
        self.asked += 1
        if leaving is None:
            return float(self._truth.first[self._entries[tuple(arriving)][1]])
        place, option = self._exits[tuple(leaving)]
        if arriving is None:
            return float(self._truth.last[option])
        return float(self._truth.between[place][option, self._entries[tuple(arriving)][1]])

    def inner_m(self, passes: object) -> float:
        """What the option costs by itself, of ``truth``'s options."""
        place, option = passes
        return float(self._truth.options[place].inner_m[option])


class Numbered:
    """A target at a place of options at random, which see nothing: for passes, its place and their number."""

    def __init__(self, place: int) -> None:
        self._place = place

    def passes(self, _: object, option: int) -> tuple[int, int]:
        """Place and number."""
        return self._place, option


def numbered(count: int) -> list[Numbered]:
    return [Numbered(place) for place in range(count)]


def bare(entries: np.ndarray, inner_m: np.ndarray | None = None) -> Options:
    """Options at places, that end where they begin, and cost nothing by themselves but what is said."""
    zeros, none = np.zeros(len(entries)), np.empty((len(entries), 0), dtype=np.int64)
    inner_m = zeros if inner_m is None else inner_m
    exits = entries + np.array([1.0, 0.0, 0.0])
    return Options(none.sum(axis=1), zeros, zeros, zeros, entries, exits, inner_m, none)


@settings(deadline=None, max_examples=80)
@given(st.integers(0, 10_000), st.lists(st.integers(1, 6), min_size=1, max_size=4), st.floats(0.0, 0.3))
def test_best_is_what_trying_every_way_finds(seed: int, sizes: list[int], blocked: float) -> None:
    """The cheapest way through the layers costs what brute force says, blocked legs or not."""
    layers = at_random(np.random.default_rng(seed), sizes, blocked=blocked)
    every = all_ways(layers.first, list(layers.between), layers.last)
    cost_m, chosen = layers.best()
    assert cost_m == pytest.approx(every.min())
    if math.isfinite(cost_m):
        assert every[tuple(chosen)] == pytest.approx(cost_m)


def test_best_of_three_regions_with_eight_headings_and_three_offsets() -> None:
    """On real options, with plain Dubins lengths, no other choice in this order is cheaper."""
    assert [len(options.inner_m) for options in OPTIONS] == [24, 24, 24]
    layers = layers_of(ends_of(SCENARIO), AROUND, OPTIONS, AROUND.discs)
    between = [lengths(a.exits, b.entries) + b.inner_m for a, b in itertools.pairwise(OPTIONS)]
    first = lengths(None, OPTIONS[0].entries)[0] + OPTIONS[0].inner_m
    every = all_ways(first, between, lengths(OPTIONS[-1].exits, None)[:, 0])
    cost_m, chosen = layers.best()
    assert cost_m == pytest.approx(every.min(), abs=1e-6)
    assert every[tuple(chosen)] == pytest.approx(cost_m, abs=1e-6)


def lengths(exits: np.ndarray | None, entries: np.ndarray | None) -> np.ndarray:
    """Plain Dubins lengths; None is the start, or the end, of the scenario."""
    begins = [Anchor(*SCENARIO.start.position)] if exits is None else [Anchor(*row) for row in exits.tolist()]
    goals = (
        [Anchor(*SCENARIO.end.position)] if entries is None else [Anchor(*row) for row in entries.tolist()]
    )
    return np.array([[shortest_between(a, b, AROUND.radius_m).length_m for b in goals] for a in begins])


def test_ends_with_a_direction_are_flown_backwards_to() -> None:
    """From a start, and to an end, with a direction: the plain Dubins lengths between poses."""
    document = small(feature("end", "end", "Point", [0.04, 0.03], heading_deg=200.0))
    for each in document["features"]:
        if each["properties"]["role"] == "start":
            each["properties"]["heading_deg"] = 60.0
    scenario = read_scenario(document)
    poses, none = OPTIONS[1].entries, np.empty((0, 3))
    radius_m = AROUND.radius_m
    start = Anchor(*scenario.start.position, scenario.start.angle_rad)
    end = Anchor(*scenario.end.position, scenario.end.angle_rad)
    assert start.angle_rad is not None
    assert end.angle_rad is not None
    out = [shortest_between(start, Anchor(*row), radius_m).length_m for row in poses.tolist()]
    home = [shortest_between(Anchor(*row), end, radius_m).length_m for row in poses.tolist()]
    np.testing.assert_allclose(from_start(scenario.start, AROUND, poses, none), out, atol=1e-6)
    np.testing.assert_allclose(to_end(scenario.end, AROUND, poses, none), home, atol=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_true_costs_lead_to_the_true_best(seed: int) -> None:
    """Where estimates are too low, never too high, the choice is the brute-force best by true costs.

    Options lie farther apart than errors are spread; 3 places with 24 options each.
    """
    rng = np.random.default_rng(seed)
    truth = at_random(rng, [24, 24, 24], blocked=0.05)
    cut = [
        np.where(rng.uniform(size=leg.shape) < 0.4, rng.uniform(0.3, 1.0, leg.shape), 1.0)
        for leg in all_of(truth)
    ]
    low = [
        np.where(np.isinf(leg), rng.uniform(0, 1000, leg.shape), leg) * part
        for leg, part in zip(all_of(truth), cut, strict=True)
    ]
    layers = Layers(truth.options, low[0], (low[1], low[2]), low[3])
    kept = [leg.copy() for leg in low]
    every = all_ways(truth.first, list(truth.between), truth.last)
    found_m, chosen = true_choice(layers, numbered(3), Table(truth.options, truth), 5000, never)
    assert every.min() - 1e-9 <= found_m <= every.min() + TRUE_WITHIN_M
    assert every[tuple(chosen)] == pytest.approx(found_m)
    for before, after in zip(kept, low, strict=True):
        np.testing.assert_array_equal(before, after)


def all_of(layers: Layers) -> list[np.ndarray]:
    """The cost arrays in order."""
    return [layers.first, *layers.between, layers.last]


@pytest.mark.parametrize("solves", [1, 2, 5, 40])
def test_more_solves_are_never_worse(solves: int) -> None:
    """What is returned is the true cost of what is chosen, and no more than one solve alone finds."""
    rng = np.random.default_rng(5)
    truth = at_random(rng, [6, 6, 6])
    low = [leg * rng.uniform(0.2, 1.0, leg.shape) for leg in all_of(truth)]
    layers = Layers(truth.options, low[0], (low[1], low[2]), low[3])
    every = all_ways(truth.first, list(truth.between), truth.last)
    legs = Table(truth.options, truth)
    one_m, _ = true_choice(layers, numbered(3), Table(truth.options, truth), 1, never)
    found_m, chosen = true_choice(layers, numbered(3), legs, solves, never)
    assert every[tuple(chosen)] == pytest.approx(found_m)
    assert found_m <= one_m
    assert legs.asked <= 4 * solves


def test_an_error_is_put_on_legs_close_by() -> None:
    """A wall between two places is met once: the other options behind it are thought as dear, and avoided."""
    near = np.array([[10.0 * k, 0.0, 0.0] for k in range(10)] + [[0.0, 9000.0, 0.0]])
    count, zeros, options = len(near), np.zeros(len(near)), bare(near)
    thought, true = np.full(count, 100.0), np.full(count, 400.0)
    thought[-1] = true[-1] = 350.0
    layers = Layers((options,), thought, (), zeros)
    legs = Table((options,), Layers((options,), true, (), zeros))
    found_m, chosen = true_choice(layers, numbered(1), legs, 4, never)
    assert (found_m, chosen) == (350.0, [count - 1])
    assert 10.0 * count < FADE_M


def test_what_is_known_is_not_overwritten_by_an_error_close_by() -> None:
    """Of two options at one place the first keeps its true cost when the second turns out dearer."""
    here = bare(np.array([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    there = bare(np.array([[5000.0, 0.0, 0.0], [0.0, 5000.0, 0.0]]))
    nothing = np.zeros(2)
    layers = Layers(
        (here, there), np.array([100.0, 101.0]), (np.array([[0.0, 350.0], [0.0, 200.0]]),), nothing
    )
    truth = Layers(
        (here, there), np.array([300.0, 600.0]), (np.array([[500.0, 350.0], [500.0, 200.0]]),), nothing
    )
    # First 0 and 0, for 800 in truth; then 1 and 1, also 800, and an error put on all that begins nearby.
    assert true_choice(layers, numbered(2), Table((here, there), truth), 9, never) == (650.0, [0, 1])


def test_what_an_option_costs_by_itself_holds_from_wherever_it_is_flown_to() -> None:
    """An option dearer inside than thought is tried once, not once from each option before it."""
    rows = bare(np.array([[9000.0 * k, 0.0, 0.0] for k in range(10)]))
    ends = np.array([[0.0, 5000.0, 0.0], [90_000.0, 5000.0, 0.0]])
    thought, true = bare(ends, np.array([10.0, 10.0])), bare(ends, np.array([1000.0, 10.0]))
    first, last = np.arange(10.0), np.zeros(2)
    legs_m = np.tile([100.0, 300.0], (10, 1))
    layers = Layers((rows, thought), first, (legs_m + 10.0,), last)
    legs = Table((rows, thought), Layers((rows, true), first, (legs_m,), last))
    assert true_choice(layers, numbered(2), legs, 2, never) == (310.0, [0, 1])


def test_stops_when_told() -> None:
    """The stop is asked before each solve."""
    truth = at_random(np.random.default_rng(0), [2, 2])
    with pytest.raises(CancelledError):
        true_choice(truth, numbered(2), Table(truth.options, truth), 3, lambda: True)


def test_a_threat_in_the_way_is_flown_in_earnest() -> None:
    """Three regions, 8 headings, 3 offsets and a threat between: within 1 % of the true brute-force best."""
    threat = feature("M", "threat", "Point", [0.017, 0.009], model="missile", radius_m=900.0)
    wall = feature("Z", "no_fly", "Polygon", square(0.016, 0.021, 0.006))
    scenario = read_scenario(small(C, threat, wall))
    around = surroundings(scenario)
    sides = list(sides_of(scenario))
    targets = [StripTarget(of[0].region, of, around) for of in sides]
    options = []
    for of in sides:
        found = make_options(of, HEADINGS_RAD, ETAS, around)
        assert found is not None
        options.append(found)
    legs = legs_in(scenario, never)

    def inner(place: int) -> np.ndarray:
        passes: list[tuple[CollectPass, ...]] = [
            collect_passes(sides[place], options[place], k) for k in range(len(options[place].inner_m))
        ]
        return np.array([legs.inner_m(each) for each in passes])

    first = np.array([legs.between_m(None, row) for row in options[0].entries]) + inner(0)
    between = [
        np.array([[legs.between_m(a, b) for b in options[k + 1].entries] for a in options[k].exits])
        + inner(k + 1)
        for k in range(2)
    ]
    last = np.array([legs.between_m(row, None) for row in options[2].exits])
    every = all_ways(first, between, last)
    layers = layers_of(ends_of(scenario), around, options, around.discs)
    found_m, chosen = true_choice(layers, targets, legs, 12, never)
    assert every[tuple(chosen)] == pytest.approx(found_m)
    assert every.min() - 1e-6 <= found_m <= 1.01 * every.min()
    assert layers.best()[0] < found_m


def test_ground_in_shadow_still_costs_once_flown() -> None:
    """Of two options the shorter leaves ground in shadow: flown in earnest, it is still the dearer one."""
    poses, zeros = np.array([[0.0, 0.0, 0.0], [5000.0, 0.0, 0.0]]), np.zeros(2)
    options, plain = bare(poses, np.array([5000.0, 0.0])), bare(poses)
    legs = Table((plain,), Layers((plain,), np.array([100.0, 400.0]), (), zeros))
    # The way to the second turns out longer than thought, so that the first is looked at, too.
    layers = Layers((options,), np.array([5100.0, 300.0]), (), zeros)

    def shadow_m(place: int, passes: Sequence[CollectPass]) -> float:
        return 5000.0 if passes[1] == 0 else 0.0

    assert true_choice(layers, numbered(1), legs, 9, never, shadow_m) == (400.0, [1])
    dearer = Layers((options,), np.array([5100.0, 6000.0]), (), zeros)
    assert true_choice(dearer, numbered(1), legs, 1, never, shadow_m) == (5100.0, [0])
