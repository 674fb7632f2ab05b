"""A simulated aircraft with a ground station at it, bare or with a mission on board."""

from __future__ import annotations

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import MissionItem
from mavlink.wire.messages import Message
from tests.mavlink.sim.helpers import (
    HOME,
    Station,
    landing_mission,
    waypoint,
)

LONG_WAY = [waypoint(0.0, 1000.0), waypoint(0.0, 6000.0)]


def station(flavour: Flavour = Flavour.ARDUPILOT, **options: float | bool | str) -> Station:
    return Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=flavour, **options)))


def loaded(flavour: Flavour, body: list[MissionItem] | None = None, **options: float) -> Station:
    s = station(flavour, **options)
    assert s.upload(landing_mission(body or LONG_WAY, home_row=flavour is Flavour.ARDUPILOT)) == 0
    return s


def told(s: Station, name: str) -> Message:
    message = s.aircraft.message(name)
    assert message is not None
    return message
