"""Clear and set-current: one question, one answer."""

from __future__ import annotations

import pytest

from mavlink.transfer.clear import ClearMachine, SetCurrentMachine
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.wire.items import MissionResult, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.transfer.vehicle import from_vehicle


@pytest.mark.parametrize("result", list(MissionResult))
def test_every_result_of_clear_is_its_outcome(result: MissionResult) -> None:
    """ACCEPTED accepts, everything else refuses with its own code."""
    machine = ClearMachine(MissionType.FENCE, 1, 1)
    (question,) = machine.start(0.0)
    assert (question.name, question.integer("mission_type")) == ("MISSION_CLEAR_ALL", 1)
    machine.receive(from_vehicle("MISSION_ACK", type=int(result), mission_type=0), 0.1)
    assert machine.outcome is None
    machine.receive(from_vehicle("MISSION_ACK", type=int(result), mission_type=1), 0.1)
    assert machine.outcome == (Accepted() if result == MissionResult.ACCEPTED else Refused(result))


def test_clear_is_repeated_and_then_unknown() -> None:
    """Five repetitions 1500 ms apart."""
    machine = ClearMachine(MissionType.MISSION, 1, 1)
    sent = len(machine.start(0.0))
    while machine.outcome is None:
        sent += len(machine.tick(machine.deadline_s))
    assert sent == 6
    assert machine.outcome == Unknown("timeout")


def test_set_current_waits_for_its_own_number() -> None:
    """The periodic report of another item is no answer."""
    machine = SetCurrentMachine(4, 1, 1)
    (question,) = machine.start(0.0)
    assert (question.name, question.integer("seq")) == ("MISSION_SET_CURRENT", 4)
    machine.receive(from_vehicle("MISSION_CURRENT", seq=3), 0.1)
    machine.receive(Message("MISSION_CURRENT", {"seq": 4}, 2, 1), 0.1)
    assert machine.outcome is None
    machine.receive(from_vehicle("MISSION_CURRENT", seq=4), 0.2)
    assert machine.outcome == Accepted()


def test_set_current_past_the_end_is_unknown_or_refused() -> None:
    """ArduPilot says nothing; others send an acknowledgement."""
    silent = SetCurrentMachine(400, 1, 1)
    silent.start(0.0)
    while silent.outcome is None:
        silent.tick(silent.deadline_s)
    assert silent.outcome == Unknown("timeout")
    refused = SetCurrentMachine(400, 1, 1)
    refused.start(0.0)
    refused.receive(from_vehicle("MISSION_ACK", type=int(MissionResult.INVALID_SEQUENCE)), 0.1)
    assert refused.outcome == Refused(MissionResult.INVALID_SEQUENCE, 400)


def test_cancelling_either_is_unknown() -> None:
    """The vehicle may have done it already."""
    machine = ClearMachine(MissionType.MISSION, 1, 1)
    machine.start(0.0)
    machine.cancel(0.1)
    assert machine.outcome == Unknown("cancelled")
    machine.receive(from_vehicle("MISSION_ACK", type=0), 0.2)
    assert machine.outcome == Unknown("cancelled")
