"""Lines through soft threats: chosen by cost, as good as a fine grid says, never into hard zones."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from planner.airspace.threats import risk_of_detection, risk_of_kill
from planner.airspace.values import Threat
from planner.airspace.zones import Disc, KeepOut
from planner.dubins.path import Path, Segment
from planner.errors import CancelledError, InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.progress import Stop, never
from planner.route import Anchor
from planner.transit import refine
from planner.transit.refine import RISK_M, Risk, connect_by_cost
from planner.transit.tangent import connect
from planner.wishes import Objective
from tests.planner.scenarios import feature, small

Floats = NDArray[np.float64]

START, GOAL = Anchor(-1500.0, 0.0), Anchor(1500.0, 0.0)
MISSILE = Threat("m", "missile", (0.0, 100.0), 600.0)
RADAR = Threat("r", "radar", (0.0, 60.0), 800.0, 200.0)


def soft(*threats: Threat, hard: tuple[Disc, ...] = ()) -> KeepOut:
    """Discs of the threats with a margin of 2 m, as plans have it, and hard ones besides."""
    return KeepOut(tuple(Disc(t.name, *t.centre, t.radius_m + 2.0, False) for t in threats) + hard)


def risk(*threats: Threat, missile: float = 1.0, radar: float = 1.0) -> Risk:
    """The risk of the threats with these weights, length at 1."""
    return Risk.of(threats, Objective(1.0, missile, radar), 100.0)


def inside_m(path: Path, threat: Threat) -> float:
    """Metres of a line inside a threat's disc, by its samples."""
    rows = path.sample(1.0, 1.0)
    near = np.hypot(rows[1:, 0] - threat.centre[0], rows[1:, 1] - threat.centre[1]) < threat.radius_m - 0.01
    return float(np.diff(rows[:, 3])[near].sum())


@pytest.mark.parametrize("threat", [MISSILE, RADAR])
def test_equal_weights_go_round(threat: Threat) -> None:
    """With the default weights the line is the tangent connector's: no metre inside."""
    path = connect_by_cost(START, GOAL, soft(threat), 100.0, risk(threat))
    assert path == connect(START, GOAL, soft(threat), 100.0)
    assert inside_m(path, threat) == 0.0


@pytest.mark.parametrize("threat", [MISSILE, RADAR])
def test_risk_without_weight_is_not_minded(threat: Threat) -> None:
    """With no weight on risk the line is straight, whatever it crosses."""
    path = connect_by_cost(START, GOAL, soft(threat), 100.0, risk(threat, missile=0.0, radar=0.0))
    assert path.length_m == pytest.approx(3000.0)


def grid_cost_m(threat: Threat, metres_per_risk: float) -> float:
    """Cheapest way from start to goal over a grid of 20 m with moves in 40 directions (scipy's Dijkstra)."""
    step_m, east_m, north_m = 20.0, np.arange(-1500.0, 1501.0, 20.0), np.arange(-900.0, 901.0, 20.0)
    number = np.arange(len(east_m) * len(north_m)).reshape(len(north_m), len(east_m))

    def density(i: Floats, j: Floats) -> Floats:
        away = np.hypot(-1500.0 + step_m * j - threat.centre[0], -900.0 + step_m * i - threat.centre[1])
        if threat.model == "missile":
            return 1.0 + metres_per_risk * np.vectorize(risk_of_kill)(away, threat.radius_m)
        return 1.0 + metres_per_risk * np.vectorize(risk_of_detection)(
            away, threat.radius_m, threat.intensity_m
        )

    rows, columns = np.mgrid[0 : len(north_m), 0 : len(east_m)]
    here = density(rows, columns)
    froms, tos, costs = [], [], []
    for up in range(6):
        for right in range(-5, 6):
            if math.gcd(up, right) != 1 or (up == 0 and right < 0) or abs(up) + abs(right) > 6:
                continue
            left = slice(max(0, -right), len(east_m) - max(0, right))
            there = (slice(up, None), slice(left.start + right, left.stop + right))
            base = (slice(0, len(north_m) - up), left)
            middle = density(rows[base] + up / 2.0, columns[base] + right / 2.0)
            length_m = step_m * math.hypot(up, right)
            froms.append(number[base].ravel())
            tos.append(number[there].ravel())
            costs.append((length_m * (here[base] + 4.0 * middle + here[there]) / 6.0).ravel())
    graph = csr_matrix(
        (np.concatenate(costs), (np.concatenate(froms), np.concatenate(tos))), (number.size, number.size)
    )
    source, target = number[45, 0], number[45, -1]
    return float(dijkstra(graph, directed=False, indices=source)[target])


@pytest.mark.parametrize(
    ("threat", "weight"), [(MISSILE, 0.002), (MISSILE, 0.05), (RADAR, 0.02), (RADAR, 0.3), (RADAR, 0.9)]
)
def test_near_the_fine_grid_s_optimum(threat: Threat, weight: float) -> None:
    """The cost is within 2 % of the cheapest way of any shape that a fine grid finds."""
    terms = risk(threat, missile=weight, radar=weight)
    found_m = terms.cost_m(connect_by_cost(START, GOAL, soft(threat), 60.0, terms))
    assert found_m <= 1.02 * grid_cost_m(threat, RISK_M * weight)


