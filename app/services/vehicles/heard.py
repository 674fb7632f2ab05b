"""What a vehicle's link tells of it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta

from app.services.errors import LinkError
from app.services.vehicles.connection import Connection
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient


@dataclass(frozen=True, slots=True)
class LastWord:
    """What was known when a link broke off, in that link's clock, which goes on with the machine's."""

    state: VehicleState
    now_s: float
    at_s: float


class Heard:
    """A vehicle as far as its link goes."""

    name: str
    link_failure: str | None
    lost_since: datetime | None
    _connection: Connection | None
    #: Of a vehicle whose link broke off, until it is heard on another: it may be in the air.
    _last_word: LastWord | None

    @property
    def state(self) -> VehicleState:
        """All that is known of it now."""
        state = VehicleState() if self._connection is None else self._connection.client.state
        last = self._last_word
        return state if last is None or state.heard_s is not None else _as_told(last.state, state)

    @property
    def client(self) -> VehicleClient:
        """The link's client; raises LinkError while there is none."""
        if self._connection is None:
            why = f": {self.link_failure}" if self.link_failure else ""
            raise LinkError(f"{self.name} has no link{why}")
        return self._connection.client

    def age_s(self, moment_s: float | None) -> float | None:
        """How long ago a moment in the clock of what was heard last was; None for none."""
        if moment_s is None:
            return None
        client = None if self._connection is None else self._connection.client
        last = self._last_word
        if last is not None and (client is None or client.state.heard_s is None):
            return max(0.0, last.now_s + time.monotonic() - last.at_s - moment_s)
        return None if client is None else max(0.0, client.now_s - moment_s)

    @property
    def link_quality(self) -> float | None:
        """The share of its frames that arrive; None where too little was heard to tell."""
        return None if self._connection is None else self._connection.client.link_quality

    def _broken_off(self, client: VehicleClient) -> None:
        """The link has failed: what was heard on it is kept, and it is lost since then."""
        if client.state.heard_s is None:
            return
        self._last_word = LastWord(client.state, client.now_s, time.monotonic())
        if self.lost_since is None:
            self.lost_since = datetime.now(UTC) - timedelta(seconds=client.silent_s)


def _as_told(last: VehicleState, now: VehicleState) -> VehicleState:
    """What was told last, with what the link now open says of who is there."""
    return replace(
        last,
        connected=now.connected,
        other_system=now.other_system,
        address=now.address,
        strangers=now.strangers,
        doubt=now.doubt,
        signing=now.signing,
    )
