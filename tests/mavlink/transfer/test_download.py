"""The download machine against single messages."""

from __future__ import annotations

import math

import pytest

from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.wire.items import MissionResult, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.transfer.vehicle import StubVehicle, from_vehicle, waypoints


def begun() -> DownloadMachine:
    machine = DownloadMachine(MissionType.MISSION, 1, 1)
    (request,) = machine.start(0.0)
    assert request.name == "MISSION_REQUEST_LIST"
    return machine


def count(machine: DownloadMachine, number: int) -> list[Message]:
    return machine.receive(from_vehicle("MISSION_COUNT", count=number), 0.1)


def give(machine: DownloadMachine, seq: int, now_s: float = 0.1) -> list[Message]:
    vehicle = StubVehicle()
    vehicle.held[0] = waypoints(5)
    (item,) = vehicle.receive(Message("MISSION_REQUEST_INT", {"seq": seq, "mission_type": 0}), 0.0)
    return machine.receive(item, now_s)


def words(messages: list[Message]) -> list[tuple[str, int]]:
    return [(word.name, word.integer("seq" if "seq" in word.fields else "type")) for word in messages]


def test_items_are_asked_for_in_order_and_acknowledged() -> None:
    """Each item draws the next request, the last one the final acknowledgement."""
    machine = begun()
    assert words(count(machine, 3)) == [("MISSION_REQUEST_INT", 0)]
    assert words(give(machine, 0)) == [("MISSION_REQUEST_INT", 1)]
    assert machine.progress == Progress(1, 3)
    assert words(give(machine, 1)) == [("MISSION_REQUEST_INT", 2)]
    assert words(give(machine, 2)) == [("MISSION_ACK", 0)]
    assert machine.outcome == Accepted()
    assert machine.items == waypoints(3)
    assert machine.deadline_s == math.inf


def test_an_empty_list_is_acknowledged() -> None:
    """A count of 0 is an answer."""
    machine = begun()
    assert words(count(machine, 0)) == [("MISSION_ACK", 0)]
    assert (machine.outcome, machine.items) == (Accepted(), ())


def test_a_lost_acknowledgement_is_given_again() -> None:
    """PX4 refuses the next upload until it has the last word, so a repeated last item draws it again."""
    machine = begun()
    count(machine, 1)
    give(machine, 0)
    assert words(give(machine, 0)) == [("MISSION_ACK", 0)]


def test_duplicates_and_items_out_of_turn_are_not_stored() -> None:
    """A repeated count, a repeated item and one from further on change nothing."""
    machine = begun()
    count(machine, 3)
    assert count(machine, 3) == []
    give(machine, 0)
    assert give(machine, 0) == []
    assert give(machine, 2) == []
    give(machine, 1)
    give(machine, 2)
    assert machine.items == waypoints(3)


def test_another_count_starts_over() -> None:
    """The list changed under the download: what was received belongs to the old one."""
    machine = begun()
    count(machine, 3)
    give(machine, 0)
    assert words(count(machine, 2)) == [("MISSION_REQUEST_INT", 0)]
    give(machine, 0)
    give(machine, 1)
    assert machine.items == waypoints(2)


def test_items_are_asked_for_again_with_growing_patience() -> None:
    """250 ms, doubling to 1500 ms, five times; then unknown."""
    machine = begun()
    count(machine, 2)
    waits = []
    now_s = 0.1
    while machine.outcome is None:
        waits.append(machine.deadline_s - now_s)
        now_s = machine.deadline_s
        machine.tick(now_s)
    assert waits == pytest.approx([0.25, 0.5, 1.0, 1.5, 1.5, 1.5])
    assert machine.outcome == Unknown("timeout", 0)


REFUSING = [result for result in MissionResult if result != MissionResult.ACCEPTED]


@pytest.mark.parametrize("result", REFUSING)
def test_every_refusal_ends_a_download(result: MissionResult) -> None:
    """Each refusing MAV_MISSION_RESULT, whether in place of the count or of an item."""
    machine = begun()
    machine.receive(from_vehicle("MISSION_ACK", type=int(result)), 0.1)
    assert machine.outcome == Refused(result, None)
    machine = begun()
    count(machine, 2)
    machine.receive(from_vehicle("MISSION_ACK", type=int(result)), 0.1)
    assert machine.outcome == Refused(result, 0)


def test_other_senders_and_types_change_nothing() -> None:
    """A count from another system or of another list is not ours."""
    machine = begun()
    assert machine.receive(Message("MISSION_COUNT", {"count": 0, "mission_type": 0}, 9, 1), 0.1) == []
    assert machine.receive(Message("MISSION_COUNT", {"count": 0, "mission_type": 2}, 1, 1), 0.1) == []
    assert machine.outcome is None


def test_cancelling_tells_the_vehicle() -> None:
    """The vehicle gets OPERATION_CANCELLED and need not wait."""
    machine = begun()
    assert words(machine.cancel(0.1)) == [("MISSION_ACK", MissionResult.OPERATION_CANCELLED)]
    assert machine.outcome == Unknown("cancelled", None)
    assert count(machine, 3) == []