def test_a_weak_radar_is_passed_at_a_distance() -> None:
    """Where the risk falls off steeply the line goes into the disc, and still keeps off the radar itself."""
    path = connect_by_cost(START, GOAL, soft(RADAR), 100.0, risk(RADAR, radar=0.3))
    assert inside_m(path, RADAR) > 500.0
    rows = path.sample(1.0, 1.0)
    assert np.hypot(rows[:, 0] - RADAR.centre[0], rows[:, 1] - RADAR.centre[1]).min() > 150.0
    assert path.length_m < connect(START, GOAL, soft(RADAR), 100.0).length_m


@pytest.mark.parametrize("threat", [MISSILE, RADAR])
def test_the_cost_is_the_integral_along_the_line(threat: Threat) -> None:
    """Eqs 12 and 14 in the limit: length and scipy's integral of eq 11 or 13 along straights and arcs."""
    terms = risk(threat, missile=0.4, radar=0.7)
    weight = 0.4 if threat.model == "missile" else 0.7
    for path in (
        connect(START, GOAL, KeepOut(), 100.0),
        connect(Anchor(-700.0, 300.0, 1.0), Anchor(400.0, -250.0, 2.5), KeepOut(), 150.0),
    ):
        whole = 0.0
        for segment in path.segments:

            def density(along_m: float, of: Segment = segment) -> float:
                away_m = math.dist(of.at(along_m).position, threat.centre)
                if threat.model == "missile":
                    return risk_of_kill(away_m, threat.radius_m)
                return risk_of_detection(away_m, threat.radius_m, threat.intensity_m)

            whole += quad(density, 0.0, segment.length_m, limit=400)[0]
        assert whole > 1.0
        # A sum in steps of 5 m: what it is off is one step at each end of what lies inside.
        expected_m = path.length_m + RISK_M * weight * whole
        assert terms.cost_m(path) == pytest.approx(expected_m, abs=RISK_M * weight * 5.5)
        assert terms.cost_m(path) == pytest.approx(expected_m, rel=0.02)


places = st.builds(Anchor, st.floats(-1500.0, 1500.0), st.floats(-1500.0, 1500.0), st.floats(-3.0, 3.0))
discs = st.tuples(st.floats(-1000.0, 1000.0), st.floats(-1000.0, 1000.0), st.floats(50.0, 600.0))


@settings(deadline=None, max_examples=40)
@given(places, places, st.lists(discs, min_size=1, max_size=3), discs, st.floats(0.0, 1.0))
def test_never_dearer_and_never_in_hard_zones(
    start: Anchor, goal: Anchor, rows: list[tuple[float, float, float]], wall: tuple[float, float, float],
    weight: float,
) -> None:  # fmt: skip
    """The chosen line is clear of what is hard and costs no more than the connector's own."""
    threats = [Threat(f"t{k}", "missile", (e, n), r) for k, (e, n, r) in enumerate(rows)]
    zones = soft(*threats, hard=(Disc("wall", *wall, True),))
    terms = risk(*threats, missile=weight)
    try:
        plain = connect(start, goal, zones, 100.0)
    except InfeasibleError:
        return
    path = connect_by_cost(start, goal, zones, 100.0, terms)
    assert not [conflict for conflict in zones.conflicts(path) if conflict.hard]
    assert terms.cost_m(path) <= terms.cost_m(plain) + 1e-9


def test_a_disc_that_holds_both_ends_is_left() -> None:
    """Ends just inside at opposite sides: the line leaves the disc and goes round it."""
    start, goal = Anchor(-550.0, 100.0, math.pi), Anchor(550.0, 100.0, math.pi)
    path = connect(start, goal, soft(MISSILE), 60.0)
    assert inside_m(path, MISSILE) < 400.0
    assert path.length_m > 2000.0


def test_weights_of_the_scenario_decide() -> None:
    """A threat between two regions is flown round by default and crossed where only length counts."""
    threat = feature("M", "threat", "Point", [0.017, 0.007], model="missile", radius_m=700.0)
    round_it = make_plan(read_scenario(small(threat)))
    through = make_plan(read_scenario(small(threat, objective={"length": 1.0, "missile": 0.0})))
    assert round_it.metrics.risk_missile == 0.0
    assert through.metrics.risk_missile > 0.0
    assert through.metrics.length_m < round_it.metrics.length_m
    assert not through.hard_violations


def test_stops_when_told() -> None:
    """The stop is asked between searches."""
    with pytest.raises(CancelledError):
        connect_by_cost(START, GOAL, soft(MISSILE), 100.0, risk(MISSILE, missile=0.1), lambda: True)


def test_a_line_found_serves_for_discs_that_grow_out_of_its_way(monkeypatch: pytest.MonkeyPatch) -> None:
    """No search is made twice, and none where the line found past smaller discs is clear of the larger."""
    searched: list[tuple[float, ...]] = []

    def counted(start: Anchor, goal: Anchor, zones: KeepOut, radius_m: float, stop: Stop = never) -> Path:
        searched.append(tuple(disc.radius_m for disc in zones.discs))
        return connect(start, goal, zones, radius_m, stop)

    monkeypatch.setattr(refine, "connect", counted)
    # The line never comes near the second missile, whatever becomes of the first.
    aside = Threat("n", "missile", (0.0, 2500.0), 900.0)
    terms = risk(MISSILE, aside, missile=0.05)
    path = connect_by_cost(START, GOAL, soft(MISSILE, aside), 60.0, terms)
    assert len(searched) == len(set(searched))
    assert {radii[1] for radii in searched} <= {902.0, 0.0}
    alone = connect_by_cost(START, GOAL, soft(MISSILE), 60.0, risk(MISSILE, missile=0.05))
    assert path == alone
