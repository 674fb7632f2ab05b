"""What PX4 says in events: the only place where it explains why it will not fly a mission.

An event is a number and packed arguments (EVENT, message 410); its words live in metadata outside the
message. The number is a hash of the event's name, so the names of those that concern a mission are enough to
recognise them on any build, with no file fetched from the vehicle first. Others are left alone.

Source: https://mavlink.io/en/services/events.html; names and argument types as in PX4 v1.16.0.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import Final

from mavlink.wire.messages import Message

#: Of all events in flight, PX4's autopilot component.
_AUTOPILOT: Final = 1 << 24
_FNV_START: Final = 0x811C9DC5
_FNV_PRIME: Final = 0x01000193
#: MAV_SEVERITY ends at debug; levels above are for programs.
_LEAST_SEVERE: Final = 7
_SEQUENCES: Final = 1 << 16
#: More missing than this is a reboot, or was long ago.
_MOST_MISSING: Final = 20
_RESET: Final = 1
#: What ``EventOrder`` takes.
EVENT_MESSAGES: Final = frozenset({"EVENT", "CURRENT_EVENT_SEQUENCE", "RESPONSE_EVENT_ERROR"})


@dataclass(frozen=True, slots=True)
class KnownEvent:
    """An event: ``layout`` of its arguments (struct, little-endian), ``words`` to fill them into."""

    words: str
    layout: str = ""
    against_mission: bool = True


KNOWN_EVENTS: Final = {
    "navigator_mis_no_home_rel_alt": KnownEvent(
        "mission rejected: item {0} has a height over home, and home is not known yet", "h"
    ),
    "navigator_mis_unsup_cmd": KnownEvent("mission rejected: item {0} has the unsupported command {1}", "HH"),
    "navigator_mis_starts_w_landing": KnownEvent("mission rejected: it starts with a landing"),
    "navigator_mis_starts_w_landing2": KnownEvent("mission rejected: it starts with a landing"),
    "navigator_mis_takeoff_too_low": KnownEvent(
        "mission rejected: the take-off climbs too low, {0:.1f} m is not enough", "f"
    ),
    "navigator_mis_takeoff_not_first": KnownEvent("mission rejected: the take-off is not its first place"),
    "navigator_mis_approach_wp_below_land": KnownEvent(
        "mission rejected: the approach must start above the landing point"
    ),
    "navigator_mis_land_wp_inside_orbit_radius": KnownEvent(
        "mission rejected: the landing point lies inside the approach's circle"
    ),
    "navigator_mis_unsupported_landing_approach_wp": KnownEvent(
        "mission rejected: a landing can only follow a waypoint or a circle to an altitude"
    ),
    "navigator_mis_glide_slope_too_steep": KnownEvent(
        "mission rejected: the landing is steeper than the {0}.{1}° the vehicle is set to", "BB"
    ),
    "navigator_mis_correct_glide_slope": KnownEvent(
        "the approach must start {0} m high at most, or {1} m away at least", "II"
    ),
    "navigator_mis_multiple_land": KnownEvent("mission rejected: more than one start of a landing"),
    "navigator_mis_land_before_rtl": KnownEvent(
        "mission rejected: a return stands behind the landing's start"
    ),
    "navigator_mis_invalid_land": KnownEvent(
        "mission rejected: the landing's start is not followed by a landing"
    ),
    "navigator_mis_takeoff_missing": KnownEvent("mission rejected: a take-off is required"),
    "navigator_mis_land_missing": KnownEvent("mission rejected: a landing is required"),
    "navigator_mis_takeoff_or_land_missing": KnownEvent(
        "mission rejected: a take-off or a landing is required"
    ),
    "feasibility_mis_in_air_landing_req": KnownEvent("mission rejected: a landing is required"),
    "navigator_mis_add_land_or_rm_to": KnownEvent("mission rejected: a take-off without a landing"),
    "navigator_mis_add_to_or_rm_land": KnownEvent("mission rejected: a landing without a take-off"),
    "navigator_mis_first_wp_far": KnownEvent(
        "the first waypoint lies {0} m from home: the right mission?", "I"
    ),
    "navigator_mis_wp_gate_too_close": KnownEvent(
        "mission rejected: a waypoint and a gate lie {0:.3f} m apart, {1:.3f} m is the least", "ff"
    ),
    "navigator_mis_vtol_items": KnownEvent("mission rejected: VTOL items, and the vehicle is none"),
    "navigator_mis_no_pos_lock": KnownEvent("not ready for a mission yet: no position", "", False),
    "navigator_mis_geofence_no_home": KnownEvent("the fence needs a home position"),
    "navigator_mis_geofence_no_home2": KnownEvent("the fence needs a home position"),
    "navigator_mis_geofence_violation": KnownEvent("mission rejected: item {0} lies outside the fence", "h"),
    "navigator_geofence_invalid_against_home": KnownEvent(
        "the fence does not contain home and is not valid", "", False
    ),
    "navigator_geofence_invalid_against_cur_pos": KnownEvent(
        "the fence does not contain the vehicle and is not valid", "", False
    ),
    "mission_not_valid_refuse": KnownEvent("no valid mission: take-off refused", "", False),
    "mission_not_valid_loiter": KnownEvent("no valid mission: circling", "", False),
}


def event_id(name: str) -> int:
    """The number of one of PX4's events: 24 bits of its name's FNV-1a hash below the component's number."""
    value = _FNV_START
    for byte in name.encode():
        value = (value ^ byte) * _FNV_PRIME & 0xFFFFFFFF
    return value & 0xFFFFFF | _AUTOPILOT


