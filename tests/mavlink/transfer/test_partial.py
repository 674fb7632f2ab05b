"""Partial updates: the machine against single messages, and against a vehicle in bad weather."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.transfer.machine import Progress
from mavlink.transfer.outcome import Accepted, Refused, Unknown
from mavlink.transfer.partial import PartialUpdateMachine
from mavlink.transfer.upload import State
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.transfer.air import Air, Weather
from tests.mavlink.transfer.test_lossy import weathers
from tests.mavlink.transfer.vehicle import StubVehicle, from_vehicle, item_of, waypoints


def moved(first: int, last: int) -> tuple[MissionItem, ...]:
    """New items for the places first to last."""
    return tuple(replace(item, z=7.0) for item in waypoints(last + 1)[first:])


def begun(first: int = 3, last: int = 5) -> PartialUpdateMachine:
    machine = PartialUpdateMachine(moved(first, last), 1, 1)
    machine.start(0.0)
    return machine


def ask(machine: PartialUpdateMachine, seq: int, now_s: float = 0.1) -> list[Message]:
    return machine.receive(from_vehicle("MISSION_REQUEST", seq=seq), now_s)


def acknowledge(machine: PartialUpdateMachine, result: int, now_s: float = 0.2) -> None:
    assert machine.receive(from_vehicle("MISSION_ACK", type=result), now_s) == []


def test_the_range_is_announced_and_given() -> None:
    """Both ends of the range are named, the items of the range are given, no other is."""
    machine = PartialUpdateMachine(moved(3, 5), 1, 1)
    (announcement,) = machine.start(0.0)
    assert announcement.name == "MISSION_WRITE_PARTIAL_LIST"
    assert [announcement.integer(name) for name in ("start_index", "end_index")] == [3, 5]
    assert ask(machine, 2) == ask(machine, 6) == []
    for seq in (3, 4, 5):
        (answer,) = ask(machine, seq)
        assert item_of(answer) == moved(3, 5)[seq - 3]
        assert machine.progress == Progress(seq - 3, 3)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()
    assert machine.progress == Progress(3, 3)


def test_the_announcement_is_repeated_and_then_given_up() -> None:
    """Six announcements 1.5 s apart, as a vehicle deaf to them (PX4) draws; then unknown."""
    machine = begun()
    times = []
    while machine.outcome is None:
        times.append(machine.deadline_s)
        machine.tick(machine.deadline_s)
    assert times == pytest.approx([1.5, 3.0, 4.5, 6.0, 7.5, 9.0])
    assert machine.outcome == Unknown("timeout", None)


def test_a_denial_is_not_the_end_while_the_vehicle_asks() -> None:
    """A repeated announcement draws DENIED from a vehicle that is receiving already: from us."""
    machine = begun()
    acknowledge(machine, MissionResult.DENIED)
    assert machine.outcome is None
    ask(machine, 3)
    acknowledge(machine, MissionResult.DENIED)
    ask(machine, 4)
    ask(machine, 5)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome == Accepted()


def test_a_denial_followed_by_silence_is_a_refusal() -> None:
    """Another station is uploading: no request follows, however often it is announced."""
    machine = begun()
    while machine.outcome is None:
        acknowledge(machine, MissionResult.DENIED)
        machine.tick(machine.deadline_s)
    assert machine.outcome == Refused(MissionResult.DENIED, None)
    assert machine.state is State.REFUSED


@pytest.mark.parametrize("result", [result for result in MissionResult if result not in (0, 13, 14)])
def test_every_other_refusal_ends_it(result: MissionResult) -> None:
    """Before any item: the range; behind one: that item."""
    machine = begun()
    acknowledge(machine, result)
    assert machine.outcome == Refused(result, None)
    machine = begun()
    ask(machine, 3)
    acknowledge(machine, result)
    assert machine.outcome == Refused(result, 3)


def test_an_acceptance_before_the_last_item_is_none() -> None:
    """Item 5 was never asked for, so it cannot be held."""
    machine = begun()
    ask(machine, 3)
    acknowledge(machine, MissionResult.ACCEPTED)
    assert machine.outcome is None
    machine.tick(machine.deadline_s)
    assert machine.outcome == Unknown("early-acceptance", 3)


def test_cancelling_tells_the_vehicle() -> None:
    """It is unknown what it has taken; it need not wait for more."""
    machine = begun()
    ask(machine, 3)
    (word,) = machine.cancel(0.3)
    assert (word.name, word.integer("type")) == ("MISSION_ACK", MissionResult.OPERATION_CANCELLED)
    assert machine.outcome == Unknown("cancelled", 3)


@pytest.mark.parametrize(
    ("items", "message"),
    [
        ((), "no items"),
        (waypoints(2), "item 0 is home"),
        ((*moved(3, 4), *moved(6, 6)), "item 5 is numbered 6"),
        (tuple(replace(item, mission_type=MissionType.FENCE) for item in moved(1, 2)), "of type FENCE"),
        ((replace(waypoints(1)[0], seq=0x8000),), "counts to 32768"),
    ],
    ids=["none", "home", "gap", "fence", "too-far"],
)
def test_what_cannot_be_sent_is_refused(items: tuple[MissionItem, ...], message: str) -> None:
    """Home, gaps, other lists and numbers over 32767 end as ValueError before anything is sent."""
    with pytest.raises(ValueError, match=message):
        PartialUpdateMachine(items, 1, 1)


def test_a_range_the_vehicle_does_not_hold_is_refused() -> None:
    """ArduPilot answers ERROR, and keeps its mission."""
    vehicle = StubVehicle()
    vehicle.held[0] = waypoints(4)
    machine = begun(3, 5)
    Air(machine, vehicle).run()
    assert machine.outcome == Refused(MissionResult.ERROR, None)
    assert vehicle.held[0] == waypoints(4)


@settings(max_examples=300, deadline=None)
@given(weathers, st.integers(1, 8), st.integers(0, 4))
def test_a_partial_update_never_claims_what_is_not_so(weather: Weather, first: int, more: int) -> None:
    """Accepted: the new items are in their places and the old ones elsewhere, whatever is lost."""
    vehicle = StubVehicle()
    vehicle.held[0] = waypoints(14)
    machine = PartialUpdateMachine(moved(first, first + more), 1, 1)
    Air(machine, vehicle, weather).run()
    meant = (*waypoints(14)[:first], *moved(first, first + more), *waypoints(14)[first + more + 1 :])
    match machine.outcome:
        case Accepted():
            assert vehicle.held[0] == meant
        case Refused(result=result):
            assert result in vehicle.said
            assert weather != Weather(seed=weather.seed)
        case Unknown():
            assert weather != Weather(seed=weather.seed)
        case outcome:
            pytest.fail(f"no outcome: {outcome}")
    assert len(vehicle.held[0]) == 14
    for seq, item in enumerate(vehicle.held[0]):
        assert item in (meant[seq], waypoints(14)[seq])
