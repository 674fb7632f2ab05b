"""A MAVLink message as a plain value: what the machines, the simulated aircraft and telemetry speak.

Only ``codec`` turns it into bytes and back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

Value = int | float | str | bytes | tuple[int, ...] | tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Message:
    """A message and its sender.

    Parameters
    ----------
    name
        As in the message definitions, e.g. ``"MISSION_COUNT"``.
    fields
        Field names and values in wire units.
    system_id, component_id
        The sender; 0 on messages that have not been sent yet.
    sequence
        The sender's count of its frames, 0 to 255; None on messages that did not come in a frame. Messages
        that say the same are equal, whichever frame each came in.
    """

    name: str
    fields: Mapping[str, Value] = field(default_factory=dict)
    system_id: int = 0
    component_id: int = 0
    sequence: int | None = field(default=None, compare=False)

    def integer(self, name: str) -> int:
        """A field as an int."""
        value = self.fields[name]
        if isinstance(value, (int, float)):
            return int(value)
        raise TypeError(f"{self.name}.{name} is {type(value).__name__}, not a number")

    def number(self, name: str) -> float:
        """A field as a float."""
        value = self.fields[name]
        if isinstance(value, (int, float)):
            return float(value)
        raise TypeError(f"{self.name}.{name} is {type(value).__name__}, not a number")

    def text(self, name: str) -> str:
        """A field as text."""
        value = self.fields[name]
        if isinstance(value, str):
            return value
        raise TypeError(f"{self.name}.{name} is {type(value).__name__}, not text")
