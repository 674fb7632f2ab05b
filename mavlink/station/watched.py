"""What a driver knows of its vehicle, and who is told of it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator

from mavlink.state.telemetry import VehicleState
from mavlink.station.listener import Listener


class Watched:
    """The part of a driver that tells others."""

    def __init__(self) -> None:
        self.state = VehicleState()
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

    def _change(self, state: VehicleState) -> None:
        """Take over a state that may be the same."""
        if state is not self.state:
            self._set_state(state)

    def _set_state(self, state: VehicleState) -> None:
        self.state = state
        for changed in self._watchers:
            changed.set()
