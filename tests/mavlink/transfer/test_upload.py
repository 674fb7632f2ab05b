"""The upload machine against single messages: every answer a vehicle may give has one outcome."""

from __future__ import annotations

import math

import pytest

from mavlink.transfer.machine import Progress, TransferSettings
from mavlink.transfer.outcome import MEANING, Accepted, Refused, Unknown
from mavlink.transfer.upload import TRANSITIONS, State, UploadMachine
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.transfer.vehicle import from_vehicle, item_of, waypoints


def begun(count: int = 3) -> UploadMachine:
    machine = UploadMachine(waypoints(count), MissionType.MISSION, 1, 1)
    machine.start(0.0)
    return machine


def ask(
    machine: UploadMachine, seq: int, now_s: float = 0.1, name: str = "MISSION_REQUEST_INT"
) -> list[Message]:
    return machine.receive(from_vehicle(name, seq=seq), now_s)


def acknowledge(machine: UploadMachine, result: int, now_s: float = 0.2) -> None:
    assert machine.receive(from_vehicle("MISSION_ACK", type=result), now_s) == []


@pytest.mark.parametrize("name", ["MISSION_REQUEST", "MISSION_REQUEST_INT"])
def test_items_are_given_as_asked_and_accepted(name: str) -> None:
    """Both kinds of request draw MISSION_ITEM_INT, and the acknowledgement at the end accepts."""
    machine = UploadMachine(waypoints(3), MissionType.MISSION, 1, 1)
    (count,) = machine.start(0.0)
    assert (count.name, count.integer("count"), count.integer("target_system")) == ("MISSION_COUNT", 3, 1)
    for seq in range(3):
        (answer,) = ask(machine, seq, name=name)
        assert answer.name == "MISSION_ITEM_INT"
        assert item_of(answer) == waypoints(3)[seq]
        assert machine.progress == Progress(seq, 3)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()
    assert machine.progress == Progress(3, 3)
    assert machine.deadline_s == math.inf


REFUSING = [
    result
    for result in MissionResult
    if result not in (MissionResult.ACCEPTED, MissionResult.INVALID_SEQUENCE)
]


@pytest.mark.parametrize("result", [*REFUSING, 99])
def test_every_refusal_names_the_item_and_the_reason(result: int) -> None:
    """Each refusing MAV_MISSION_RESULT, one unknown to us included, ends as refused with its own words."""
    machine = begun()
    ask(machine, 0)
    ask(machine, 1)
    acknowledge(machine, result)
    assert machine.outcome == Refused(result, 1)
    assert MEANING.get(result, "does not define") in str(machine.outcome)
    assert "item 1" in str(machine.outcome)


@pytest.mark.parametrize("result", REFUSING)
def test_a_count_can_be_refused_before_any_item(result: int) -> None:
    """NO_SPACE and its like come before the first request and name no item."""
    machine = begun()
    acknowledge(machine, result)
    assert machine.outcome == Refused(result, None)


@pytest.mark.parametrize("result", [result for result in REFUSING if result != MissionResult.ERROR])
def test_the_whole_list_can_be_refused_at_the_end(result: int) -> None:
    """A refusal in the place of the last word is a refusal."""
    machine = begun(1)
    ask(machine, 0)
    acknowledge(machine, result)
    assert machine.outcome == Refused(result, 0)


def test_an_error_after_the_last_item_is_ambiguous() -> None:
    """ArduPilot says ERROR to a duplicate of an item it has stored, so the error alone proves nothing."""
    machine = begun(1)
    ask(machine, 0)
    acknowledge(machine, MissionResult.ERROR)
    assert machine.outcome == Unknown("error-at-end", 0)


def test_invalid_sequence_is_not_the_end_while_the_vehicle_goes_on() -> None:
    """ArduPilot complains of a duplicate and then asks for the next item."""
    machine = begun()
    ask(machine, 0)
    acknowledge(machine, MissionResult.INVALID_SEQUENCE)
    assert machine.outcome is None
    ask(machine, 1)
    ask(machine, 2)
    acknowledge(machine, MissionResult.INVALID_SEQUENCE)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()


def test_invalid_sequence_is_a_refusal_when_nothing_follows() -> None:
    """A complaint followed by silence, with items missing, was the last word."""
    machine = begun()
    ask(machine, 0)
    acknowledge(machine, MissionResult.INVALID_SEQUENCE)
    machine.tick(machine.deadline_s)
    assert machine.outcome == Refused(MissionResult.INVALID_SEQUENCE, 0)


def test_an_early_acceptance_is_never_an_acceptance() -> None:
    """ACCEPTED before every item was asked for ends as unknown, since the vehicle cannot hold the rest."""
    machine = begun()
    ask(machine, 0)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome is None
    machine.tick(machine.deadline_s)
    assert machine.outcome == Unknown("early-acceptance", 0)


def test_a_stale_acceptance_does_not_stop_an_upload() -> None:
    """A duplicate of an earlier upload's acknowledgement changes nothing when the vehicle goes on asking."""
    machine = begun(2)
    acknowledge(machine, MissionResult.ACCEPTED)
    ask(machine, 0)
    ask(machine, 1)
    assert machine.outcome is None
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()


def test_a_lost_final_acknowledgement_is_unknown() -> None:
    """All was asked for and nothing more came: stored or not, nobody here knows."""
    machine = begun(2)
    ask(machine, 0, 0.1)
    ask(machine, 1, 0.2)
    assert machine.deadline_s == pytest.approx(0.2 + machine.settings.acknowledgement_s)
    assert machine.tick(machine.deadline_s) == []
    assert machine.outcome == Unknown("lost-acknowledgement", 1)


