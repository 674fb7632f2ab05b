"""Messages and fields that pymavlink's dialects leave out, by their definitions.

Source: MAVLink ``common.xml`` (events interface, https://mavlink.io/en/services/events.html; ids of lists,
https://mavlink.io/en/services/mission.html). A message's fields are in the order of the wire: the largest
types first, as the checksum of the definition demands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, slots=True)
class Definition:
    """One message; fields are (type, name, array length or 0)."""

    message_id: int
    name: str
    layout: str
    fields: tuple[tuple[str, str, int], ...]

    @property
    def signature(self) -> bytes:
        """What the definition's checksum is taken of, array lengths as single bytes."""
        text = f"{self.name} ".encode()
        for kind, name, length in self.fields:
            text += f"{kind} {name} ".encode() + (bytes([length]) if length else b"")
        return text


EXTRA_MESSAGES: Final = (
    Definition(
        410,
        "EVENT",
        "<IIHBBB40B",
        (
            ("uint32_t", "id", 0),
            ("uint32_t", "event_time_boot_ms", 0),
            ("uint16_t", "sequence", 0),
            ("uint8_t", "destination_component", 0),
            ("uint8_t", "destination_system", 0),
            ("uint8_t", "log_levels", 0),
            ("uint8_t", "arguments", 40),
        ),
    ),
    Definition(
        411,
        "CURRENT_EVENT_SEQUENCE",
        "<HB",
        (("uint16_t", "sequence", 0), ("uint8_t", "flags", 0)),
    ),
    Definition(
        412,
        "REQUEST_EVENT",
        "<HHBB",
        (
            ("uint16_t", "first_sequence", 0),
            ("uint16_t", "last_sequence", 0),
            ("uint8_t", "target_system", 0),
            ("uint8_t", "target_component", 0),
        ),
    ),
    Definition(
        413,
        "RESPONSE_EVENT_ERROR",
        "<HHBBB",
        (
            ("uint16_t", "sequence", 0),
            ("uint16_t", "sequence_oldest_available", 0),
            ("uint8_t", "target_system", 0),
            ("uint8_t", "target_component", 0),
            ("uint8_t", "reason", 0),
        ),
    ),
)

#: Extension fields, which stand behind all others and are no part of the checksum: struct format and name.
EXTRA_FIELDS: Final[dict[str, tuple[tuple[str, str], ...]]] = {
    "MISSION_CURRENT": (("I", "mission_id"), ("I", "fence_id"), ("I", "rally_points_id")),
    "MISSION_COUNT": (("I", "opaque_id"),),
    "MISSION_ACK": (("I", "opaque_id"),),
}
