"""Signed frames as pymavlink signs and verifies them, both ways; the rules of time by brute force."""

from __future__ import annotations

import hashlib
import pickle

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega

from mavlink.wire.codec import Codec
from mavlink.wire.messages import Message
from mavlink.wire.signing import KeyFormatError, Signing, SigningKey, Verdict, parse_key

SECRET = bytes(range(32))
SECRETS = st.binary(min_size=32, max_size=32).filter(lambda secret: len(set(secret)) > 1)
#: Seconds since 1970 of a day in 2026, and its units of 10 µs since 2015.
NOW_S = 1_782_000_000.0
NOW = round((NOW_S - 1_420_070_400) * 100_000)


def signing(secret: bytes = SECRET, now_s: float = NOW_S, link_id: int = 0) -> Signing:
    """One side's signatures at a fixed time."""
    return Signing(SigningKey(secret), lambda: now_s, link_id)


def peer(secret: bytes = SECRET, timestamp: int = NOW, link_id: int = 3) -> ardupilotmega.MAVLink:
    """The other side, by pymavlink."""
    mav = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    mav.signing.secret_key = secret
    mav.signing.link_id = link_id
    mav.signing.timestamp = timestamp
    mav.signing.sign_outgoing = True
    mav.robust_parsing = True
    return mav


def beat(mav: ardupilotmega.MAVLink) -> bytes:
    """A heartbeat of pymavlink's."""
    frame: bytes = ardupilotmega.MAVLink_heartbeat_message(1, 3, 0, 10, 4, 3).pack(mav)
    return frame


def verdicts(codec: Codec, frames: list[bytes]) -> list[Verdict]:
    """What is noted of frames."""
    noted: list[Verdict] = []
    codec.noted = lambda _, verdict: noted.append(verdict)
    for frame in frames:
        codec.feed(frame)
    return noted


@settings(deadline=None, max_examples=60)
@given(SECRETS, st.integers(0, 255), st.lists(st.integers(0, 2**32 - 1)))
def test_pymavlink_takes_what_is_signed_here(secret: bytes, link_id: int, masks: list[int]) -> None:
    """Whatever key, link and content; each frame has a time of its own, so that none is a replay."""
    codec, mav = Codec(255, 190), peer(secret)
    codec.signing = signing(secret, link_id=link_id)
    mav.signing.sign_outgoing = False
    for mask in (7, *masks):
        frame = codec.pack(Message("HEARTBEAT", {"type": 6, "autopilot": 8, "custom_mode": mask}))
        (message,) = mav.parse_buffer(frame)
        assert message.get_type() == "HEARTBEAT"
        assert message.get_signed()
        assert (message.get_link_id(), message.custom_mode) == (link_id, mask)
    assert mav.signing.goodsig_count == len(masks) + 1
    stranger = peer(bytes(255 - byte for byte in secret))
    assert stranger.parse_char(frame).get_type() == "BAD_DATA"


@settings(deadline=None, max_examples=60)
@given(SECRETS, st.integers(0, 255), st.integers(1, 20))
def test_what_pymavlink_signs_is_taken_once(secret: bytes, link_id: int, count: int) -> None:
    """Genuine the first time, a replay the second; under another key nothing is."""
    mav = peer(secret, link_id=link_id)
    frames = [beat(mav) for _ in range(count)]
    codec = Codec()
    codec.signing = signing(secret)
    assert verdicts(codec, frames) == [Verdict.GENUINE] * count
    assert verdicts(codec, frames) == [Verdict.REPLAYED] * count
    assert codec.refused_frames == count
    wrong = Codec()
    wrong.signing = signing(bytes(255 - byte for byte in secret))
    assert verdicts(wrong, frames) == [Verdict.WRONG_KEY] * count
    assert wrong.feed(frames[0]) == []


def test_nothing_unsigned_counts() -> None:
    """MAVLink 2 without a signature, MAVLink 1, messages not known: neither read, taped nor heard."""
    mav = peer()
    mav.signing.sign_outgoing = False
    old = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    first = ardupilotmega.MAVLink_heartbeat_message(1, 3, 0, 0, 4, 3).pack(old, force_mavlink1=True)
    frames = [beat(mav), first]
    unknown = Codec(1, 1).pack(Message("HEARTBEAT", {}))[:7] + b"\xff\xff\xff" + bytes(3)
    codec = Codec()
    codec.signing = signing()
    seen: list[object] = []
    codec.tap, codec.heard = seen.append, lambda frame, message: seen.append(message)
    for frame in (*frames, unknown):
        assert codec.feed(frame) == []
    assert seen == []
    assert codec.refused_frames == 3
    assert verdicts(Codec(), frames) == []
    signed = beat(peer())
    assert verdicts(Codec(), [signed]) == [Verdict.UNVERIFIED]
    assert len(Codec().feed(signed)) == 1


