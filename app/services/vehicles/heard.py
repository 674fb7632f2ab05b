"""What a vehicle's link tells of it."""

from __future__ import annotations

from app.services.errors import LinkError
from app.services.vehicles.connection import Connection
from mavlink.state.telemetry import VehicleState
from mavlink.station.client import VehicleClient


class Heard:
    """A vehicle as far as its link goes."""

    name: str
    _connection: Connection | None

    @property
    def state(self) -> VehicleState:
        """All that is known of it now."""
        return VehicleState() if self._connection is None else self._connection.client.state

    @property
    def client(self) -> VehicleClient:
        """The link's client; raises LinkError while there is none."""
        if self._connection is None:
            raise LinkError(f"{self.name} has no link")
        return self._connection.client

    def age_s(self, moment_s: float | None) -> float | None:
        """How long ago a moment in the link's clock was; None for none."""
        if moment_s is None or self._connection is None:
            return None
        return max(0.0, self._connection.client.now_s - moment_s)

    @property
    def link_quality(self) -> float | None:
        """The share of its frames that arrive; None where too little was heard to tell."""
        return None if self._connection is None else self._connection.client.link_quality
