"""Replacing some items of a mission in their places (MISSION_WRITE_PARTIAL_LIST).

The vehicle keeps all other items: a waypoint far ahead can be moved in flight without the list being cut and
written anew. ArduPilot does it as it does an upload, item by item into its store, so a lost one leaves some
items new and some old, and only the read-back tells which. PX4 ignores the message.

Source: https://mavlink.io/en/services/mission.html; ArduPilot ``GCS_MAVLink/MissionItemProtocol.cpp``, which
takes the range when both of its ends are at most the number of items held, and else answers ERROR.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from mavlink.transfer.machine import DEFAULT_SETTINGS, TransferSettings
from mavlink.transfer.upload import UploadMachine
from mavlink.wire.items import MissionItem, MissionResult, MissionType
from mavlink.wire.messages import Message


class PartialUpdateMachine(UploadMachine):
    """One partial update: an upload that begins in the middle.

    Parameters
    ----------
    items
        To take the places of those with their numbers; numbered without a gap, the first one above 0, since
        item 0 of a mission is ArduPilot's home.

    Raises
    ------
    ValueError
        No items, a gap, the home row, or numbers that the message cannot carry.

    Notes
    -----
    A vehicle that is receiving already may answer DENIED, as it does to a repeated announcement of ours while
    it goes on asking, so DENIED is a refusal only when no request follows.
    """

    #: Indices are int16 in this message alone.
    most: ClassVar[int] = 0x8000
    _complaints: ClassVar[frozenset[int]] = frozenset({MissionResult.INVALID_SEQUENCE, MissionResult.DENIED})

    def __init__(
        self,
        items: Sequence[MissionItem],
        target_system: int,
        target_component: int,
        settings: TransferSettings = DEFAULT_SETTINGS,
    ) -> None:
        if not items:
            raise ValueError("a partial update of no items")
        if items[0].seq < 1:
            raise ValueError("item 0 is home and cannot be replaced: begin with item 1")
        super().__init__(
            items, MissionType.MISSION, target_system, target_component, settings, first=items[0].seq
        )

    def _announcement(self) -> Message:
        return self._typed(
            "MISSION_WRITE_PARTIAL_LIST", start_index=self.items[0].seq, end_index=self.items[-1].seq
        )
