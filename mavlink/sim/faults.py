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

    NO_RESPONSE_TO_FIRST_COUNT = "no_response_to_first_count"
    """The first MISSION_COUNT is not answered; the second is."""

    NO_REQUEST_0 = "no_request_0"
    """MISSION_COUNT is taken, but item 0 is never asked for."""

    NO_REQUEST_1 = "no_request_1"
    """Item 0 is taken, but item 1 is never asked for."""

    WRONG_REQUEST_AT_0 = "wrong_request_at_0"
    """Instead of item 0 one far past the end is asked for, again and again."""

    WRONG_REQUEST_AT_1 = "wrong_request_at_1"
    """Instead of item 1 one far past the end is asked for, again and again."""

    WRONG_SEQUENCE_REQUEST = "wrong_sequence_request"
    """After the first item the vehicle asks once for item 2, not 1, refuses it, then asks properly."""

    ERROR_ACK_AT_0 = "error_ack_at_0"
    """MISSION_COUNT is answered with MISSION_ACK ERROR."""

    ERROR_ACK_AT_1 = "error_ack_at_1"
    """The first item is answered with MISSION_ACK ERROR."""

    ERROR_ACK_AT_END = "error_ack_at_end"
    """All items are taken, and the last MISSION_ACK says ERROR; PX4 keeps its old list, ArduPilot the new."""

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

    NO_RESPONSE_TO_FIRST_LIST = "no_response_to_first_list"
    """The first MISSION_REQUEST_LIST is not answered; the second is."""

    NO_ITEM_0 = "no_item_0"
    """A download stops at item 0, which is never given."""

    NO_ITEM_1 = "no_item_1"
    """A download stops at item 1, which is never given."""

    WRONG_ITEM_AT_0 = "wrong_item_at_0"
    """Asked for item 0, the vehicle gives one of another number."""

    WRONG_ITEM_AT_1 = "wrong_item_at_1"
    """Asked for item 1, the vehicle gives one of another number."""

    ERROR_ACK_FOR_ITEM_0 = "error_ack_for_item_0"
    """Asked for item 0, the vehicle answers MISSION_ACK ERROR."""

    ERROR_ACK_FOR_ITEM_1 = "error_ack_for_item_1"
    """Asked for item 1, the vehicle answers MISSION_ACK ERROR."""

    LOST_DOWNLOAD_ITEMS = "lost_download_items"
    """Every third item sent on a download is lost and has to be asked for again."""

    WRONG_TYPE_ACK = "wrong_type_ack"
    """Before item 1 is asked for, a MISSION_ACK DENIED comes that is about another list."""

    FOREIGN_ACK = "foreign_ack"
    """Before item 1 is asked for, another system (99) on the link sends us a MISSION_ACK DENIED."""

    COMPETING_STATION = "competing_station"
    """Another ground station is uploading all the time: our transfers are denied, our clearing fails."""

    WRONG_OPAQUE_ID = "wrong_opaque_id"
    """The last MISSION_ACK gives the list another id than MISSION_COUNT and MISSION_CURRENT do."""

    NO_COMMAND_ACK = "no_command_ack"
    """Commands are carried out and never acknowledged."""

    DENY_ARM = "deny_arm"
    """Pre-arm checks fail: arming is denied."""

    SENSOR_DEAD = "sensor_dead"
    """The sensor never switches on, whatever is ordered."""

    PHOTOS_LOST = "photos_lost"
    """Every seventh photo is ordered and never taken: the count of its feedback leaves one out."""

    FEEDBACK_LOST = "feedback_lost"
    """Every seventh photo is taken, and nobody hears of it."""

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