def test_the_count_is_repeated_and_then_given_up() -> None:
    """1500 ms apart and five times again, as the protocol recommends."""
    machine = begun()
    times = []
    while machine.outcome is None:
        times.append(machine.deadline_s)
        machine.tick(machine.deadline_s)
    assert times == pytest.approx([1.5, 3.0, 4.5, 6.0, 7.5, 9.0])
    assert machine.outcome == Unknown("timeout", None)


def test_nothing_happens_before_the_deadline() -> None:
    """A tick too early neither repeats nor gives up."""
    machine = begun()
    assert machine.tick(1.49) == []
    assert machine.deadline_s == 1.5


def test_a_vehicle_that_falls_silent_ends_as_unknown() -> None:
    """Nothing is sent unasked, and after the silence the outcome is unknown, naming the item."""
    machine = begun()
    ask(machine, 0, 1.0)
    assert machine.deadline_s == pytest.approx(1.0 + machine.settings.silence_s)
    assert machine.tick(machine.deadline_s) == []
    assert machine.outcome == Unknown("timeout", 0)


def test_requests_in_any_order_and_repeated_are_answered_each() -> None:
    """Duplicates draw the same item again, and order is the vehicle's affair."""
    machine = begun()
    answers = [ask(machine, seq)[0].integer("seq") for seq in (0, 2, 2, 1, 0)]
    assert answers == [0, 2, 2, 1, 0]
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()


def test_the_same_item_over_and_over_is_given_up() -> None:
    """A vehicle that never takes an item does not hold the upload for ever."""
    machine = UploadMachine(waypoints(2), MissionType.MISSION, 1, 1, TransferSettings(most_repeats=5))
    machine.start(0.0)
    answered = sum(len(ask(machine, 0, 0.1 * turn)) for turn in range(20))
    assert answered == 5
    assert machine.outcome == Unknown("timeout", 0)


FOREIGN = [
    Message("MISSION_REQUEST_INT", {"seq": 0, "mission_type": 0}, 2, 1),
    Message("MISSION_REQUEST_INT", {"seq": 0, "mission_type": 0}, 1, 100),
    Message("MISSION_REQUEST_INT", {"seq": 0, "mission_type": 1}, 1, 1),
    Message("MISSION_REQUEST_INT", {"seq": 3, "mission_type": 0}, 1, 1),
    Message("MISSION_ACK", {"type": 14, "mission_type": 0}, 2, 1),
    Message("MISSION_ACK", {"type": 14, "mission_type": 2}, 1, 1),
    Message("HEARTBEAT", {}, 1, 1),
]


@pytest.mark.parametrize("message", FOREIGN, ids=lambda message: f"{message.name}-{message.system_id}")
def test_other_senders_types_and_numbers_change_nothing(message: Message) -> None:
    """What another system, component or list says, or what is past the end, neither answers nor prolongs."""
    machine = begun()
    assert machine.receive(message, 1.0) == []
    assert (machine.state, machine.outcome, machine.deadline_s) == (State.ANNOUNCED, None, 1.5)


def test_an_empty_list_is_accepted_without_a_request() -> None:
    """A count of 0 has nothing to ask for."""
    machine = begun(0)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()


def test_cancelling_tells_the_vehicle_and_is_unknown() -> None:
    """The vehicle gets OPERATION_CANCELLED; what it kept is for the read-back to say."""
    machine = begun()
    ask(machine, 0)
    (word,) = machine.cancel(0.5)
    assert (word.name, word.integer("type")) == ("MISSION_ACK", MissionResult.OPERATION_CANCELLED)
    assert machine.outcome == Unknown("cancelled", 0)
    assert ask(machine, 1) == []
    assert machine.cancel(0.6) == []


def test_a_late_request_after_acceptance_is_still_answered() -> None:
    """A repeated count makes the vehicle start over; leaving it alone would leave it with half a list."""
    machine = begun(1)
    ask(machine, 0)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert [answer.integer("seq") for answer in ask(machine, 0)] == [0]
    acknowledge(machine, MissionResult.ERROR)
    assert machine.outcome == Accepted()


@pytest.mark.parametrize(
    ("items", "mission_type"),
    [
        ((MissionItem(1, 3, 16),), MissionType.MISSION),
        ((MissionItem(0, 3, 16),), MissionType.FENCE),
        ((MissionItem(0, 3, 5003, math.nan, mission_type=MissionType.FENCE),), MissionType.FENCE),
    ],
    ids=["misnumbered", "mistyped", "nan-radius"],
)
def test_lists_that_must_not_be_sent_are_refused_here(
    items: tuple[MissionItem, ...], mission_type: MissionType
) -> None:
    """Wrong numbers, wrong types, and the NaN radius that crashes autopilots never reach the air."""
    with pytest.raises(ValueError, match="item 0"):
        UploadMachine(items, mission_type, 1, 1)


def test_the_table_leads_from_every_state_to_an_end() -> None:
    """Every state is reached from the start, and an end from every state."""
    ends = {State.ACCEPTED, State.REFUSED, State.UNKNOWN}
    reached = {State.IDLE}
    for _ in State:
        reached |= {following for (state, _), following in TRANSITIONS.items() if state in reached}
    assert reached == set(State)
    for state in set(State) - ends - {State.IDLE}:
        assert ends & {following for (before, _), following in TRANSITIONS.items() if before is state} >= {
            State.REFUSED,
            State.UNKNOWN,
        }
