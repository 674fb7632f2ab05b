"""Parts of the lower bound: cells, lines between them, tours over them, each against what it stands for."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.geometry import MultiPoint

from planner.bounds import cells_kernels as cells_of
from planner.bounds import lines_kernels as lines
from planner.bounds import tours_kernels as tours
from planner.bounds.nodes import divided, nodes, slopes_m
from planner.coverage.strips.classify import spans_at
from planner.coverage.strips.segments import Neighbourhood, segment
from planner.dubins.kernels import dubins_length
from planner.errors import InfeasibleError
from planner.sensors.sar import SarSensor
from planner.sensors.strip import strip_on
from tests.planner.coverage.shapes import as_merged

Floats = NDArray[np.float64]

RADIUS_M = 100.0
unit = st.floats(-1.0, 1.0)
angle = st.floats(-math.pi, math.pi)


@st.composite
def hulls(draw: st.DrawFn) -> Floats:
    """Convex rings, counter-clockwise, up to a kilometre across."""
    points = draw(
        st.lists(st.tuples(st.floats(-500.0, 500.0), st.floats(-300.0, 300.0)), min_size=4, max_size=10)
    )
    hull = MultiPoint(points).convex_hull.buffer(20.0, quad_segs=1)
    ring = shapely.get_coordinates(shapely.geometry.polygon.orient(hull).exterior)
    return np.asarray(ring[:-1], dtype=np.float64)


def family(
    ring: Floats, side: float, middle: tuple[float, float], kind: float = cells_of.WHOLE, strips: float = 1.0
) -> Floats:
    """Passes of a sensor with a swath of 700 m from 300 m off, 40 m of aperture and 50 m to settle."""
    return np.array([kind, side, 300.0, 700.0, 20.0, 50.0, *middle, strips, 1e6, 0.0, 20.0])


def between(begin: Iterable[float], end: Iterable[float]) -> float:
    """Length of the shortest line from one pose to another."""
    (e0, n0, angle0), (e1, n1, angle1) = begin, end
    return float(dubins_length(e0, n0, angle0, e1, n1, angle1, RADIUS_M))


def flown(ring: Floats, of: Floats, theta: float, eta: float) -> tuple[Floats, Floats] | None:
    """Where the pass at a heading and offset begins and ends; None where the swath is too narrow."""
    ahead, left = np.array([math.cos(theta), math.sin(theta)]), np.array([-math.sin(theta), math.cos(theta)])
    x, y = ring @ ahead, of[1] * (ring @ left)
    spare = of[8] * of[3] - (y.max() - y.min())
    if spare < 0.0:
        return None
    line = of[1] * (y.max() + of[2] + eta * spare)
    begin, end = x.min() - of[4] - of[5], x.max() + of[4]
    return of[6:8] + begin * ahead + line * left, of[6:8] + end * ahead + line * left


@given(
    rings=st.tuples(hulls(), hulls()),
    sides=st.tuples(st.sampled_from([1.0, -1.0]), st.sampled_from([1.0, -1.0])),
    distance=st.floats(0.0, 4000.0),
    towards=angle,
    thetas=st.tuples(angle, angle),
    alphas=st.tuples(st.floats(0.0, 0.4), st.floats(0.0, 0.4)),
    half=st.sampled_from([0.0, 0.05, 0.25, 0.5]),
    inside=st.lists(unit, min_size=4, max_size=4),
    slopes=st.lists(unit, min_size=4, max_size=4),
    own=st.booleans(),
)
@settings(max_examples=400, deadline=None)
def test_no_line_between_passes_of_two_cells_costs_less(
    rings: tuple[Floats, Floats],
    sides: tuple[float, float],
    distance: float,
    towards: float,
    thetas: tuple[float, float],
    alphas: tuple[float, float],
    half: float,
    inside: list[float],
    slopes: list[float],
    own: bool,
) -> None:
    """Any pass of one cell, any of the other, any slopes: the line, priced, is no less than the bound."""
    middles = ((0.0, 0.0), (distance * math.cos(towards), distance * math.sin(towards)))
    families = [family(ring, side, middle) for ring, side, middle in zip(rings, sides, middles, strict=True)]
    boxes = [np.array([0.0, theta, alpha, 0.5, half]) for theta, alpha in zip(thetas, alphas, strict=True)]
    cells = [cells_of.cell(ring, ring, of, box) for ring, of, box in zip(rings, families, boxes, strict=True)]
    ends = [
        flown(ring, of, box[1] + x * box[2], box[3] + y * box[4])
        for ring, of, box, x, y in zip(rings, families, boxes, inside[::2], inside[1::2], strict=True)
    ]
    if ends[0] is None or ends[1] is None:
        return
    assert all(cell[cells_of.HOLDS] == 1.0 for cell in cells)
    gains = np.empty(4)
    lines.between(cells[0], cells[1], np.zeros(2), np.zeros(2), RADIUS_M, gains)
    # The slopes that give least away, or any others.
    slope0 = -gains[:2] if own else 500.0 * np.array(slopes[:2])
    slope1 = gains[2:].copy() if own else 500.0 * np.array(slopes[2:])
    least = lines.between(cells[0], cells[1], slope0, slope1, RADIUS_M, gains)
    leaves, arrives = (
        (*ends[0][1], thetas[0] + inside[0] * alphas[0]),
        (
            *ends[1][0],
            thetas[1] + inside[2] * alphas[1],
        ),
    )
    priced = slope0 @ np.array(inside[:2]) - slope1 @ np.array(inside[2:])
    inner = math.dist(*ends[1])
    assert between(leaves, arrives) + inner + priced >= least - 1e-6
    # From a place and a pose, and to them.
    place = np.array([-700.0, 400.0, 0.0, 0.0])
    pose = np.array([-700.0, 400.0, 1.0, 2.0])
    two = np.empty(2)
    for start in (place, pose):
        into = lines.from_terminal(start, cells[1], cells_of.ENTRY, slope1, RADIUS_M, two)
        flight = between((-700.0, 400.0, 2.0), arrives)
        assert flight + inner - slope1 @ np.array(inside[2:]) >= into - 1e-6
        out = lines.from_terminal(start, cells[0], cells_of.EXIT, slope0, RADIUS_M, two)
        flight = between(leaves, (-700.0, 400.0, 2.0))
        assert flight + slope0 @ np.array(inside[:2]) >= out - 1e-6


@given(
    rings=st.tuples(hulls(), hulls()),
    side=st.sampled_from([1.0, -1.0]),
    theta=angle,
    ahead=st.floats(0.0, 3000.0),
    etas=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
    alphas=st.tuples(st.floats(0.01, 0.3), st.floats(0.01, 0.3)),
    half=st.sampled_from([0.02, 0.1, 0.5]),
    inside=st.lists(unit, min_size=4, max_size=4),
    slopes=st.lists(unit, min_size=4, max_size=4),
)
@settings(max_examples=300, deadline=None)
def test_no_pass_over_two_regions_is_shorter(
    rings: tuple[Floats, Floats],
    side: float,
    theta: float,
    ahead: float,
    etas: tuple[float, float],
    alphas: tuple[float, float],
    half: float,
    inside: list[float],
    slopes: list[float],
) -> None:
    """Of one line over both, from end to end, whatever its heading and offsets are in their cells."""
    first = family(rings[0], side, (0.0, 0.0))
    one = flown(rings[0], first, theta, etas[0])
    other = flown(rings[1], first, theta, etas[1])
    if one is None or other is None:
        return
    # The second region lies so that its pass at this offset ends further on, on the line of the first.
    along = np.array([math.cos(theta), math.sin(theta)])
    middle = one[1] + ahead * along - other[1]
    second = family(rings[1], side, (float(middle[0]), float(middle[1])))
    cells = []
    for ring, of, alpha, eta, (x, y) in zip(
        rings, (first, second), alphas, etas, (inside[:2], inside[2:]), strict=True
    ):
        box = np.array([0.0, theta - x * alpha, alpha, eta - y * half, half])
        cells.append(cells_of.cell(ring, ring, of, box))
    scale = 30.0
    slope0, slope1 = scale * np.array(slopes[:2]), scale * np.array(slopes[2:])
    cost = ahead + float(slope0 @ inside[:2]) - float(slope1 @ inside[2:])
    assert lines.along(cells[0], cells[1], slope0, slope1) <= cost + 1e-6


@st.composite
def crabbing(draw: st.DrawFn) -> SarSensor:
    """Antennas fixed to an aircraft in a wind, squinted or not, with margins or without."""
    return SarSensor(
        "sar",
        math.radians(45.0),
        math.radians(30.0),
        math.radians(10.0),
        (draw(st.sampled_from(["left", "right"])),),
        squint_rad=draw(st.sampled_from([0.0, 0.3, -0.2])),
        pointing_margin_rad=draw(st.sampled_from([0.0, 0.03])),
        position_margin_m=draw(st.sampled_from([0.0, 20.0])),
        drift=draw(st.floats(0.05, 0.6)),
        toward_rad=draw(angle),
    )


@given(sensor=crabbing(), at=st.lists(angle, min_size=2, max_size=2), between=st.floats(0.0, 1.0))
@settings(max_examples=200, deadline=None)
def test_a_strip_changes_with_the_heading_no_faster_than_said(
    sensor: SarSensor, at: list[float], between: float
) -> None:
    """Near edge, swath, run-in and run-out at near and far headings; their bound is what samples rest on."""
    most = slopes_m(sensor, 500.0)
    headings = np.array([at[0], at[1], at[0] + 0.01 * between])
    strip = strip_on(sensor, 500.0, headings, sensor.looks[0])
    for values, slope in zip(
        (strip.near_m, strip.swath_m, strip.run_in_m, strip.run_out_m), most, strict=True
    ):
        assert abs(values[2] - values[0]) <= slope * 0.01 * between + 1e-6
        assert abs(values[1] - values[0]) <= slope * abs(at[1] - at[0]) + 1e-6


@given(
    sensor=crabbing(),
    ring=hulls(),
    theta=angle,
    alpha=st.sampled_from([0.0, 0.01, 0.1, 0.3]),
    half=st.sampled_from([0.0, 0.1, 0.5]),
    inside=st.lists(unit, min_size=2, max_size=2),
    slopes=st.lists(unit, min_size=2, max_size=2),
    own=st.booleans(),
)
@settings(max_examples=300, deadline=None)
def test_no_line_to_a_crabbing_pass_costs_less(
    sensor: SarSensor,
    ring: Floats,
    theta: float,
    alpha: float,
    half: float,
    inside: list[float],
    slopes: list[float],
    own: bool,
) -> None:
    """Passes of an antenna that crabs, as the planner lays them: none is below its cell's bound."""
    region = as_merged(shapely.Polygon(ring))
    heading, eta = theta + inside[0] * alpha, 0.5 + inside[1] * half
    try:
        collect = segment(region, sensor, 500.0, heading, sensor.looks[0], eta)
    except InfeasibleError:
        return
    angles_rad = np.array([heading])
    side = Neighbourhood(region, sensor, 500.0, sensor.looks[0], 0, angles_rad, spans_at(ring, angles_rad))
    node = nodes((side,), 50.0, 0)[0]
    cell = cells_of.cell(node.ring, node.hull, node.families[0], np.array([0.0, theta, alpha, 0.5, half]))
    assert cell[cells_of.HOLDS] == 1.0
    entry = np.array(collect.start) - 50.0 * np.array([math.cos(heading), math.sin(heading)])
    inner = math.dist(entry, collect.end)
    start, gains = np.array([-900.0, 700.0, 1.0, 2.0]), np.empty(2)
    lines.from_terminal(start, cell, cells_of.ENTRY, np.zeros(2), RADIUS_M, gains)
    slope = gains.copy() if own else 500.0 * np.array(slopes)
    into = lines.from_terminal(start, cell, cells_of.ENTRY, slope, RADIUS_M, gains)
    flown_m = between((-900.0, 700.0, 2.0), (*entry, heading)) + inner
    assert flown_m - slope @ np.array(inside) >= into - 1e-6
    out = lines.from_terminal(start, cell, cells_of.EXIT, slope, RADIUS_M, gains)
    flown_m = between((*collect.end, heading), (-900.0, 700.0, 2.0))
    assert flown_m + slope @ np.array(inside) >= out - 1e-6


