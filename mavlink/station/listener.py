"""Whoever listens to a vehicle beside the station itself."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator
from typing import Protocol

from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message


class Listener(Protocol):
    """Takes the vehicle's messages: a recorder, a server of terrain."""

    def take(self, message: Message, state: VehicleState) -> None:
        """One message, and the state behind it."""


class Overheard:
    """The part of a driver that others may listen to.

    Attributes
    ----------
    state
        What is known of the vehicle.
    """

    state: VehicleState

    def __init__(self) -> None:
        self._watchers: set[asyncio.Event] = set()
        self._recorders: set[Listener] = set()

    @contextlib.contextmanager
    def watching(self) -> Iterator[asyncio.Event]:
        """An event that is set at every change of state, and at the end."""
        changed = asyncio.Event()
        self._watchers.add(changed)
        try:
            yield changed
        finally:
            self._watchers.discard(changed)

    def record(self, recorder: Listener) -> None:
        """Feed whoever takes the vehicle's messages from now on."""
        self._recorders.add(recorder)

    def stop_recording(self, recorder: Listener) -> None:
        """Stop feeding a recorder."""
        self._recorders.discard(recorder)

    def _tell(self, message: Message) -> None:
        """Hand on one of the vehicle's messages."""
        for recorder in self._recorders:
            recorder.take(message, self.state)
