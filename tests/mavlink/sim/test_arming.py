"""What arming and starting do in each autopilot: the surprises that the real ones hold, too."""

from __future__ import annotations

from typing import Literal

import pytest

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.wire.items import Command
from tests.mavlink.sim.helpers import HOME, Station, landing_mission, waypoint

ARM = (Command.COMPONENT_ARM_DISARM, 1.0)
AUTO = {
    (Flavour.ARDUPILOT, "fixed_wing"): (1.0, 10.0),
    (Flavour.ARDUPILOT, "multirotor"): (1.0, 3.0),
    (Flavour.PX4, "fixed_wing"): (1.0, 4.0, 4.0),
    (Flavour.PX4, "multirotor"): (1.0, 4.0, 4.0),
}


def holding_a_mission(flavour: Flavour, kind: Literal["fixed_wing", "multirotor"]) -> Station:
    """An aircraft on the ground that holds a mission with a take-off."""
    settings = SimSettings(home=HOME, autopilot=flavour, vehicle_type=kind)
    station = Station(SimulatedAircraft(settings))
    body = [waypoint(0.0, 900.0)]
    assert station.upload(landing_mission(body, home_row=flavour is Flavour.ARDUPILOT)) == 0
    return station


@pytest.mark.parametrize("craft", [each for each in AUTO if each != (Flavour.ARDUPILOT, "multirotor")])
def test_armed_in_the_missions_mode_it_takes_off(
    craft: tuple[Flavour, Literal["fixed_wing", "multirotor"]],
) -> None:
    """ArduPlane and PX4 want no other word than the order to arm."""
    station = holding_a_mission(*craft)
    assert station.command(Command.DO_SET_MODE, *AUTO[craft]) == 0
    station.fly(2.0)
    assert station.aircraft.state.on_ground
    assert station.command(*ARM) == 0
    station.fly(15.0)
    assert not station.aircraft.state.on_ground


def test_copter_is_not_armed_in_auto() -> None:
    """ArduCopter refuses with its reason unless AUTO_OPTIONS allows it; in GUIDED it arms, and stands."""
    station = holding_a_mission(Flavour.ARDUPILOT, "multirotor")
    assert station.command(Command.DO_SET_MODE, *AUTO[Flavour.ARDUPILOT, "multirotor"]) == 0
    assert station.command(*ARM) != 0
    assert "Arm: Auto mode not armable" in station.texts()
    assert station.command(Command.DO_SET_MODE, 1.0, 4.0) == 0
    assert station.command(*ARM) == 0
    station.fly(15.0)
    assert station.aircraft.state.on_ground


@pytest.mark.parametrize("craft", list(AUTO))
def test_only_px4_is_armed_by_the_order_to_start(
    craft: tuple[Flavour, Literal["fixed_wing", "multirotor"]],
) -> None:
    """MISSION_START of a disarmed aircraft: PX4 arms and goes, ArduPilot says yes and stands."""
    station = holding_a_mission(*craft)
    assert station.command(Command.MISSION_START) == 0
    station.fly(15.0)
    assert station.aircraft.armed == (craft[0] is Flavour.PX4)
    assert station.aircraft.state.on_ground != station.aircraft.armed
