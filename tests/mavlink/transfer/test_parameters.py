"""Reading parameters: by name and all, with losses, unknown names and both encodings."""

from __future__ import annotations

import math
import struct
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.transfer.machine import TransferSettings
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.transfer.parameters import ParameterListMachine, ParametersMachine
from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message

HELD = {f"PARAM_{number:03d}": number / 4.0 for number in range(60)}


class Holder:
    """A vehicle that holds ``HELD``, silent about other names, behind a radio that loses messages."""

    def __init__(self, loss: float = 0.0, seed: int = 0) -> None:
        self.asked = 0
        self._loss = loss
        self._random = Random(seed)

    def answers(self, message: Message) -> list[Message]:
        """What comes back of the answers to one message."""
        self.asked += 1
        if self._lost():
            return []
        names = list(HELD)
        if message.name == "PARAM_REQUEST_LIST":
            indices = list(range(len(names)))
        else:
            index, name = message.integer("param_index"), message.text("param_id")
            indices = [index] if index >= 0 else [names.index(name)] if name in HELD else []
        values = [value_of(names[index], HELD[names[index]], index) for index in indices]
        return [value for value in values if not self._lost()]

    def _lost(self) -> bool:
        return self._random.random() < self._loss


def value_of(name: str, value: float, index: int = 0, kind: int = 9, sender: int = 1) -> Message:
    """A PARAM_VALUE."""
    fields = {"param_value": value, "param_type": kind, "param_count": len(HELD), "param_index": index}
    return Message("PARAM_VALUE", {"param_id": name, **fields}, sender, 1)


def run(machine: ParametersMachine | ParameterListMachine, holder: Holder) -> float:
    """Drive a machine to its end; the time it took."""
    now_s = 0.0
    outgoing = machine.start(now_s)
    while machine.outcome is None:
        incoming = [answer for message in outgoing for answer in holder.answers(message)]
        outgoing = []
        for message in incoming:
            now_s += 0.001
            outgoing += machine.receive(message, now_s)
        if not outgoing and machine.outcome is None:
            now_s = machine.deadline_s
            assert now_s < 1000.0, "it does not end"
            outgoing = machine.tick(now_s)
    assert machine.deadline_s == math.inf
    return now_s


def test_names_are_read_in_one_go() -> None:
    """Every name asked for is read, each asked for once, and one once more to mark the end."""
    names = [f"PARAM_{number:03d}" for number in range(0, 60, 2)]
    holder = Holder()
    machine = ParametersMachine(names, 1, 1)
    run(machine, holder)
    assert machine.outcome == Accepted()
    assert {name: p.value for name, p in machine.values.items()} == {name: HELD[name] for name in names}
    assert (holder.asked, machine.missing) == (len(names) + 1, ())


def test_unknown_names_are_missing_not_awaited_for_ever() -> None:
    """Names the vehicle does not know end as missing after the retries; the others are read."""
    machine = ParametersMachine(["PARAM_001", "NO_SUCH", "NOR_THIS"], 1, 1)
    assert run(machine, Holder()) < 10.0
    assert machine.outcome == Accepted()
    assert set(machine.values) == {"PARAM_001"}
    assert set(machine.missing) == {"NO_SUCH", "NOR_THIS"}


@pytest.mark.parametrize("place", [0, 7, 59])
def test_what_is_missing_is_known_without_waiting(place: int) -> None:
    """Names that stay silent among answered ones are asked for three times in all, and no time-out passes."""
    names = list(HELD)
    names[place:place] = ["NO_SUCH", "NOR_THIS"]
    machine = ParametersMachine(names, 1, 1, settings=TransferSettings(retries=2))
    asked: list[str] = []
    outgoing = machine.start(0.0)
    while outgoing:
        asked += [message.text("param_id") for message in outgoing]
        incoming = [answer for message in outgoing for answer in Holder().answers(message)]
        outgoing = [message for answer in incoming for message in machine.receive(answer, 0.0)]
    assert machine.outcome == Accepted()
    assert set(machine.missing) == {"NO_SUCH", "NOR_THIS"}
    assert machine.values.keys() == HELD.keys()
    assert (asked.count("NO_SUCH"), asked.count("NOR_THIS")) == (3, 3)
    assert len(asked) <= len(HELD) + 12


