"""What a driver has under way: a machine, and whoever waits for its outcome."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Generic, TypeVar

from mavlink.errors import CodecError
from mavlink.transfer.machine import Machine, Progress

End = TypeVar("End")


class Job(Generic[End]):
    """A machine under way and who waits for it; ``unheard``: it goes on where the vehicle falls silent."""

    def __init__(
        self, machine: Machine[End], progress: Callable[[Progress], None] | None, unheard: bool = False
    ) -> None:
        self.machine = machine
        self.unheard = unheard
        self.done: asyncio.Future[End] = asyncio.get_running_loop().create_future()
        self._progress = progress
        self._reported: Progress | None = None

    def report(self) -> None:
        """Tell of progress made and of the end."""
        if self._progress is not None:
            progress = self.machine.progress
            if progress != self._reported:
                self._reported = progress
                self._progress(progress)
        if self.machine.outcome is not None:
            self.finish(self.machine.outcome)

    def finish(self, outcome: End) -> None:
        """Give the waiter its answer."""
        if not self.done.done():
            self.done.set_result(outcome)

    def fail(self, error: CodecError) -> None:
        """Give the waiter the reason why its messages cannot be sent."""
        if not self.done.done():
            self.done.set_exception(error)