@given(
    ring=hulls(),
    distance=st.floats(2500.0, 5000.0),
    towards=angle,
    theta=angle,
    other=angle,
    side=st.sampled_from([1.0, -1.0]),
)
@settings(max_examples=100, deadline=None)
def test_between_two_passes_the_bound_is_the_dubins_length(
    ring: Floats, distance: float, towards: float, theta: float, other: float, side: float
) -> None:
    """Cells of one pass each, far enough apart: nothing is given away."""
    middle = (distance * math.cos(towards), distance * math.sin(towards))
    of = (family(ring, side, (0.0, 0.0)), family(ring, -side, middle))
    ends = (flown(ring, of[0], theta, 0.3), flown(ring, of[1], other, 0.3))
    if ends[0] is None or ends[1] is None:
        return
    cells = [
        cells_of.cell(ring, ring, f, np.array([0.0, t, 0.0, 0.3, 0.0]))
        for f, t in zip(of, (theta, other), strict=True)
    ]
    least = lines.between(cells[0], cells[1], np.zeros(2), np.zeros(2), RADIUS_M, np.empty(4))
    length = between((*ends[0][1], theta), (*ends[1][0], other)) + math.dist(*ends[1])
    assert least <= length + 1e-6
    # A turn of nothing may come out as a full one, which the bound takes for none.
    assert least == pytest.approx(length, abs=1e-6) or least >= length - 2.0 * math.pi * RADIUS_M - 1e-6


