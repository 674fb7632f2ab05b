"""The printed model, in both readings, against enumeration."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from benchmarks.fleet_cases import case as problem
from planner.fleet.assign import assign
from planner.fleet.problem import Objective
from planner.fleet.stecz2020.model import write
from planner.fleet.stecz2020.network import Flyer, Goal, Network, Segment, Waypoint
from planner.fleet.stecz2020.solve import assign_stecz2020, run_solver, solve

OBJECTIVES = (
    Objective(total_time=0.0, travel_time=1.0),
    Objective(total_time=0.0, travel_time=0.5, priority=150.0),
    Objective(last_landing=1.0, total_time=0.01),
)


@pytest.mark.parametrize("seed", range(6))
def test_model_and_auto_agree(seed: int) -> None:
    """A solver of integer programs and the enumeration of ``auto`` come to one cost, which is the bound."""
    given = problem(
        seed,
        targets=3,
        bases=1 + seed % 2,
        objective=OBJECTIVES[seed % 3],
        required=1.0 if seed < 3 else 0.5,
        waiting_w=60.0,
        energy_wh=500.0,
    )
    model, ours = assign_stecz2020(given), assign(given)
    assert model.status == ours.status
    assert model.cost == pytest.approx(ours.cost, abs=1e-4)
    assert model.bound == pytest.approx(model.cost, abs=1e-3)
    assert [each.name for each in model.left_out] == [each.name for each in ours.left_out]


def three_targets() -> Network:
    """Three targets along a road of 300 s from base to base; the first has two segments, the others one each.

    Waypoints 0, 1 and 2, 3 are the two segments of the first, 4, 5 and 6, 7 those of the others.
    """
    places = np.array(
        [(50, 10), (70, 10), (50, -10), (70, -10), (130, 0), (150, 0), (210, 0), (230, 0), (0, 0), (300, 0)],
        dtype=float,
    )
    seconds = np.hypot(*(places[:, None, :] - places[None, :, :]).transpose(2, 0, 1))
    pairs = ((0, 0, 0, 1), (0, 1, 2, 3), (1, 0, 4, 5), (2, 0, 6, 7))
    return Network(
        tuple(Waypoint() for _ in range(8)),
        tuple(Segment(target, way, k, m, 500.0) for target, way, k, m in pairs),
        (Flyer(8, (9,), seconds),),
        Goal(rho=1.0),
        frozenset({0, 1, 2}),
    )


def test_the_text_takes_one_alternative_and_the_print_takes_both() -> None:
    """(29) as printed makes x alike on all four waypoints of a target with two segments."""
    meant, printed = solve(three_targets(), "meant"), solve(three_targets(), "printed")
    assert len(meant.visited & {0, 1, 2, 3}) == 2
    assert meant.visited in ({0, 1, 4, 5, 6, 7}, {2, 3, 4, 5, 6, 7})
    assert printed.visited == set(range(8))


def test_the_print_lets_a_line_pass_a_segment_by() -> None:
    """(30) and (31) as printed let a line visit both ends of a segment without flying between them."""
    network = three_targets()
    idle = Network(
        tuple(Waypoint(priority=500.0) for _ in range(8)),
        tuple(Segment(s.target, s.alternative, s.k, s.m) for s in network.segments),
        network.flyers,
        Goal(rho=1.0),
    )
    line = solve(idle, "printed").lines[0]
    legs = {frozenset(leg) for leg in itertools.pairwise(line)}
    assert not legs >= {frozenset({0, 1}), frozenset({2, 3})}
    line = solve(idle, "meant").lines[0]
    legs = {frozenset(leg) for leg in itertools.pairwise(line)}
    assert legs >= {frozenset({4, 5}), frozenset({6, 7})}
    assert len(legs & {frozenset({0, 1}), frozenset({2, 3})}) == 1


def test_a_segment_needs_its_sensor_in_the_text_alone() -> None:
    """(21) as printed holds with every sensor off; as meant no segment can be flown then."""
    printed, meant = write(three_targets(), "printed"), write(three_targets(), "meant")
    for model in (printed, meant):
        for sensor in model.f:
            model.rows.high[sensor] = 0.0
    result = run_solver(printed)
    assert sum(result.x[v] for (_, i, j), v in printed.y.items() if {i, j} == {4, 5}) > 0.5
    assert run_solver(meant).x is None


def test_either_direction_of_a_segment() -> None:
    """The constraints enforce the edge, not its direction: coming from the far end it is flown back."""
    network = three_targets()
    turned = Flyer(9, (8,), network.flyers[0].seconds)
    line = solve(
        Network(network.waypoints, network.segments, (turned,), network.goal, network.required)
    ).lines[0]
    assert line[1:5] == (7, 6, 5, 4)


def test_windows_and_recognition_times() -> None:
    """(26) to (28): a window decides the order, and what it takes to recognise counts on the way."""
    network = three_targets()
    points = list(network.waypoints)
    points[4] = Waypoint((300.0, math.inf))
    points[6] = Waypoint((0.0, 260.0), isr_s=30.0)
    late = Network(tuple(points), network.segments, network.flyers, network.goal, network.required)
    line = solve(late).lines[0]
    assert line.index(6) < line.index(4)


def test_a_shorter_flight_leaves_out_what_does_not_fit() -> None:
    """The longest flight is kept and the required target that it costs is named."""
    given = problem(1, targets=3, windows=0.0, max_flight_s=600.0)
    answer = assign_stecz2020(given)
    assert all(trip.duration_s <= 600.0 + 1e-6 for trip in answer.trips)
    assert [each.name for each in answer.left_out] == [each.name for each in assign(given).left_out]
