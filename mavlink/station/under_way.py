"""What a driver has under way: one transfer, and commands that take turns by their number."""

from __future__ import annotations

import asyncio
import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

from mavlink.errors import CodecError
from mavlink.station.jobs import Job
from mavlink.transfer.command import CommandMachine, CommandOutcome
from mavlink.transfer.machine import Machine, Progress
from mavlink.transfer.outcome import Outcome, Unknown
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.messages import Message


class UnderWay:
    """The machines at work, and an upload that is over but may still be asked.

    Parameters
    ----------
    queue
        Called with what is to go out next, and for whom.
    wake
        Called when something was queued while nobody may be looking.
    """

    def __init__(
        self,
        clock: Callable[[], float],
        queue: Callable[[list[Message], Job[Any]], None],
        wake: Callable[[], None],
    ) -> None:
        self._clock = clock
        self._queue = queue
        self._wake = wake
        self._transfer: Job[Any] | None = None
        self._lingering: UploadMachine | None = None
        self._commands: dict[int, deque[Job[CommandOutcome]]] = {}

    @property
    def transferring(self) -> bool:
        """Whether a transfer is under way."""
        return self._transfer is not None

    @property
    def deadline_s(self) -> float:
        """When the first machine is due; infinite without any."""
        due_s = math.inf if self._transfer is None else self._transfer.machine.deadline_s
        for queue in self._commands.values():
            if queue and queue[0].machine.deadline_s < due_s:
                due_s = queue[0].machine.deadline_s
        return due_s

    @property
    def likely(self) -> Message | None:
        """What is likely to be sent next; None where nobody can tell."""
        return None if self._transfer is None else self._transfer.machine.likely

    async def transfer(
        self, machine: Machine[Outcome], progress: Callable[[Progress], None] | None
    ) -> Outcome:
        """Run a transfer to its end."""
        job = Job(machine, progress)
        self._transfer, self._lingering = job, None
        self._send(machine.start(self._clock()), job)
        try:
            return await job.done
        except (asyncio.CancelledError, CodecError):
            self._send(machine.cancel(self._clock()), job)
            raise
        finally:
            if self._transfer is job:
                self._transfer = None

    async def command(self, machine: CommandMachine, unheard: bool = False) -> CommandOutcome:
        """Run a command to its end; those of the same number take turns, as their answers look alike."""
        job = self.post(machine, unheard)
        try:
            return await job.done
        except (asyncio.CancelledError, CodecError):
            machine.cancel(self._clock())
            queue = self._commands.get(machine.command)
            if queue and queue[0] is job:
                self._next_command(machine.command)
            raise

    def post(self, machine: CommandMachine, unheard: bool = False) -> Job[CommandOutcome]:
        """Queue a command without waiting for it."""
        queue = self._commands.setdefault(machine.command, deque())
        job = Job(machine, None, unheard)
        queue.append(job)
        if len(queue) == 1:
            self._send(machine.start(self._clock()), job)
        return job

    def let_time_pass(self, now_s: float) -> None:
        """Let the machines that are due act."""
        for job in list(self._jobs()):
            if now_s >= job.machine.deadline_s:
                self._send(job.machine.tick(now_s), job)
                self._settle(job)

    def receive(self, message: Message, now_s: float) -> list[Message]:
        """Hand a message to the machines; gives back what an upload that is over still answers."""
        if self._transfer is not None:
            self._hand(self._transfer, message, now_s)
        for queue in list(self._commands.values()):
            if queue:
                self._hand(queue[0], message, now_s)
        return [] if self._lingering is None else self._lingering.receive(message, now_s)

    def _hand(self, job: Job[Any], message: Message, now_s: float) -> None:
        answers = job.machine.receive(message, now_s)
        if answers:
            self._queue(answers, job)
        self._settle(job)

    def abandon(self, *, silent: bool = False) -> None:
        """End everything as unknown: the vehicle is not there any more.

        Of one that has only fallen silent, commands that are sent unheard go on.
        """
        if self._transfer is not None:
            asked = self._transfer.machine.progress.done
            self._transfer.finish(Unknown("link-lost", asked or None))
            self._transfer = None
        self._lingering = None
        left: dict[int, deque[Job[CommandOutcome]]] = {}
        for number, queue in self._commands.items():
            staying = deque(job for job in queue if silent and job.unheard)
            for job in queue:
                if job not in staying:
                    job.finish(CommandOutcome(getattr(job.machine, "command", 0), None))
            if staying:
                left[number] = staying
                if staying[0] is not queue[0]:
                    self._send(staying[0].machine.start(self._clock()), staying[0])
        self._commands = left

    def _jobs(self) -> Iterator[Job[Any]]:
        if self._transfer is not None:
            yield self._transfer
        for queue in self._commands.values():
            if queue:
                yield queue[0]

    def _send(self, messages: list[Message], job: Job[Any]) -> None:
        self._queue(messages, job)
        self._wake()

    def _settle(self, job: Job[Any]) -> None:
        job.report()
        machine = job.machine
        if machine.outcome is None:
            return
        if job is self._transfer:
            self._transfer = None
            if isinstance(machine, UploadMachine):
                self._lingering = machine
        elif isinstance(machine, CommandMachine):
            self._next_command(machine.command)

    def _next_command(self, command: int) -> None:
        queue = self._commands[command]
        queue.popleft()
        while queue and queue[0].machine.outcome is not None:
            queue.popleft()  # cancelled while it waited
        if queue:
            self._send(queue[0].machine.start(self._clock()), queue[0])