def test_what_is_given_away_goes_with_the_square_of_a_cells_size() -> None:
    """With slopes by the gradients, cells half as large in both ways give away about a quarter."""
    ring = np.array([[-400.0, -200.0], [400.0, -200.0], [400.0, 200.0], [-400.0, 200.0]])
    of = (family(ring, 1.0, (0.0, 0.0)), family(ring, 1.0, (2500.0, 1500.0)))
    lost = []
    gains = np.empty(4)
    for size in (0.08, 0.04, 0.02, 0.0):
        cells = [
            cells_of.cell(ring, ring, f, np.array([0.0, t, size, 0.5, 2.0 * size]))
            for f, t in zip(of, (0.3, 1.0), strict=True)
        ]
        lines.between(cells[0], cells[1], np.zeros(2), np.zeros(2), RADIUS_M, gains)
        lost.append(lines.between(cells[0], cells[1], -gains[:2], gains[2:].copy(), RADIUS_M, gains))
    away = lost[-1] - np.array(lost[:-1])
    assert away[0] < 200.0
    assert (away[:-1] / away[1:] > 3.0).all()


@given(ring=hulls(), theta=angle, alpha=st.floats(0.001, 0.4), half=st.sampled_from([0.05, 0.25, 0.5]))
@settings(max_examples=100, deadline=None)
def test_a_boxs_parts_hold_all_its_passes(ring: Floats, theta: float, alpha: float, half: float) -> None:
    """Divided, a box is the union of its parts, which do not overlap; slopes shrink with them."""
    box = np.array([0.0, theta, alpha, 0.5, half])
    cell = cells_of.cell(ring, ring, family(ring, 1.0, (0.0, 0.0)), box)
    if cell[cells_of.HOLDS] == 0.0:
        return
    parts, slopes = divided(box, cell, np.array([3.0, 5.0]))
    whole = shapely.box(theta - alpha, 0.5 - half, theta + alpha, 0.5 + half)
    pieces = [shapely.box(t - a, e - h, t + a, e + h) for _, t, a, e, h in parts]
    assert shapely.union_all(pieces, grid_size=1e-9).area == pytest.approx(whole.area, rel=1e-6)
    assert sum(piece.area for piece in pieces) == pytest.approx(whole.area)
    assert slopes == pytest.approx(np.array([3.0, 5.0]) * parts[:, [2, 4]] / box[[2, 4]])


