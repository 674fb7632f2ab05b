"""The codec against pymavlink's own bytes, and against garbage."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.errors import CodecError
from mavlink.transfer.items_wire import item_message
from mavlink.wire.codec import Codec
from mavlink.wire.items import MissionItem
from mavlink.wire.messages import Message
from mavlink.wire.signing import Signing, SigningKey


def reference() -> dialect.MAVLink:
    sender = dialect.MAVLink(None, srcSystem=7, srcComponent=8)
    sender.seq = 0
    return sender


SAMPLES = [
    (
        Message("MISSION_COUNT", {"count": 3, "target_system": 1, "target_component": 1, "mission_type": 2}),
        dialect.MAVLink_mission_count_message(1, 1, 3, 2),
    ),
    (
        item_message(MissionItem(5, 3, 2000, 1.5, -2.5, 0.1, -0.0, 473977000, -85456000, 100.5), 1, 1),
        dialect.MAVLink_mission_item_int_message(
            1, 1, 5, 3, 2000, 0, 1, 1.5, -2.5, 0.1, -0.0, 473977000, -85456000, 100.5, 0
        ),
    ),
    (
        Message("STATUSTEXT", {"severity": 4, "text": "low battery", "id": 9, "chunk_seq": 1}),
        dialect.MAVLink_statustext_message(4, b"low battery", 9, 1),
    ),
    (
        Message("NAMED_VALUE_INT", {"time_boot_ms": 1000, "name": "SAR_ON", "value": 1}),
        dialect.MAVLink_named_value_int_message(1000, b"SAR_ON", 1),
    ),
    (
        Message("RELAY_STATUS", {"time_boot_ms": 1000, "on": 3, "present": 7}),
        dialect.MAVLink_relay_status_message(1000, 3, 7),
    ),
    (
        Message(
            "CAMERA_IMAGE_CAPTURED",
            {
                "time_utc": 2**40,
                "lat": 1,
                "lon": -1,
                "q": (1.0, 0.0, 0.5, -0.5),
                "file_url": "a.jpg",
                "image_index": 4,
            },
        ),
        dialect.MAVLink_camera_image_captured_message(
            0, 2**40, 0, 1, -1, 0, 0, [1.0, 0.0, 0.5, -0.5], 4, 0, b"a.jpg"
        ),
    ),
    (Message("HEARTBEAT", {}), dialect.MAVLink_heartbeat_message(0, 0, 0, 0, 0, 0)),
]
NAMES = [message.name for message, _ in SAMPLES]


@pytest.mark.parametrize(("message", "twin"), SAMPLES, ids=NAMES)
def test_bytes_equal_pymavlinks(message: Message, twin: dialect.MAVLink_message) -> None:
    """Every frame is bit for bit what pymavlink makes of the same numbers, truncated zeros included."""
    assert Codec(7, 8).pack(message) == twin.pack(reference())


@pytest.mark.parametrize("version_1", [False, True], ids=["v2", "v1"])
@pytest.mark.parametrize(("message", "twin"), SAMPLES[:3], ids=NAMES[:3])
def test_pymavlinks_frames_are_understood(
    message: Message, twin: dialect.MAVLink_message, version_1: bool
) -> None:
    """Both versions of the frame are read, sender and fields included."""
    (read,) = Codec().feed(twin.pack(reference(), force_mavlink1=version_1))
    assert (read.name, read.system_id, read.component_id) == (message.name, 7, 8)
    for name, value in message.fields.items():
        expected = pytest.approx(value, rel=1e-6) if isinstance(value, float) else value
        assert read.fields[name] == expected


def test_signed_frames_are_read() -> None:
    """A vehicle that signs is heard; the signature is not ours to check."""
    sender = reference()
    sender.signing.secret_key = b"k" * 32
    sender.signing.sign_outgoing = True
    frame = dialect.MAVLink_mission_count_message(1, 1, 3, 0).pack(sender)
    assert len(frame) > len(dialect.MAVLink_mission_count_message(1, 1, 3, 0).pack(reference()))
    (read,) = Codec().feed(frame + frame[:5])
    assert read.integer("count") == 3


def test_the_sequence_counts_on() -> None:
    """Frames are numbered 0 to 255 and over again."""
    codec = Codec()
    numbers = [codec.pack(Message("HEARTBEAT"))[4] for _ in range(258)]
    assert numbers == [*range(256), 0, 1]


@given(st.lists(st.tuples(st.booleans(), st.integers(0, len(SAMPLES) - 1), st.booleans()), max_size=40))
def test_what_is_made_ready_is_what_would_be_packed(steps: list[tuple[bool, int, bool]]) -> None:
    """Whatever is made ready, packed or not, between others or behind a key: not one byte differs."""
    messages = [message for message, _ in SAMPLES]
    plain, hasty = Codec(), Codec()
    for packs, index, signs in steps:
        for codec in (plain, hasty):
            codec.signing = Signing(SigningKey(bytes(range(32))), lambda: 1.6e9) if signs else None
        if packs:
            assert hasty.pack(messages[index]) == plain.pack(messages[index])
        else:
            hasty.prepare(messages[index])


FRAMES = [Codec(1, 1).pack(message) for message, _ in SAMPLES]


@given(st.lists(st.sampled_from(FRAMES), max_size=8), st.lists(st.integers(1, 40), max_size=40))
def test_a_stream_may_be_cut_anywhere(frames: list[bytes], cuts: list[int]) -> None:
    """However a stream is cut into chunks, the same messages come out."""
    stream = b"".join(frames)
    whole = [message.name for message in Codec().feed(stream)]
    codec = Codec()
    pieces = []
    for cut in cuts:
        pieces += codec.feed(stream[:cut])
        stream = stream[cut:]
    pieces += codec.feed(stream)
    assert [message.name for message in pieces] == whole
    assert len(whole) == len(frames)
    assert codec.bad_frames == 0


@settings(max_examples=300)
@given(st.lists(st.one_of(st.binary(max_size=300), st.sampled_from(FRAMES)), max_size=6))
def test_no_bytes_raise(chunks: list[bytes]) -> None:
    """Fuzz, with true frames between, is read without an error."""
    codec = Codec()
    for chunk in chunks:
        codec.feed(chunk)


@given(st.binary(max_size=120))
def test_frames_behind_garbage_are_found(garbage: bytes) -> None:
    """Whatever came before, a stream of frames is heard again within the longest frame's length."""
    codec = Codec()
    codec.feed(garbage)
    good = FRAMES[1]
    heard = sum(len(codec.feed(good)) for _ in range(20))
    assert heard >= 20 - 300 // len(good) - 1


