"""Items to messages and back."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.transfer.items_wire import item_message, message_item
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionItem, MissionType
from mavlink.wire.messages import Message

float32 = st.floats(width=32, allow_nan=False)
int32 = st.integers(-(2**31), 2**31 - 1)
items = st.builds(
    MissionItem,
    st.integers(0, 65535),
    st.integers(0, 255),
    st.integers(0, 65535),
    *[float32] * 4,
    int32,
    int32,
    float32,
    st.booleans(),
    st.booleans(),
    st.sampled_from(MissionType),
)


@given(items)
def test_an_item_survives_the_wire(item: MissionItem) -> None:
    """Packed, sent and read, every item is the same."""
    (message,) = Codec(1, 1).feed(Codec().pack(item_message(item, 1, 1)))
    assert message_item(message) == item


def test_a_float_item_is_placed_in_degrees() -> None:
    """MISSION_ITEM's x is a latitude in degrees, except in the mission frame, where it is a plain number."""
    fields = {**item_message(MissionItem(0, 3, 16), 1, 1).fields, "x": 47.5, "y": -8.25}
    item = message_item(Message("MISSION_ITEM", fields))
    assert (item.x, item.y) == (475_000_000, -82_500_000)
    item = message_item(Message("MISSION_ITEM", {**fields, "frame": 2, "x": 3.0, "y": 4.0}))
    assert (item.x, item.y) == (3, 4)
    item = message_item(Message("MISSION_ITEM", {**fields, "frame": 1, "x": 1.5, "y": 0.0}))
    assert item.x == 15_000


def test_not_a_number_is_kept_in_parameters() -> None:
    """NaN means "unchanged" and must arrive as NaN."""
    item = replace(MissionItem(0, 3, 16), param4=math.nan)
    (message,) = Codec(1, 1).feed(Codec().pack(item_message(item, 1, 1)))
    assert math.isnan(message_item(message).param4)


@pytest.mark.parametrize(
    "message",
    [
        Message("HEARTBEAT", {}),
        Message("MISSION_ITEM", {**item_message(MissionItem(0, 3, 16), 1, 1).fields, "x": math.inf}),
        Message(
            "MISSION_ITEM_INT", {**item_message(MissionItem(0, 3, 16), 1, 1).fields, "mission_type": 255}
        ),
    ],
    ids=["no-item", "nowhere", "no-list"],
)
def test_what_is_no_item_is_refused(message: Message) -> None:
    """Other messages, places that are no numbers and unknown lists raise ValueError."""
    with pytest.raises(ValueError, match=r"mission item|placed at|MissionType"):
        message_item(message)
