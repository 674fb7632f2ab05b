"""Times of trips whose order is given."""

import numpy as np
import pytest

from planner.fleet.problem import Alternative, Member, Problem, Service, Target, Travel
from planner.fleet.schedule import fly, stop_at


def one_target(window_s: tuple[float, float] | None, **limits: float) -> Problem:
    """A target 100 s out and 80 s home, 10 s of service."""
    seconds = np.array([[0.0, 100.0], [80.0, 0.0]])
    travel = Travel(seconds, seconds * 20.0, seconds * 0.1)
    member = Member("a", travel, **limits)  # type: ignore[arg-type]
    ways = (Alternative("w", (Service(10.0, 200.0, 1.0),)),)
    return Problem(("b",), (Target("t", ways, window_s=window_s),), (member,))


def test_a_trip_waits_at_the_base_and_not_in_the_air() -> None:
    """A window that opens late moves the take-off, and nothing is waited in the air."""
    given = one_target((500.0, 600.0))
    trip, excesses = fly(given, 0, (0, 0), [stop_at(given, 0, 0)], 0.0)
    assert excesses == ()
    assert (trip.take_off_s, trip.landing_s, trip.visits[0].wait_s) == (400.0, 590.0, 0.0)
    assert (trip.length_m, trip.energy_wh) == (3800.0, 19.0)


@pytest.mark.parametrize(
    ("limits", "window_s", "limit", "margin"),
    [
        ({}, (0.0, 90.0), "window", 20.0),
        ({"shift_s": 150.0}, None, "shift", 40.0),
        ({"max_flight_s": 150.0}, None, "flight-time", 40.0),
        ({"range_m": 3000.0}, None, "range", 800.0),
        ({"energy_wh": 15.0}, None, "energy", 4.0),
    ],
)
def test_what_breaks_is_named_with_its_margin(
    limits: dict[str, float], window_s: tuple[float, float] | None, limit: str, margin: float
) -> None:
    """Each limit says by how much it would have to give."""
    given = one_target(window_s, **limits)
    _, excesses = fly(given, 0, (0, 0), [stop_at(given, 0, 0)], 0.0)
    assert [(each.limit, each.margin) for each in excesses] == [(limit, pytest.approx(margin))]
