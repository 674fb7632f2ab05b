"""Faults the simulated aircraft shows on request, to test what a ground station makes of them."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum


class Fault(StrEnum):
    """A named fault of the vehicle side.

    Each member's docstring says what a ground station sees.
    """

    NO_RESPONSE_TO_COUNT = "no_response_to_count"
    """MISSION_COUNT is never answered."""

    WRONG_SEQUENCE_REQUEST = "wrong_sequence_request"
    """After the first item the vehicle asks once for item 2, not 1, refuses it, then asks properly."""

    ERROR_ACK_AT_0 = "error_ack_at_0"
    """MISSION_COUNT is answered with MISSION_ACK ERROR."""

    ERROR_ACK_AT_1 = "error_ack_at_1"
    """The first item is answered with MISSION_ACK ERROR."""

    NO_FINAL_ACK = "no_final_ack"
    """All items are asked for and stored, but the last MISSION_ACK never comes."""

    EARLY_ACK = "early_ack"
    """MISSION_ACK ACCEPTED comes after the first item; the rest is never asked for and not stored."""

    LOST_ITEMS = "lost_items"
    """Every third item is lost on its first way up, and has to be asked for again."""

    LOST_REQUESTS = "lost_requests"
    """Every third request for an item is lost on its way down."""

    VANISH_MID_UPLOAD = "vanish_mid_upload"
    """After a number of items nothing is heard or said for a while; the upload has timed out on return."""

    ALTERED_ITEM = "altered_item"
    """The last item with a place is stored 10 m higher than sent: only a read-back shows it."""

    NO_RESPONSE_TO_LIST = "no_response_to_list"
    """MISSION_REQUEST_LIST is never answered: nothing can be read back."""

    LOST_DOWNLOAD_ITEMS = "lost_download_items"
    """Every third item sent on a download is lost and has to be asked for again."""

    WRONG_OPAQUE_ID = "wrong_opaque_id"
    """The last MISSION_ACK gives the list another id than MISSION_COUNT and MISSION_CURRENT do."""

    NO_COMMAND_ACK = "no_command_ack"
    """Commands are carried out and never acknowledged."""

    DENY_ARM = "deny_arm"
    """Pre-arm checks fail: arming is denied."""

    SENSOR_DEAD = "sensor_dead"
    """The sensor never switches on, whatever is ordered."""

    SENSOR_SKIPS = "sensor_skips"
    """The second time the sensor is switched on it stays off: one pass sees nothing."""


def parse_faults(names: Iterable[str]) -> frozenset[Fault]:
    """Faults of their names.

    Raises
    ------
    ValueError
        A name is not known; the message lists those that are.
    """
    known = {fault.value: fault for fault in Fault}
    chosen = set()
    for name in names:
        if name not in known:
            raise ValueError(f"unknown fault {name!r}; known: {', '.join(sorted(known))}")
        chosen.add(known[name])
    return frozenset(chosen)
