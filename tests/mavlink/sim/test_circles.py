"""When a circle is left for what comes next, on it, outside it or inside it."""

from __future__ import annotations

import math

import pytest

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command
from tests.mavlink.sim.helpers import HOME, Station, item, landing_mission, place_at, waypoint

RADIUS_M = 48.0


@pytest.mark.parametrize("part", [0.7, 0.95, 0.98, 1.0, 1.3])
def test_part_of_a_circle_is_flown_once_wherever_it_is_left_for(part: float) -> None:
    """A half turn to the left ends beside a waypoint at so many radii: it is no turn and a half."""
    side_m = RADIUS_M * part
    body = [
        waypoint(RADIUS_M, 600.0),
        waypoint(RADIUS_M, 1000.0),
        item(Command.NAV_LOITER_TURNS, place_at(0.0, 1000.0), (0.125, 0.0, -RADIUS_M, 1.0)),
        waypoint(-side_m, 1000.0),
        waypoint(-side_m, 400.0),
    ]
    aircraft = SimulatedAircraft(SimSettings(home=HOME, autopilot=Flavour.ARDUPILOT, airspeed_m_s=18.0))
    s = Station(aircraft)
    assert s.upload(landing_mission(body, home_row=True)) == 0
    s.start()
    s.fly(400.0)
    near = [state for state in s.track if 900.0 < _north_m(state.lat_deg) < 1100.0]
    turned_rad = sum(-state.turn_rate_rad_s * 0.05 for state in near)
    # The corner into the circle and what is overshot of it besides.
    assert turned_rad == pytest.approx(math.pi, abs=0.7)


def _north_m(lat_deg: float) -> float:
    return math.radians(lat_deg - HOME.lat_deg) * 6_371_000.0
