"""Specifications of payloads."""

from __future__ import annotations

import pytest

from mavlink.encoding.payload import (
    ActuatorPayload,
    CameraPayload,
    CommandPayload,
    ImagePayload,
    Payload,
    PayloadError,
    Px4Output,
    RelayPayload,
    ServoPayload,
    parse_payload,
    switch_items,
)


@pytest.mark.parametrize(
    ("text", "payload"),
    [
        ("relay:3", RelayPayload(3)),
        ("relay", RelayPayload(0)),
        ("servo:9:1850:1150", ServoPayload(9, 1850, 1150)),
        ("servo:9", ServoPayload(9)),
        ("actuator:2", ActuatorPayload(2)),
        ("actuator:2:0.5:-0.5", ActuatorPayload(2, 0.5, -0.5)),
        ("aux:3", ActuatorPayload(1, output=Px4Output("aux", 3))),
        ("aux:3:2", ActuatorPayload(2, output=Px4Output("aux", 3))),
        ("main:16:4:0.5:-0.5", ActuatorPayload(4, 0.5, -0.5, Px4Output("main", 16))),
        ("camera:distance=25", CameraPayload(25.0)),
        ("image:interval=2", ImagePayload(2.0)),
        (
            "command:2000:0,2,0/2001:0",
            CommandPayload(2000, (0, 2, 0, 0, 0, 0, 0), 2001, (0, 0, 0, 0, 0, 0, 0)),
        ),
        (
            "command:31010:1,2,3,4,5,6,7/0",
            CommandPayload(31010, (1, 2, 3, 4, 5, 6, 7), 31010, (0, 0, 0, 0, 0, 0, 0)),
        ),
    ],
)
def test_specifications_are_understood(text: str, payload: Payload) -> None:
    """Each kind has its short form, with defaults where there are any."""
    assert parse_payload(text) == payload


@pytest.mark.parametrize(
    "text",
    [
        "",
        "laser:1",
        "relay:one",
        "relay:-1",
        "relay:16",
        "servo",
        "servo:0",
        "servo:9:50:1100",
        "servo:9:1900:1100:7",
        "actuator:5",
        "actuator:1:2:0",
        "actuator:1:1:-1:0",
        "aux",
        "aux:0",
        "aux:9",
        "aux:1:5",
        "aux:1:1:2",
        "aux:1:1:1:-1:0",
        "main:17",
        "main:x",
        "camera:25",
        "camera:distance=0",
        "camera:distance=nan",
        "image:interval=-1",
        "command:2000:1",
        "command:x:1/0",
        "command:2000:1,2,3,4,5,6,7,8/0",
        "command:70000:1/0",
        "command:2000:0,0,0,0,0.5/0",
    ],
)
def test_what_is_not_understood_is_refused(text: str) -> None:
    """Unknown kinds, missing parts and impossible numbers raise PayloadError, nothing else."""
    with pytest.raises(PayloadError):
        parse_payload(text)


def test_a_command_keeps_all_seven_parameters() -> None:
    """Parameters five to seven travel as x, y and z."""
    on, off = switch_items(parse_payload("command:31010:1,2,3,4,5,6,7.5/0"))
    assert (on.param1, on.param2, on.param3, on.param4, on.x, on.y, on.z) == (1, 2, 3, 4, 5, 6, 7.5)
    assert (off.command, off.param1, off.z) == (31010, 0.0, 0.0)
