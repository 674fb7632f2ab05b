"""Payloads as items of the mission, and those that an autopilot does not take."""

from __future__ import annotations

import math

import pytest

from mavlink.dialects import Autopilot
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from mavlink.encoding.payload import (
    ActuatorPayload,
    CameraPayload,
    CommandPayload,
    ImagePayload,
    RelayPayload,
    ServoPayload,
)
from mavlink.wire.items import Command, Frame
from tests.mavlink.encoding.missions import (
    W,
    flight,
)
from tests.mavlink.plans import make_plan


@pytest.mark.parametrize(
    ("payload", "on", "off"),
    [
        (ServoPayload(9, 1900, 1100), (183, 9.0, 1900.0), (183, 9.0, 1100.0)),
        (CameraPayload(25.0), (206, 25.0, 0.0), (206, 0.0, 0.0)),
        (ImagePayload(2.0), (2000, 0.0, 2.0), (2001, 0.0, 0.0)),
        (
            CommandPayload(181, (3.0, 1.0, 0, 0, 0, 0, 0), 181, (3.0, 0.0, 0, 0, 0, 0, 0)),
            (181, 3.0, 1.0),
            (181, 3.0, 0.0),
        ),
    ],
)
def test_payloads_become_items(payload: object, on: tuple[float, ...], off: tuple[float, ...]) -> None:
    """Servo, shutter, camera protocol and a command of one's own are switched by their items."""
    mission = encode(make_plan(), options=EncodeOptions(payload=payload))
    flown_to = (W, Command.NAV_LOITER_TURNS)
    switches = [(i.command, i.param1, i.param2) for i in flight(mission) if i.command not in flown_to]
    assert switches == [on, off, on, off]


def test_a_command_of_ones_own_firmware_is_sent_with_a_note() -> None:
    """Nothing is known of it, so the vehicle's answer decides."""
    own = CommandPayload(31010, (1, 0, 0, 0, 0, 0, 0), 31010, (0, 0, 0, 0, 0, 0, 0))
    for autopilot in ("ardupilot", "px4"):
        mission = encode(make_plan(), autopilot=autopilot, options=EncodeOptions(payload=own))
        assert any("31010" in note for note in mission.notes)
        assert {f.severity for f in mission.dialect.check(mission.mission)} == {"warning"}


def test_px4_is_given_an_actuator_for_a_relay_and_told_so() -> None:
    """PX4 refuses relays: relay 2 becomes actuator 3, the others unchanged, with a note."""
    mission = encode(make_plan(), autopilot="px4", options=EncodeOptions(payload=RelayPayload(2)))
    on = next(item for item in flight(mission) if item.command == Command.DO_SET_ACTUATOR)
    assert (on.frame, on.param3) == (Frame.MISSION, 1.0)
    assert math.isnan(on.param1)
    assert math.isnan(on.param4)
    assert any("actuator 3" in note for note in mission.notes)


@pytest.mark.parametrize(
    ("autopilot", "payload"), [("px4", ServoPayload(9)), ("ardupilot", ActuatorPayload(1))]
)
def test_payloads_that_the_autopilot_refuses_are_refused_here(autopilot: Autopilot, payload: object) -> None:
    """A servo on PX4 and a PX4 actuator on ArduPilot draw UNSUPPORTED before anything is sent."""
    with pytest.raises(EncodeError, match="UNSUPPORTED") as refused:
        encode(make_plan(), autopilot=autopilot, options=EncodeOptions(payload=payload))
    assert ("aux:1" in str(refused.value)) == (autopilot == "px4"), "what to write instead"
