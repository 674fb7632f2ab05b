"""Sweeps of many lanes: what they see, judged by shapely, and their order, judged by trying every one."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.geometry import LineString, Polygon

from planner.airspace.surroundings import Surroundings
from planner.coverage import lanes_kernels
from planner.coverage.lanes_kernels import turns_between
from planner.coverage.strips import kernels
from planner.coverage.strips.flyable import is_flyable
from planner.coverage.strips.options import collect_passes, make_options
from planner.coverage.strips.sweeps import Sweep, lanes_at, sweeps
from planner.coverage.turns_kernels import ends_of
from planner.dubins.words import shortest
from planner.route import CollectPass, Look, Pose
from planner.sensors.strip import swaths_m
from tests.planner.coverage.shapes import HEIGHT_M, as_merged, box, paper_sensor, unseen_m2

Floats = NDArray[np.float64]

SWATH_M = paper_sensor().swath_m(HEIGHT_M)
NO_DISCS = np.empty((0, 3))
looks = st.sampled_from([("right",), ("left",), ("right", "left")])


def open_ground(radius_m: float = 100.0, area: Polygon | None = None) -> Surroundings:
    room = None if area is None else area.buffer(-radius_m)
    return Surroundings(area, room, NO_DISCS, NO_DISCS, (), radius_m, 0.0)


@st.composite
def stars(draw: st.DrawFn, most_swaths: float = 6.0) -> Polygon:
    """Star-shaped outlines, concave as a rule, now and then with a hole."""
    count = draw(st.integers(3, 9))
    size_m = draw(st.floats(0.2, most_swaths / 2.0)) * SWATH_M
    radii = draw(st.lists(st.floats(0.3, 1.0), min_size=count, max_size=count))
    angles = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    ring = [(size_m * r * math.cos(a), size_m * r * math.sin(a)) for r, a in zip(radii, angles, strict=True)]
    hole = []
    if draw(st.booleans()) and count > 3:
        inner = 0.15 * size_m * min(radii)
        hole = [[(inner * math.cos(a), inner * math.sin(a)) for a in angles[::-1]]]
    shape = Polygon(ring, hole)
    return shape if shape.is_valid else shape.buffer(0).convex_hull


def best(area: Polygon, sides: tuple[Look, ...], radius_m: float, **known: object) -> tuple[CollectPass, ...]:
    family = sweeps(as_merged(area, **known), paper_sensor(*sides), HEIGHT_M)
    options = make_options(family, family[0].angles_rad, np.array([0.0, 0.5, 1.0]), open_ground(radius_m))
    assert options is not None
    return collect_passes(family, options, int(np.argmin(options.inner_m)))


def flown_m(passes: tuple[CollectPass, ...], radius_m: float) -> float:
    turns = (shortest(a.exit, b.entry, radius_m).length_m for a, b in itertools.pairwise(passes))
    return sum(p.length_m for p in passes) + sum(turns)


@given(
    area=stars(), sides=looks, eta=st.floats(0.0, 1.0), angle=st.floats(-4.0, 4.0), extra=st.integers(0, 1)
)
@settings(deadline=None, max_examples=80)
def test_lanes_see_the_whole_region_in_whatever_states(
    area: Polygon, sides: tuple[Look, ...], eta: float, angle: float, extra: int
) -> None:
    """At any heading and η, one state of every lane sees all of the region, as shapely has it."""
    region, sensor = as_merged(area), paper_sensor(*sides)
    sweep = Sweep(region, sensor, HEIGHT_M, 0, extra)
    count = int(sweep.lanes(np.array([angle]))[0])
    lanes = lanes_at(sweep, np.array([angle]), np.array([eta]), count)
    near, far, half = sensor.near_m(HEIGHT_M), sensor.far_m(HEIGHT_M), sensor.aperture_m(HEIGHT_M) / 2.0
    for pick in range(len(lanes.looks)):
        strips = []
        for lane in range(count):
            b = (pick + lane) % len(lanes.looks)
            start, end = lanes.lines[0, 0, lane, b]
            ahead = (end - start) / np.hypot(*(end - start))
            assert (
                math.atan2(ahead[1], ahead[0])
                == pytest.approx(math.remainder(lanes.headings_rad[0, b], math.tau), abs=1e-6)
                or abs(ahead[0] + 1.0) < 1e-6
            )
            side = np.array([ahead[1], -ahead[0]]) * (1.0 if lanes.looks[b] == "right" else -1.0)
            first, last = start + half * ahead, end - half * ahead
            strips.append(
                Polygon([first + near * side, last + near * side, last + far * side, first + far * side])
            )
        assert unseen_m2(area, [strip.buffer(1e-6) for strip in strips]) < 1e-3


@given(area=stars(), sides=looks, radius_m=st.floats(30.0, 600.0))
@settings(deadline=None, max_examples=30)
def test_the_best_sweep_sees_the_whole_region(
    area: Polygon, sides: tuple[Look, ...], radius_m: float
) -> None:
    """The footprints of the cheapest sweep hold the region."""
    passes = best(area, sides, radius_m)
    assert unseen_m2(area, [p.footprint.buffer(1e-6) for p in passes]) < 1e-3


@given(area=stars(4.0), sides=looks, margin_m=st.floats(0.0, 2500.0))
@settings(deadline=None, max_examples=30)
def test_every_lane_stays_inside_the_area(area: Polygon, sides: tuple[Look, ...], margin_m: float) -> None:
    """With an operating area no option has a lane outside it, and is_flyable agrees."""
    around = area.buffer(margin_m)
    family = sweeps(as_merged(area), paper_sensor(*sides), HEIGHT_M)
    options = make_options(
        family, family[0].angles_rad, np.array([0.0, 0.5, 1.0]), open_ground(100.0, around)
    )
    if options is None:
        return
    assert is_flyable(family[0], around)
    for index in range(0, len(options.inner_m), 7):
        for collect in collect_passes(family, options, index):
            assert around.covers(LineString([collect.start, collect.end]))


@given(
    seed=st.integers(0, 10_000), lanes=st.integers(1, 6), states=st.sampled_from([1, 2, 4]),
    radius_m=st.floats(20.0, 500.0),
)  # fmt: skip
@settings(deadline=None, max_examples=25)
def test_best_order_is_the_best_of_every_order(seed: int, lanes: int, states: int, radius_m: float) -> None:
    """Up to six lanes no order, tried with its best states by plain code, is shorter than the kernel's."""
    rng = np.random.default_rng(seed)
    count = lanes * states
    entries = np.column_stack([rng.uniform(0, 2000, (count, 2)), rng.uniform(-3, 3, count)])
    exits = np.column_stack([rng.uniform(0, 2000, (count, 2)), rng.uniform(-3, 3, count)])
    own = np.where(rng.random(count) < 0.1, np.inf, rng.uniform(100, 900, count))
    free, none = np.zeros(count), np.zeros((count, 2))
    turn = np.array(
        [[shortest(Pose(*exits[i]), Pose(*entries[j]), radius_m).length_m for j in range(count)]
         for i in range(count)]
    )  # fmt: skip
    expected = math.inf
    for order in itertools.permutations(range(lanes)):
        reach = {order[0] * states + b: own[order[0] * states + b] for b in range(states)}
        for lane in order[1:]:
            reach = {
                j: min(cost + turn[i, j] for i, cost in reach.items()) + own[j]
                for j in range(lane * states, (lane + 1) * states)
            }
        expected = min(expected, *reach.values())
    turns = turns_between(ends_of(entries, exits, none), own, states, radius_m, NO_DISCS)
    cost, found = lanes_kernels.best_order(turns, own, free, free, states)
    assert cost == pytest.approx(expected)
    if math.isfinite(cost):
        assert sorted(found // states) == list(range(lanes))
        assert own[found].sum() + sum(turn[a, b] for a, b in itertools.pairwise(found)) == pytest.approx(cost)


@pytest.mark.parametrize(("count", "stride"), [(5, 0), (5, 1), (9, 2), (12, 3), (7, 12)])
def test_racetracks_fly_every_lane_once(count: int, stride: int) -> None:
    """Every pattern is an order of all lanes."""
    assert sorted(lanes_kernels.racetrack(count, stride)) == list(range(count))


def test_a_racetrack_goes_between_the_halves_of_a_block() -> None:
    """Stride 2 flies blocks of four lanes, jumping two lanes each time."""
    assert lanes_kernels.racetrack(8, 2).tolist() == [0, 2, 1, 3, 4, 6, 5, 7]


def one_by_one_m(turns: Floats, own: Floats, states: int) -> float:
    """What flying lane after lane costs in the best states."""
    cost_m = own[:states]
    for lane in range(1, len(own) // states):
        here = slice(lane * states, (lane + 1) * states)
        cost_m = (cost_m[:, None] + turns[here.start - states : here.start, here]).min(axis=0) + own[here]
    return float(cost_m.min())


def test_racetracks_beat_boustrophedon_where_the_turn_is_wide() -> None:
    """The order found with wide turns is shorter than flying neighbour after neighbour in the best states."""
    area, radius_m = box(6.0 * SWATH_M - 10.0, 3000.0), 0.9 * SWATH_M
    sweep = sweeps(as_merged(area), paper_sensor("right", "left"), HEIGHT_M)[0]
    lanes = lanes_at(sweep, np.array([math.pi / 2.0]), np.array([0.5]), 6)
    lines, states = lanes.lines[0, 0], len(lanes.looks)
    headings = np.broadcast_to(lanes.headings_rad[0], (6, states)).reshape(-1, 1)
    entries = np.hstack([lines[:, :, 0].reshape(-1, 2), headings])
    exits = np.hstack([lines[:, :, 1].reshape(-1, 2), headings])
    own = np.hypot(*(exits - entries)[:, :2].T)
    free, none = np.zeros(len(own)), np.zeros((len(own), 2))
    turns = turns_between(ends_of(entries, exits, none), own, states, radius_m, NO_DISCS)
    neighbours = one_by_one_m(turns, own, states)
    cost, order = lanes_kernels.best_order(turns, own, free, free, states)
    assert cost < 0.98 * neighbours
    assert np.abs(np.diff(order // states)).max() > 1


@pytest.mark.parametrize(
    ("radius_m", "one_by_one"), [(40.0, True), (49.0, True), (80.0, False), (150.0, False)]
)
def test_the_turn_decides_between_boustrophedon_and_racetrack(radius_m: float, one_by_one: bool) -> None:
    """Lanes 100 m apart are flown one by one up to a radius of 50 m, and in jumps beyond."""
    lanes = 6
    ends = np.array([[[0.0, 0.0], [2000.0, math.pi]], [[2000.0, 0.0], [0.0, math.pi]]])
    entries, exits = (
        np.array([[x, 100.0 * lane, heading] for lane in range(lanes) for x, heading in where])
        for where in ends
    )
    own, free, none = np.full(12, 2000.0), np.zeros(12), np.zeros((12, 2))
    turns = turns_between(ends_of(entries, exits, none), own, 2, radius_m, NO_DISCS)
    cost, order = lanes_kernels.best_order(turns, own, free, free, 2)
    neighbours = one_by_one_m(turns, own, 2)
    steps = np.abs(np.diff(order // 2))
    if one_by_one:
        assert cost == pytest.approx(neighbours)
        assert (steps == 1).all()
    else:
        assert cost < neighbours - 50.0
        assert steps.max() > 1


def test_costs_are_what_is_flown() -> None:
    """The inner cost of a sweep is the length of its lanes and of the shortest turns between them."""
    family = sweeps(as_merged(box(2500.0, 2000.0, 0.4)), paper_sensor(), HEIGHT_M)
    options = make_options(family, family[0].angles_rad, np.array([0.5]), open_ground(150.0))
    assert options is not None
    for index in range(0, len(options.inner_m), 5):
        passes = collect_passes(family, options, index)
        assert options.inner_m[index] == pytest.approx(flown_m(passes, 150.0))
        assert passes[0].entry.position == pytest.approx(options.entries[index, :2])
        assert passes[-1].exit.position == pytest.approx(options.exits[index, :2])


def test_lanes_are_trimmed_to_their_own_strip() -> None:
    """On a triangle the lanes get shorter towards the tip."""
    triangle = Polygon([(0.0, 0.0), (4000.0, 0.0), (0.0, 3.0 * SWATH_M - 10.0)])
    sweep = sweeps(as_merged(triangle), paper_sensor(), HEIGHT_M)[0]
    lines = lanes_at(sweep, np.array([0.0]), np.array([0.5]), 3).lines[0, 0, :, 0]
    lengths = np.hypot(*(lines[:, 1] - lines[:, 0]).T) - paper_sensor().aperture_m(HEIGHT_M)
    assert (np.diff(lengths) > 1000.0).all()
    assert lengths[-1] == pytest.approx(4000.0)


def test_one_allowed_heading_makes_all_lanes_go_the_same_way() -> None:
    """A wide region with one approach direction is flown with lanes all in that direction."""
    passes = best(box(1500.0, 1400.0), ("right",), 100.0, approach_rad=(0.5,))
    assert len(passes) > 2
    assert all(p.angle_rad == pytest.approx(0.5) for p in passes)
    both = best(box(1500.0, 1400.0), ("right",), 100.0, approach_rad=(0.5, 0.5 - math.pi))
    assert {round(p.angle_rad, 6) for p in both} == {0.5, round(0.5 - math.pi, 6)}


def test_twenty_lanes_are_planned_with_patterns() -> None:
    """A region far wider than the exact search takes is seen whole, no longer than neighbour by neighbour."""
    area = box(20.0 * SWATH_M, 20.0 * SWATH_M)
    passes = best(area, ("right",), 200.0)
    assert len(passes) >= 20
    assert unseen_m2(area, [p.footprint.buffer(1e-6) for p in passes]) < 1e-2


def test_headings_at_which_the_crab_leaves_no_swath_are_left_out() -> None:
    """Squinted against the crab and with margins, some headings see nothing: no lanes there, and no fault."""
    sensor = replace(
        paper_sensor("right"),
        incidence_rad=math.radians(53.0),
        elevation_beamwidth_rad=math.radians(17.0),
        squint_rad=math.radians(-22.9),
        pointing_margin_rad=math.radians(3.0),
        position_margin_m=2.0,
    ).in_wind(0.5188, -0.733)
    family = sweeps(as_merged(box(120.0, 115.0)), sensor, 150.0)
    angles_rad = np.arange(-math.pi, math.pi, math.radians(5.0))
    widths_m = swaths_m(sensor, 150.0, angles_rad)
    assert widths_m.min() < 0.0 < widths_m.max()
    etas = np.array([0.0, 1.0])
    assert make_options(family, angles_rad[widths_m <= 0.0], etas, open_ground()) is None
    options = make_options(family, angles_rad, etas, open_ground())
    assert options is not None
    passes = collect_passes(family, options, int(np.argmin(options.inner_m)))
    assert float(swaths_m(sensor, 150.0, [passes[0].angle_rad])[0]) > 0.0


def test_strip_extents_agree_with_shapely() -> None:
    """Along-track extents are the bounds of what shapely cuts out of the outline."""
    area = Polygon([(0, 0), (900, 100), (500, 400), (1000, 900), (-200, 700)])
    ring = shapely.get_coordinates(area.exterior)
    edges = np.concatenate([ring[:-1], ring[1:]], axis=1)
    for angle in np.linspace(-3.0, 3.0, 7):
        turned = shapely.affinity.rotate(area, -angle, origin=(0, 0), use_radians=True)
        low, high = turned.bounds[1] + 100.0, turned.bounds[1] + 350.0
        extents = kernels.strip_extents(
            edges, np.array([angle]), np.full((1, 1, 1), low), np.full((1, 1, 1), high)
        )
        within = kernels.WITHIN_M
        cut = turned.intersection(shapely.box(-1e5, low + within, 1e5, high - within)).bounds
        assert extents[0, 0, 0] == pytest.approx([cut[0], cut[2]], abs=1e-6)