def test_a_late_answer_is_taken() -> None:
    """An answer that comes after its name was given up counts while the reading goes on."""
    machine = ParametersMachine(
        ["PARAM_001", "PARAM_002", "PARAM_003"], 1, 1, settings=TransferSettings(retries=0)
    )
    machine.start(0.0)
    machine.receive(value_of("PARAM_002", 2.0), 0.1)
    machine.receive(value_of("PARAM_001", 1.0), 0.2)
    machine.receive(value_of("PARAM_003", 3.0), 0.3)
    assert machine.outcome == Accepted()
    assert ({*machine.values}, machine.missing) == ({"PARAM_001", "PARAM_002", "PARAM_003"}, ())


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([0.05, 0.3]), st.integers(0, 10_000))
def test_names_end_read_or_missing_whatever_is_lost(loss: float, seed: int) -> None:
    """Every name is read with its value or told as missing; one the vehicle lacks is never read."""
    names = [*list(HELD)[::3], "NO_SUCH"]
    machine = ParametersMachine(names, 1, 1)
    run(machine, Holder(loss, seed))
    assert machine.outcome == Accepted()
    assert machine.values.keys() | set(machine.missing) == set(names)
    assert not machine.values.keys() & set(machine.missing)
    assert {name: p.value for name, p in machine.values.items()} == {
        name: HELD[name] for name in machine.values
    }
    assert len(machine.missing) <= (1 if loss == 0.05 else 5)


@pytest.mark.parametrize("machine", [ParametersMachine(["PARAM_001"], 1, 1), ParameterListMachine(1, 1)])
def test_a_silent_vehicle_is_unknown(machine: ParametersMachine | ParameterListMachine) -> None:
    """Nothing read is no list of missing names: nobody knows."""
    run(machine, Holder(loss=1.0))
    assert machine.outcome == Unknown("timeout")
    assert machine.values == {}


@settings(max_examples=60, deadline=None)
@given(st.sampled_from([0.05, 0.3, 0.6]), st.integers(0, 10_000))
def test_all_are_read_whatever_is_lost(loss: float, seed: int) -> None:
    """The list is complete when it is called accepted, and each value is the vehicle's."""
    machine = ParameterListMachine(1, 1)
    run(machine, Holder(loss, seed))
    if machine.outcome == Accepted():
        assert {name: p.value for name, p in machine.values.items()} == HELD
    else:
        assert loss >= 0.3


@pytest.mark.parametrize("number", [0, 1, -1, 2, 77, -32768, 2_000_000_000, -2_000_000_000])
def test_whole_numbers_in_the_bytes_of_a_float(number: int) -> None:
    """PX4's encoding survives the wire and comes out as the number meant."""
    (disguised,) = struct.unpack("<f", struct.pack("<i", number))
    sent = Codec(1, 1).pack(value_of("MIS_TKO_LAND_REQ", disguised, kind=6))
    machine = ParametersMachine(["MIS_TKO_LAND_REQ"], 1, 1, bytewise=True)
    machine.start(0.0)
    for message in Codec().feed(sent):
        machine.receive(message, 0.1)
    assert machine.values["MIS_TKO_LAND_REQ"].value == number


def test_values_of_other_vehicles_and_names_are_not_taken() -> None:
    """Another system's value, or one nobody asked for, changes nothing."""
    machine = ParametersMachine(["PARAM_001"], 1, 1)
    machine.start(0.0)
    machine.receive(value_of("PARAM_001", 1.0, sender=2), 0.1)
    machine.receive(value_of("PARAM_002", 1.0), 0.1)
    assert (machine.values, machine.outcome) == ({}, None)


@pytest.mark.parametrize("name", ["", "A_NAME_OF_MORE_THAN_16", "LÄNGE"])
def test_names_that_cannot_be(name: str) -> None:
    """What cannot be a parameter's name is not asked for."""
    with pytest.raises(ValueError, match="is no parameter"):
        ParametersMachine([name], 1, 1)
