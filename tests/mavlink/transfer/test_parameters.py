"""Reading parameters: by name and all, with losses, unknown names and both encodings."""

from __future__ import annotations

import math
import struct
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.codec import Codec
from mavlink.messages import Message
from mavlink.transfer.outcome import Accepted, Unknown
from mavlink.transfer.parameters import ParameterListMachine, ParametersMachine

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
    """Every name asked for is read, each asked for once, and none beside."""
    names = [f"PARAM_{number:03d}" for number in range(0, 60, 2)]
    holder = Holder()
    machine = ParametersMachine(names, 1, 1)
    run(machine, holder)
    assert machine.outcome == Accepted()
    assert {name: p.value for name, p in machine.values.items()} == {name: HELD[name] for name in names}
    assert (holder.asked, machine.missing) == (len(names), ())


def test_unknown_names_are_missing_not_awaited_for_ever() -> None:
    """Names the vehicle does not know end as missing after the retries; the others are read."""
    machine = ParametersMachine(["PARAM_001", "NO_SUCH", "NOR_THIS"], 1, 1)
    assert run(machine, Holder()) < 10.0
    assert machine.outcome == Accepted()
    assert set(machine.values) == {"PARAM_001"}
    assert set(machine.missing) == {"NO_SUCH", "NOR_THIS"}


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
