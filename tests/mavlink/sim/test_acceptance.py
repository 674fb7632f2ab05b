"""What each flavour takes and makes of items, against the measured tables."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from mavlink.sim.acceptance import infeasible, refusal
from mavlink.sim.modes import Flavour
from mavlink.sim.storage import as_stored
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType
from tests.mavlink.sim.helpers import HOME, item, landing_mission, numbered, waypoint

NAN = math.nan
ARDUPILOT, PX4 = Flavour.ARDUPILOT, Flavour.PX4


def raw(command: int, frame: int, params: tuple[float, ...] = (), z: float = 50.0) -> MissionItem:
    p1, p2, p3, p4 = (*params, *(0.0,) * (4 - len(params)))
    return MissionItem(3, frame, command, p1, p2, p3, p4, 473977000, 85456000, z)


def placeless(command: int, frame: int, params: tuple[float, ...], z: float) -> MissionItem:
    return replace(raw(command, frame, params, z), x=0, y=0)


@pytest.mark.parametrize(
    ("flavour", "command", "frame", "params", "answer"),
    [
        (ARDUPILOT, Command.NAV_WAYPOINT, 3, (0.0, 0.0, 0.0, NAN), None),
        (ARDUPILOT, Command.NAV_WAYPOINT, 3, (NAN,), MissionResult.INVALID_PARAM1),
        (ARDUPILOT, Command.NAV_LOITER_TURNS, 3, (1.0, 0.0, NAN), MissionResult.INVALID_PARAM3),
        (ARDUPILOT, Command.NAV_WAYPOINT, 1, (), MissionResult.UNSUPPORTED_FRAME),
        (ARDUPILOT, Command.NAV_WAYPOINT, 10, (), None),
        (ARDUPILOT, Command.DO_SET_RELAY, 2, (0.0, 1.0), None),
        (ARDUPILOT, Command.DO_SET_CAM_TRIGG_INTERVAL, 2, (1000.0,), MissionResult.UNSUPPORTED),
        (ARDUPILOT, Command.DO_TRIGGER_CONTROL, 2, (1.0,), MissionResult.UNSUPPORTED),
        (ARDUPILOT, 195, 3, (), MissionResult.UNSUPPORTED),
        (ARDUPILOT, 82, 3, (), MissionResult.UNSUPPORTED),
        (ARDUPILOT, Command.DO_JUMP, 2, (0.0, 1.0), MissionResult.ERROR),
        (ARDUPILOT, Command.DO_JUMP, 2, (10.0, 1.0), MissionResult.ERROR),
        (ARDUPILOT, Command.DO_JUMP, 2, (2.0, 1.0), None),
        (PX4, Command.NAV_WAYPOINT, 6, (0.0, 0.0, 0.0, NAN), None),
        (PX4, Command.NAV_WAYPOINT, 2, (), MissionResult.UNSUPPORTED),
        (PX4, Command.NAV_WAYPOINT, 10, (), MissionResult.UNSUPPORTED_FRAME),
        (PX4, Command.NAV_LOITER_TURNS, 6, (1.0,), MissionResult.UNSUPPORTED),
        (PX4, Command.DO_SET_RELAY, 2, (0.0, 1.0), MissionResult.UNSUPPORTED),
        (PX4, Command.DO_SET_SERVO, 2, (9.0, 1900.0), MissionResult.UNSUPPORTED),
        (PX4, Command.DO_SET_ACTUATOR, 2, (1.0, NAN), None),
        (PX4, Command.DO_CHANGE_SPEED, 2, (0.0, 20.0), None),
        (PX4, Command.DO_CHANGE_SPEED, 3, (0.0, 20.0), MissionResult.UNSUPPORTED),
        (PX4, Command.DO_FENCE_ENABLE, 2, (1.0,), MissionResult.UNSUPPORTED),
        (PX4, Command.CONDITION_DISTANCE, 2, (10.0,), None),
    ],
)
def test_answers_are_those_measured(
    flavour: Flavour, command: int, frame: int, params: tuple[float, ...], answer: MissionResult | None
) -> None:
    """Each item draws the answer that the real autopilot was seen to give."""
    assert refusal(flavour, raw(command, frame, params), count=10) == answer


def test_the_sensor_command_is_taken_by_both() -> None:
    """A user command is refused unless the payload answers to it."""
    for flavour in Flavour:
        order = raw(31010, 2, (1.0,))
        assert refusal(flavour, order, 10) is MissionResult.UNSUPPORTED
        assert refusal(flavour, order, 10, sensor_command=31010) is None


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        (raw(16, 6, (5.0, 12.7, 300.0, 90.0), 50.129), raw(16, 3, (0.0, 12.0, 255.0, 0.0), 50.12)),
        (raw(16, 5, (), 0.29), raw(16, 0, (), 0.29)),
        (raw(16, 11, (), -3.999), raw(16, 10, (), -3.99)),
        (raw(22, 3, (12.6, 0.0, 0.0, NAN)), raw(22, 3, (12.0, 0.0, 0.0, 0.0))),
        (raw(18, 3, (0.5, 0.0, 104.6)), raw(18, 3, (0.5, 0.0, 104.0))),
        (raw(18, 3, (2.7, 0.0, -267.0)), raw(18, 3, (2.0, 0.0, -260.0))),
        (raw(18, 3, (300.0, 0.0, 9999.0)), raw(18, 3, (255.0, 0.0, 2550.0))),
        (raw(19, 3, (9.9, 0.0, -80.0)), raw(19, 3, (9.0, 0.0, -1.0))),
        (raw(31, 3, (1.0, 120.7)), raw(31, 3, (0.0, 120.0))),
        (raw(21, 3, (4.2, 0.0, 0.0, NAN)), raw(21, 3, (4.0, 0.0, 0.0, 1.0))),
        (raw(178, 2, (0.0, 20.0, -1.0, 7.0), 0.0), placeless(178, 0, (0.0, 20.0, -1.0, 0.0), 0.0)),
        (raw(183, 2, (9.0, 1900.9), 0.0), placeless(183, 0, (9.0, 1900.0), 0.0)),
        (raw(206, 2, (25.0, 3.0, 1.0), 0.0), placeless(206, 0, (25.0, 0.0, 1.0), 0.0)),
    ],
)
def test_ardupilot_rounds_as_measured(sent: MissionItem, kept: MissionItem) -> None:
    """Read-back of each item is what ArduPlane made of it."""
    assert as_stored(ARDUPILOT, sent, HOME) == kept


@pytest.mark.parametrize(
    ("sent", "kept"),
    [
        (raw(16, 3, (2.0, 0.0, 5.0, -90.0), 50.129), raw(16, 6, (2.0, 0.0, 0.0, 270.0), 50.129)),
        (raw(16, 0), raw(16, 5)),
        (raw(22, 6, (15.0,)), raw(22, 6)),
        (raw(177, 2, (2.0, -1.0)), raw(177, 2, (2.0, 65535.0))),
        (raw(80, 6), raw(201, 6)),
    ],
)
def test_px4_rounds_as_measured(sent: MissionItem, kept: MissionItem) -> None:
    """Read-back of each item is what PX4 made of it."""
    assert as_stored(PX4, sent, HOME) == kept


def test_px4_keeps_an_open_yaw() -> None:
    """A NaN yaw stays NaN."""
    assert math.isnan(as_stored(PX4, raw(16, 3, (0.0, 0.0, 0.0, NAN)), HOME).param4)


def test_ardupilot_puts_home_into_row_0() -> None:
    """Whatever is sent as item 0 becomes home, even a take-off."""
    sent = replace(raw(Command.NAV_TAKEOFF, 3), seq=0)
    kept = as_stored(ARDUPILOT, sent, HOME)
    assert (kept.command, kept.frame, kept.z) == (Command.NAV_WAYPOINT, Frame.GLOBAL, HOME.altitude_m)
    assert (kept.x, kept.y) == (round(HOME.lat_deg * 1e7), round(HOME.lon_deg * 1e7))


def test_rally_altitudes_are_whole_metres_on_ardupilot() -> None:
    """A rally point of 50.9 m reads back as 50 m."""
    sent = replace(raw(Command.NAV_RALLY_POINT, 3, z=50.9), mission_type=MissionType.RALLY)
    assert as_stored(ARDUPILOT, sent, HOME).z == 50.0
    assert as_stored(PX4, sent, HOME).z == 50.9


def test_px4_missions_need_a_landing_and_their_takeoff_first() -> None:
    """On PX4 a take-off is the first place, and a landing is there; ArduPilot needs neither to store it."""
    good = numbered(landing_mission([waypoint(0.0, 1000.0)], home_row=False))
    assert infeasible(PX4, good) == ""
    assert "takeoff" in infeasible(PX4, numbered(landing_mission([], home_row=True)))
    assert "landing" in infeasible(PX4, good[:-1])
    assert infeasible(PX4, numbered(landing_mission([waypoint(0.0, 1000.0)], home_row=False)[1:])) == ""
    assert "condition" in infeasible(PX4, [*good, item(Command.CONDITION_DELAY, None, (3.0,))])
    assert infeasible(ARDUPILOT, numbered([item(16, HOME), waypoint(0.0, 1000.0)])) == ""
    assert "no mission" in infeasible(ARDUPILOT, numbered([item(16, HOME)]))