@given(st.integers(0, len(FRAMES[1]) - 1), st.integers(1, 255))
def test_a_damaged_frame_costs_no_other(place: int, flip: int) -> None:
    """One byte flipped: that frame is dropped or, at worst, waited for; those behind it are all heard."""
    damaged = bytearray(FRAMES[1])
    damaged[place] ^= flip
    codec = Codec()
    heard = codec.feed(bytes(damaged) + FRAMES[0] * 30)
    assert [message.name for message in heard] == ["MISSION_COUNT"] * 30


def test_bad_and_unknown_frames_are_counted() -> None:
    """A wrong checksum and flags nobody knows are bad; a message outside the dialect is skipped whole."""
    codec = Codec()
    damaged = FRAMES[0][:-1] + bytes([FRAMES[0][-1] ^ 1])
    assert codec.feed(damaged) == []
    assert codec.bad_frames == 1
    flagged = bytearray(FRAMES[0])
    flagged[2] = 0x80
    codec = Codec()
    assert codec.feed(bytes(flagged)) == []
    assert codec.bad_frames == 1
    unknown = bytes([0xFD, 3, 0, 0, 0, 1, 1, 0xFF, 0xFF, 0x7F, 1, 0xFD, 3, 0, 0])
    codec = Codec()
    assert [message.name for message in codec.feed(unknown + FRAMES[0])] == ["MISSION_COUNT"]
    assert (codec.bad_frames, codec.unknown_frames) == (0, 1)


def test_text_is_cut_at_a_characters_end() -> None:
    """Fifty bytes hold forty-nine letters and no half umlaut; bytes that are no text are replaced."""
    codec = Codec()
    (read,) = Codec().feed(codec.pack(Message("STATUSTEXT", {"text": "x" * 49 + "ü"})))
    assert read.text("text") == "x" * 49
    frame = dialect.MAVLink_statustext_message(4, b"\xff\xfe!", 0, 0).pack(reference())
    (read,) = Codec().feed(frame)
    assert read.text("text") == "\ufffd\ufffd!"


def test_not_a_number_survives() -> None:
    """NaN is a value of missions, not an error."""
    (read,) = Codec().feed(Codec().pack(Message("COMMAND_LONG", {"param1": math.nan})))
    assert math.isnan(read.number("param1"))


@pytest.mark.parametrize(
    ("message", "words"),
    [
        (Message("NO_SUCH"), "NO_SUCH"),
        (Message("HEARTBEAT", {"colour": 1}), "colour"),
        (Message("MISSION_COUNT", {"count": 70000}), "count"),
        (Message("MISSION_COUNT", {"count": "many"}), "count"),
        (Message("MISSION_ITEM_INT", {"param1": 1e39}), "param1"),
        (Message("STATUSTEXT", {"text": 5}), "text"),
        (Message("CAMERA_IMAGE_CAPTURED", {"q": 1.0}), "q"),
        (Message("CAMERA_IMAGE_CAPTURED", {"q": (1.0,) * 5}), "q"),
    ],
    ids=lambda value: value if isinstance(value, str) else value.name,
)
def test_what_does_not_fit_is_refused_by_name(message: Message, words: str) -> None:
    """Unknown messages, unknown fields and values out of range raise CodecError naming them."""
    with pytest.raises(CodecError, match=words):
        Codec().pack(message)


@pytest.mark.parametrize("number", [0, 256, -1])
def test_senders_are_numbered_1_to_255(number: int) -> None:
    """0 means everybody and is nobody's own number."""
    with pytest.raises(CodecError, match="system_id"):
        Codec(system_id=number)