_NAMES: Final = {event_id(name): name for name in KNOWN_EVENTS}


@dataclass(frozen=True, slots=True)
class Event:
    """A recognised event in words.

    Parameters
    ----------
    severity
        MAV_SEVERITY, 0 emergency to 7 debug.
    against_mission
        Whether the vehicle says with it that it will not fly the mission it holds.
    """

    name: str
    severity: int
    text: str
    against_mission: bool


def read_event(message: Message) -> Event | None:
    """An EVENT in words; None where it is meant for programs or is not one of those known here."""
    name = _NAMES.get(message.integer("id"))
    severity = message.integer("log_levels") & 0x0F
    arguments = message.fields["arguments"]
    if name is None or severity > _LEAST_SEVERE or not isinstance(arguments, tuple):
        return None
    known = KNOWN_EVENTS[name]
    values = struct.unpack_from(f"<{known.layout}", bytes(int(byte) for byte in arguments))
    return Event(name, severity, known.words.format(*values), known.against_mission)


class EventOrder:
    """Keeps count of a vehicle's events, so that one lost on the way is asked for again.

    Notes
    -----
    The vehicle tells the number of its latest event now and then (CURRENT_EVENT_SEQUENCE, 411), so the last
    one is missed too.
    """

    def __init__(self) -> None:
        self._latest: int | None = None
        self._missing: set[int] = set()

    @property
    def heard(self) -> bool:
        """Whether the vehicle speaks of events at all."""
        return self._latest is not None

    def take(self, message: Message) -> bool:
        """Whether an EVENT is new; the counts are kept from other messages too."""
        sequence = message.integer("sequence")
        if message.name == "RESPONSE_EVENT_ERROR":
            self._missing.discard(sequence)
            return False
        is_event = message.name == "EVENT"
        if not is_event and message.integer("flags") & _RESET:
            self._latest, self._missing = sequence, set()
            return False
        if self._latest is None:
            self._latest = sequence
            return is_event
        ahead = (sequence - self._latest) % _SEQUENCES
        if ahead == 0 or ahead >= _SEQUENCES // 2:
            new = is_event and sequence in self._missing
            self._missing.discard(sequence)
            return new
        passed = ahead - is_event
        if passed <= _MOST_MISSING:
            self._missing |= {(self._latest + step) % _SEQUENCES for step in range(1, passed + 1)}
        else:
            self._missing.clear()
        self._latest = sequence
        return is_event

    def requests(self, system_id: int, component_id: int) -> list[Message]:
        """REQUEST_EVENT for each missing one, until it comes or the vehicle has it no more."""
        return [
            Message(
                "REQUEST_EVENT",
                {
                    "target_system": system_id,
                    "target_component": component_id,
                    "first_sequence": sequence,
                    "last_sequence": sequence,
                },
            )
            for sequence in sorted(self._missing)
        ]