@given(seed=st.integers(0, 10_000), clusters=st.integers(1, 4))
@settings(max_examples=40, deadline=None)
def test_tours_over_cells_are_the_least_of_all(seed: int, clusters: int) -> None:
    """Least tours through each cell and each pair of cells are those found by trying every tour."""
    rng = np.random.default_rng(seed)
    sizes = rng.integers(1, 4, clusters)
    offsets = np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64)
    count = int(offsets[-1])
    cluster = np.repeat(np.arange(clusters), sizes)
    between = rng.uniform(0.0, 10.0, (count, count))
    between[cluster[:, None] == cluster[None, :]] = np.inf
    first, last = rng.uniform(0.0, 10.0, (2, count))
    through, pairs = np.full(count, np.inf), np.full((count, count), np.inf)
    members = [range(offsets[c], offsets[c + 1]) for c in range(clusters)]
    for order in itertools.permutations(members):
        for picked in itertools.product(*order):
            legs = list(itertools.pairwise(picked))
            cost = first[picked[0]] + last[picked[-1]] + sum(between[i, j] for i, j in legs)
            for i in picked:
                through[i] = min(through[i], cost)
            for i, j in legs:
                pairs[i, j] = min(pairs[i, j], cost)
    ahead = tours.ahead_costs(first, between, offsets)
    behind = tours.ahead_costs(last, np.ascontiguousarray(between.T), offsets)
    least, prior, after = tours.through_costs(ahead, behind, between, offsets)
    assert least == pytest.approx(through)
    if clusters == 1:
        assert (prior == -1).all()
        assert (after == -1).all()
    target = float(np.median(through)) + 1e-9
    short = tours.short_pairs(ahead, behind, between, offsets, target)
    clear = np.abs(pairs - target) > 1e-6
    assert (short == (pairs < target))[clear].all()
