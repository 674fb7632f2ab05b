"""The command machine: every MAV_RESULT, repetitions, progress."""

from __future__ import annotations

import pytest

from mavlink.transfer.command import CommandMachine, CommandOutcome, CommandResult
from mavlink.wire.items import Command
from mavlink.wire.messages import Message


def answer(result: int, command: int = Command.COMPONENT_ARM_DISARM, progress: int = 0) -> Message:
    fields = {"command": command, "result": result, "progress": progress, "result_param2": 7}
    return Message("COMMAND_ACK", fields, 1, 1)


def begun() -> CommandMachine:
    machine = CommandMachine(Command.COMPONENT_ARM_DISARM, (1.0,), 1, 1)
    (sent,) = machine.start(0.0)
    assert (sent.integer("command"), sent.number("param1"), sent.integer("confirmation")) == (400, 1.0, 0)
    return machine


@pytest.mark.parametrize("result", [*set(CommandResult) - {CommandResult.IN_PROGRESS}, 77])
def test_every_result_is_its_outcome(result: int) -> None:
    """Each MAV_RESULT ends the command with its own code; ACCEPTED alone counts as such."""
    machine = begun()
    machine.receive(answer(CommandResult.ACCEPTED, command=300), 0.1)
    assert machine.outcome is None
    machine.receive(answer(result), 0.1)
    assert machine.outcome == CommandOutcome(400, result, 7)
    assert CommandOutcome(400, result, 7).accepted == (result == 0)


def test_a_command_is_repeated_with_rising_confirmation() -> None:
    """The vehicle can tell a repetition from a second command."""
    machine = begun()
    confirmations = []
    while machine.outcome is None:
        confirmations += [sent.integer("confirmation") for sent in machine.tick(machine.deadline_s)]
    assert confirmations == [1, 2, 3, 4, 5]
    assert machine.outcome == CommandOutcome(400, None)
    assert "unknown" in str(machine.outcome)


def test_in_progress_prolongs_and_is_not_repeated() -> None:
    """A command at work must not be started anew."""
    machine = begun()
    machine.receive(answer(CommandResult.IN_PROGRESS, progress=40), 1.0)
    assert machine.percent == 40
    assert machine.deadline_s == pytest.approx(9.0)
    assert machine.tick(9.0) == []
    assert machine.outcome == CommandOutcome(400, None)
