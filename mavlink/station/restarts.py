"""Whether the vehicle has started anew: what it held may be gone, and what it was asked for it has forgotten.

Source: MAVLink ``common.xml`` (``time_boot_ms``; MAV_STATE_BOOT).
"""

from __future__ import annotations

from typing import Final

from mavlink.state.telemetry import VehicleState
from mavlink.wire.messages import Message

#: A frame overtaken by others is no older than this.
_OVERTAKEN_S: Final = 1.5
#: So many frames running tell the time of a new start: one alone was held up on its way.
_RUNNING: Final = 2


class Restarts:
    """Watches the vehicle's time since boot, which never goes back but for a start."""

    def __init__(self) -> None:
        self._time_s: float | None = None
        self._earlier = 0

    def noticed(self, before: VehicleState, after: VehicleState, message: Message) -> bool:
        """Whether this message shows that the vehicle has started since the last one."""
        if before.connected and after.booting and not before.booting:
            self._time_s = None
            return True
        milliseconds = message.fields.get("time_boot_ms")
        if not isinstance(milliseconds, int):
            return False
        time_s = milliseconds / 1000.0
        if self._time_s is None or time_s > self._time_s - _OVERTAKEN_S:
            self._time_s = time_s if self._time_s is None else max(time_s, self._time_s)
            self._earlier = 0
            return False
        self._earlier += 1
        if self._earlier < _RUNNING:
            return False
        self._time_s, self._earlier = time_s, 0
        return True
