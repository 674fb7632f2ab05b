"""What a vehicle's ids of its lists (opaque ids) tell: first signs, never the last word.

A vehicle that numbers its lists gives the id of a new one in the MISSION_ACK of the upload and in the
MISSION_COUNT of a download, and the ids of all three with every MISSION_CURRENT; 0 means that it does not, or
holds none. PX4 takes a checksum of the items as they were sent.

Source: https://mavlink.io/en/services/mission.html#detecting-mission-plan-changes
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from mavlink.state.telemetry import KEPT_TEXTS, StatusText, VehicleState
from mavlink.transfer.outcome import Accepted, Outcome, Unknown
from mavlink.wire.items import MissionType
from mavlink.wire.messages import Message

# A report sent before an upload was over may overtake its acknowledgement; a second one does not.
_REPORTS: Final = 2
_WARNING: Final = 4
_NAMES: Final = {
    MissionType.MISSION: "mission",
    MissionType.FENCE: "fence",
    MissionType.RALLY: "list of rally points",
}


def list_id(state: VehicleState, kind: MissionType) -> int | None:
    """The id of a list as last reported; None where there is none."""
    return {
        MissionType.MISSION: state.mission_id,
        MissionType.FENCE: state.fence_id,
        MissionType.RALLY: state.rally_points_id,
    }[kind]


class ListIds:
    """Compares the ids reported with those of the lists sent from here.

    Attributes
    ----------
    replaced
        Lists of which the vehicle says that they are not those sent from here any more.
    """

    def __init__(self) -> None:
        self.replaced: frozenset[MissionType] = frozenset()
        self._meant: dict[MissionType, int] = {}
        self._seen: set[MissionType] = set()
        self._strange: dict[MissionType, int] = {}
        self._before: dict[MissionType, int | None] = {}

    def sending(self, kind: MissionType, state: VehicleState) -> None:
        """An upload or a clearing begins: what was known of the list no longer counts."""
        self._before[kind] = list_id(state, kind)
        self._expect(kind, None)

    def sent(
        self, kind: MissionType, outcome: Outcome, opaque_id: int | None, state: VehicleState
    ) -> Outcome:
        """An upload is over; the outcome, with a first sign where it is unknown."""
        if isinstance(outcome, Accepted):
            self._expect(kind, opaque_id)
        before, now = self._before.pop(kind, None), list_id(state, kind)
        if isinstance(outcome, Unknown) and not before == now is None:
            return replace(outcome, sign="unchanged" if now == before else "changed")
        return outcome

    def meant(self, kind: MissionType) -> int | None:
        """The id of the list sent from here; None where the vehicle gave it none."""
        return self._meant.get(kind)

    def read(self, kind: MissionType, opaque_id: int | None) -> None:
        """The list read back under this id is the one that was meant."""
        self._expect(kind, opaque_id)

    def watched(self, state: VehicleState, message: Message, now_s: float) -> VehicleState:
        """The state after a message, with a warning added once a list turns out to be another one."""
        if message.name != "MISSION_CURRENT":
            return state
        for kind, meant in self._meant.items():
            now = list_id(state, kind)
            if now == meant:
                self._seen.add(kind)
                self._strange[kind] = 0
                self.replaced -= {kind}
            elif now is not None or kind in self._seen:
                self._strange[kind] = self._strange.get(kind, 0) + 1
                if self._strange[kind] == _REPORTS:
                    self.replaced |= {kind}
                    entry = StatusText(now_s, _WARNING, _warning(kind, meant, now))
                    state = replace(state, texts=(*state.texts[1 - KEPT_TEXTS :], entry))
        return state

    def _expect(self, kind: MissionType, opaque_id: int | None) -> None:
        self._meant.pop(kind, None)
        if opaque_id is not None:
            self._meant[kind] = opaque_id
        self._seen.discard(kind)
        self._strange[kind] = 0
        self.replaced -= {kind}


def _warning(kind: MissionType, meant: int, now: int | None) -> str:
    name = _NAMES[kind]
    if now is None:
        return f"the vehicle no longer holds the {name} uploaded from here: upload it anew"
    return (
        f"the vehicle holds another {name} than the one uploaded from here"
        f" (id {now:08x} instead of {meant:08x}): read it back, or upload anew"
    )
