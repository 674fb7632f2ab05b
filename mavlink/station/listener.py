"""Whoever listens to a vehicle beside the station itself."""

from __future__ import annotations

from typing import Protocol

from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message


class Listener(Protocol):
    """Takes the vehicle's messages: a recorder, a server of terrain."""

    def take(self, message: Message, state: VehicleState) -> None:
        """One message, and the state behind it."""
