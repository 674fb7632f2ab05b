"""Cases of MAVSDK's own mission-transfer suites that the other files of this folder do not name."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mavlink.transfer.clear import SetCurrentMachine, flown_for
from mavlink.transfer.download import DownloadMachine
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.items import Command, MissionItem, MissionResult, MissionType
from tests.mavlink.transfer.vehicle import from_vehicle, waypoints


def test_an_upload_that_goes_on_does_not_time_out() -> None:
    """A vehicle that asks every six seconds, an hour long in all, is slow and not silent."""
    machine = UploadMachine(waypoints(600), MissionType.MISSION, 1, 1)
    machine.start(0.0)
    for seq in range(600):
        now_s = 1.0 + 6.0 * seq
        assert machine.tick(now_s) == []
        assert len(machine.receive(from_vehicle("MISSION_REQUEST_INT", seq=seq), now_s)) == 1
    machine.receive(from_vehicle("MISSION_ACK", type=0), now_s + 1.0)
    assert machine.outcome == Accepted()


def test_the_list_is_asked_for_again_and_then_given_up() -> None:
    """MISSION_REQUEST_LIST six times, 1500 ms apart; then unknown, and a late count begins nothing."""
    machine = DownloadMachine(MissionType.RALLY, 1, 1)
    sent = machine.start(0.0)
    times = []
    while machine.outcome is None:
        times.append(machine.deadline_s)
        sent += machine.tick(machine.deadline_s)
    assert [message.name for message in sent] == [*["MISSION_REQUEST_LIST"] * 6, "MISSION_ACK"]
    # Or a vehicle that still serves it would refuse the next list.
    assert sent[-1].integer("type") == MissionResult.OPERATION_CANCELLED
    assert {message.integer("mission_type") for message in sent} == {2}
    assert times == pytest.approx([1.5, 3.0, 4.5, 6.0, 7.5, 9.0])
    assert machine.outcome == Unknown("timeout", None)
    assert machine.receive(from_vehicle("MISSION_COUNT", count=3, mission_type=2), 9.1) == []


def test_another_id_starts_a_download_over() -> None:
    """The same number of items under another id is another list: what was received belongs to the old one."""
    machine = DownloadMachine(MissionType.MISSION, 1, 1)
    machine.start(0.0)
    machine.receive(from_vehicle("MISSION_COUNT", count=3, opaque_id=7), 0.1)
    item = {"frame": 3, "command": 16, "x": 1, "y": 2, "z": 3.0, "current": 0, "autocontinue": 1}
    parameters = {f"param{number}": 0.0 for number in (1, 2, 3, 4)}
    machine.receive(from_vehicle("MISSION_ITEM_INT", seq=0, **item, **parameters), 0.2)
    assert len(machine.items) == 1
    assert machine.receive(from_vehicle("MISSION_COUNT", count=3, opaque_id=7), 0.3) == []
    (request,) = machine.receive(from_vehicle("MISSION_COUNT", count=3, opaque_id=8), 0.4)
    assert (request.name, request.integer("seq"), machine.items) == ("MISSION_REQUEST_INT", 0, ())
    assert machine.opaque_id == 8


def test_set_current_is_repeated_until_it_is_answered() -> None:
    """Lost three times, answered the fourth: accepted, and not sent again."""
    machine = SetCurrentMachine(4, 1, 1)
    sent = machine.start(0.0)
    for _ in range(3):
        sent += machine.tick(machine.deadline_s)
    assert [(message.name, message.integer("seq")) for message in sent] == [("MISSION_SET_CURRENT", 4)] * 4
    machine.receive(from_vehicle("MISSION_CURRENT", seq=4), 5.0)
    assert machine.outcome == Accepted()
    assert machine.tick(100.0) == []


def mission(*commands: int, jump_to: float = 0.0) -> tuple[MissionItem, ...]:
    """Items of these commands; the jumps among them lead to one item."""
    items = (replace(item, command=number) for item, number in zip(waypoints(9), commands, strict=False))
    return tuple(replace(item, param1=jump_to) if item.command == Command.DO_JUMP else item for item in items)


@pytest.mark.parametrize(
    ("items", "seq", "flown"),
    [
        (mission(16, 16, 16), 1, {1}),
        (mission(16, 178, 181, 16, 16), 1, {1, 2, 3}),
        (mission(16, 178), 1, {1}),
        (mission(16, 22, 16, 177, 16, jump_to=0.0), 3, {3, 4, 0}),
        (mission(16, 22, 16, 177, 16, jump_to=1.0), 3, {3, 4, 1}),
        (mission(16, 177, jump_to=1.0), 1, {1}),
        (mission(16, 177, jump_to=float("nan")), 1, {1}),
        (mission(16), 5, set()),
    ],
    ids=[
        "waypoint",
        "do",
        "do at the end",
        "jump to home",
        "jump",
        "jump to itself",
        "nowhere",
        "past the end",
    ],
)
def test_items_that_are_no_places_lead_to_the_next(
    items: tuple[MissionItem, ...], seq: int, flown: set[int]
) -> None:
    """What a vehicle sent to an item may report: the item, and what it passes up to the next to be flown."""
    assert flown_for(items, seq) == flown


def test_set_current_takes_the_numbers_that_mean_yes() -> None:
    """Sent to a DO item, the report of the waypoint behind it is a yes, and that of another one is none."""
    machine = SetCurrentMachine(4, 1, 1, answers=frozenset({4, 5}))
    machine.start(0.0)
    machine.receive(from_vehicle("MISSION_CURRENT", seq=6), 0.1)
    assert (machine.outcome, machine.reported) == (None, {6})
    machine.receive(from_vehicle("MISSION_CURRENT", seq=5), 0.2)
    assert machine.outcome == Accepted()
