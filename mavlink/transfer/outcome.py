"""How a transfer ended: accepted, refused or unknown; never a guess.

Source: MAVLink ``common.xml``, MAV_MISSION_RESULT.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from mavlink.wire.items import MissionResult

MEANING: Final[dict[int, str]] = {
    MissionResult.ACCEPTED: "accepted",
    MissionResult.ERROR: "the vehicle reports an error without a reason",
    MissionResult.UNSUPPORTED_FRAME: "the coordinate frame is not supported",
    MissionResult.UNSUPPORTED: "the command is not supported",
    MissionResult.NO_SPACE: "more items than the vehicle can store; ArduPilot says so of any while it starts",
    MissionResult.INVALID: "a parameter has an invalid value",
    MissionResult.INVALID_PARAM1: "param1 has an invalid value",
    MissionResult.INVALID_PARAM2: "param2 has an invalid value",
    MissionResult.INVALID_PARAM3: "param3 has an invalid value",
    MissionResult.INVALID_PARAM4: "param4 has an invalid value",
    MissionResult.INVALID_PARAM5_X: "x (param5, latitude) has an invalid value",
    MissionResult.INVALID_PARAM6_Y: "y (param6, longitude) has an invalid value",
    MissionResult.INVALID_PARAM7: "z (param7, altitude) has an invalid value",
    MissionResult.INVALID_SEQUENCE: "an item arrived out of sequence",
    MissionResult.DENIED: "the vehicle takes no mission commands from this sender now",
    MissionResult.OPERATION_CANCELLED: "the vehicle cancelled the operation",
}

UnknownReason = Literal[
    "timeout",
    "lost-acknowledgement",
    "early-acceptance",
    "error-at-end",
    "cancelled",
    "link-lost",
    "not-read-back",
]

_UNKNOWN_WORDS: Final[dict[UnknownReason, str]] = {
    "timeout": "the vehicle stopped answering",
    "lost-acknowledgement": "every item was asked for, but the final acknowledgement never came",
    "early-acceptance": "the vehicle acknowledged before it had asked for every item",
    "error-at-end": "it reported an error after the last item, which ArduPilot also does for a duplicate",
    "cancelled": "cancelled before the vehicle answered",
    "link-lost": "the vehicle vanished",
    "not-read-back": "acknowledged, but it could not be read back",
}


@dataclass(frozen=True, slots=True)
class Accepted:
    """The vehicle acknowledged; reading back shows what it really holds."""

    kind: Literal["accepted"] = "accepted"

    def __str__(self) -> str:
        return "accepted"


@dataclass(frozen=True, slots=True)
class Refused:
    """The vehicle said no.

    Parameters
    ----------
    result
        MAV_MISSION_RESULT as received; may be a number later versions of the protocol define.
    seq
        The item last asked for, which the vehicle was judging; None before any was asked for.
    """

    result: int
    seq: int | None = None
    kind: Literal["refused"] = "refused"

    @property
    def code(self) -> str:
        """The name of the result, e.g. ``INVALID_PARAM2``."""
        return (
            MissionResult(self.result).name if self.result in MEANING else f"MAV_MISSION_RESULT {self.result}"
        )

    @property
    def meaning(self) -> str:
        """The result in words."""
        return MEANING.get(self.result, "a result this protocol version does not define")

    def __str__(self) -> str:
        where = "" if self.seq is None else f" at item {self.seq}"
        return f"refused{where}: {self.meaning} ({self.code})"


#: What the vehicle's id of the list (MISSION_CURRENT) did since the upload began.
Sign = Literal["changed", "unchanged"]

_SIGN_WORDS: Final[dict[Sign, str]] = {
    "changed": "; its id has changed since, so it seems to hold a new list",
    "unchanged": "; its id has not changed, so it seems to hold the list it held before",
}


@dataclass(frozen=True, slots=True)
class Unknown:
    """Nobody on this side can tell what the vehicle holds; reading back will.

    Parameters
    ----------
    sign
        A first sign, from vehicles that number their lists; it decides nothing.
    """

    reason: UnknownReason
    seq: int | None = None
    kind: Literal["unknown"] = "unknown"
    sign: Sign | None = None

    @property
    def meaning(self) -> str:
        """The reason in words."""
        return _UNKNOWN_WORDS[self.reason] + ("" if self.sign is None else _SIGN_WORDS[self.sign])

    def __str__(self) -> str:
        where = "" if self.seq is None else f" at item {self.seq}"
        return f"unknown{where}: {self.meaning} ({self.reason})"


Outcome = Accepted | Refused | Unknown
