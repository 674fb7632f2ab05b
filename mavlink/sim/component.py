"""A MAVLink component of the simulated aircraft beside its autopilot: what all of them say of themselves."""

from __future__ import annotations

from collections.abc import Mapping

from mavlink.sim.dynamics import AircraftState
from mavlink.wire.messages import Message, Value

_NO_AUTOPILOT, _ACTIVE, _MAVLINK_VERSION = 8, 4, 3
_HEARTBEAT_S = 1.0


class Component:
    """Speaks under its own number.

    Parameters
    ----------
    kind
        MAV_TYPE.
    """

    def __init__(self, system_id: int, component_id: int, kind: int) -> None:
        self._system_id, self._component_id, self._kind = system_id, component_id, kind
        self._heartbeat_s = 0.0

    def heartbeats(self, state: AircraftState) -> list[Message]:
        """Its heartbeat, when due."""
        if state.time_s < self._heartbeat_s:
            return []
        self._heartbeat_s = state.time_s + _HEARTBEAT_S
        fields = {"type": self._kind, "autopilot": _NO_AUTOPILOT, "system_status": _ACTIVE}
        return [self.own("HEARTBEAT", {**fields, "mavlink_version": _MAVLINK_VERSION})]

    def acknowledgement(self, command: int, sender: tuple[int, int], result: int) -> Message:
        """COMMAND_ACK in its own name."""
        target = {"target_system": sender[0], "target_component": sender[1]}
        return self.own("COMMAND_ACK", {"command": command, "result": result, **target})

    def own(self, name: str, fields: Mapping[str, Value]) -> Message:
        """A message in its own name."""
        return Message(name, fields, self._system_id, self._component_id)