@settings(deadline=None, max_examples=40)
@given(st.integers(-20_000_000, 20_000_000), st.integers(0, 999))
def test_a_sender_not_heard_before_is_no_more_than_a_minute_behind(offset: int, flip: int) -> None:
    """As pymavlink decides; and every single bit changed makes it no frame of the key's."""
    frame = beat(peer(timestamp=NOW + offset))
    judge = peer()
    judge.signing.sign_outgoing = False
    taken = judge.parse_char(frame)
    genuine = taken is not None and taken.get_type() == "HEARTBEAT"
    assert genuine == (signing().check(frame) is Verdict.GENUINE)
    bit = flip % (8 * (len(frame) - 13))
    changed = bytearray(frame)
    changed[bit // 8] ^= 1 << bit % 8
    assert signing().check(bytes(changed)) in (Verdict.WRONG_KEY, Verdict.UNSIGNED)


def test_each_link_of_a_sender_counts_for_itself() -> None:
    """The last time is that of system, component and link; this side's own goes with what it hears."""
    here = signing()
    early, late = peer(link_id=1, timestamp=NOW - 100_000), peer(link_id=2, timestamp=NOW + 500_000)
    first, second, third = beat(early), beat(late), beat(early)
    assert [here.take(frame) for frame in (second, first, third, first)] == [
        Verdict.GENUINE,
        Verdict.GENUINE,
        Verdict.GENUINE,
        Verdict.REPLAYED,
    ]
    assert here.timestamp >= NOW + 500_000


def test_a_restart_does_not_go_back() -> None:
    """With the clock an hour slow the times go on behind those kept, and frames heard before stay replays."""
    kept: dict[str, object] = {}

    class Kept:
        def load(self) -> tuple[int, dict[tuple[int, int, int], int]]:
            return kept.get("times", (0, {}))  # type: ignore[return-value]

        def save(self, timestamp: int, streams: dict[tuple[int, int, int], int]) -> None:
            kept["times"] = timestamp, dict(streams)

    key = SigningKey(SECRET)
    before = Signing(key, lambda: NOW_S, memory=Kept())  # type: ignore[arg-type]
    heard = beat(peer())
    assert before.take(heard) is Verdict.GENUINE
    last = int.from_bytes(before.signature(b"\xfd" * 12)[1:7], "little")
    # Killed here: no word of farewell.
    after = Signing(key, lambda: NOW_S - 3600.0, memory=Kept())  # type: ignore[arg-type]
    assert int.from_bytes(after.signature(b"\xfd" * 12)[1:7], "little") > last
    assert after.take(heard) is Verdict.REPLAYED
    judge = Signing(key, lambda: NOW_S + 8.0)
    assert after.timestamp <= judge.timestamp + 10 * 100_000


def test_another_stations_frame_is_signed_on_its_way() -> None:
    """It stays that station's, and pymavlink verifies it; MAVLink 1 cannot be signed."""
    codec = Codec()
    station = ardupilotmega.MAVLink(None, srcSystem=254, srcComponent=190)
    plain = ardupilotmega.MAVLink_command_long_message(1, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0).pack(station)
    assert codec.signed(plain) == plain
    codec.signing = signing()
    judge = peer()
    signed = codec.signed(plain)
    assert signed is not None
    (message,) = judge.parse_buffer(signed)
    assert (message.get_srcSystem(), message.command, message.get_signed()) == (254, 400, True)
    assert codec.signed(signed) == signed
    old = ardupilotmega.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(station, force_mavlink1=True)
    assert codec.signed(old) is None


def test_keys_are_read_and_never_shown() -> None:
    """Digits, base64 and passphrases; errors, ``repr`` and ``pickle`` tell nothing of them."""
    assert parse_key(SECRET.hex().upper()) == SigningKey(SECRET)
    assert parse_key("AAECAwQFBgcICQoLDA0ODxAREhMUFRYXGBkaGxwdHh8=\n") == SigningKey(SECRET)
    words = "passphrase: correct horse"
    assert parse_key(words).reveal() == hashlib.sha256(b" correct horse").digest()
    for text in ("", "hunter2", "ab" * 31, "00" * 32, "passphrase:", "my passphrase: x"):
        with pytest.raises(KeyFormatError) as caught:
            parse_key(text)
        assert not text or text not in str(caught.value) or text == "passphrase:"
    key = SigningKey(SECRET)
    for shown in (f"{key} {key!r}", str({"key": key}), repr(Signing(key, lambda: NOW_S))):
        assert "\\x01" not in shown
        assert SECRET.hex() not in shown
    with pytest.raises(TypeError):
        pickle.dumps(key)


def test_the_order_to_sign_is_not_recorded() -> None:
    """The frame that holds the key goes out, and not to the tape."""
    codec = Codec()
    taped: list[bytes] = []
    codec.tap = taped.append
    frame = codec.pack(Message("SETUP_SIGNING", {"target_system": 1, "secret_key": tuple(SECRET)}))
    assert SECRET in frame
    assert taped == []
