"""MAVLink 2 signing: who wrote a frame, and that it is not played again. No clock, no file.

A signature is the link's number, a time in units of 10 µs since 2015, and the first six bytes of the SHA-256
of key and frame. A frame counts when its signature is that of the key and its time is later than the last one
of the same sender and link; of a sender not heard before, when it is at most a minute behind this side's.

Source: https://mavlink.io/en/guide/message_signing.html
"""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac
import re
from collections.abc import Callable, Mapping
from enum import StrEnum
from typing import Final, Protocol

SIGNATURE_BYTES: Final = 13
SIGNED: Final = 0x01
KEY_BYTES: Final = 32

_MAGIC_V2: Final = 0xFD
_FLAGS_AT: Final = 2
_SYSTEM_AT: Final = 5
_DIGEST_BYTES: Final = 6
_TIME_BYTES: Final = 6
#: 1 January 2015 in seconds since 1970, and units of time in a second.
_EPOCH_S: Final = 1_420_070_400
UNITS_PER_S: Final = 100_000
_NEW_STREAM_BEHIND: Final = 60 * UNITS_PER_S
#: What is written down is ahead by this much, so that it need not be written for every frame.
_AHEAD: Final = 10 * UNITS_PER_S
_LATEST: Final = (1 << 8 * _TIME_BYTES) - 1

#: Sender's system and component, and the number of its link.
Stream = tuple[int, int, int]


class KeyFormatError(ValueError):
    """A text is no key. Its message never holds the text."""


class SigningKey:
    """A secret of 32 bytes, which no ``repr``, log or answer shows."""

    __slots__ = ("_secret",)

    def __init__(self, secret: bytes) -> None:
        if len(secret) != KEY_BYTES:
            raise KeyFormatError(f"a key has {KEY_BYTES} bytes, this one {len(secret)}")
        if not any(secret):
            raise KeyFormatError("a key of zeros is no key: it is the order to sign no more")
        self._secret = secret

    def reveal(self) -> bytes:
        """The secret itself: for the one message that hands it to a vehicle, and for signatures."""
        return self._secret

    def __repr__(self) -> str:
        return "SigningKey(…)"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SigningKey) and hmac.compare_digest(self._secret, other._secret)

    def __hash__(self) -> int:
        return hash(SigningKey)

    def __reduce__(self) -> str:
        raise TypeError("a signing key does not leave its process")


def parse_key(text: str) -> SigningKey:
    """A key as it is written: 64 hexadecimal digits, base64 of 32 bytes, or ``passphrase:`` and words.

    Of a passphrase the SHA-256 is the key, as MAVProxy, Mission Planner and QGroundControl take it.

    Raises
    ------
    KeyFormatError
        It is none of these.
    """
    text = text.strip()
    form, found, words = text.partition("passphrase:")
    if found and not form:
        if not words:
            raise KeyFormatError("the passphrase is empty")
        return SigningKey(hashlib.sha256(words.encode()).digest())
    if re.fullmatch(r"[0-9A-Fa-f]{64}", text):
        return SigningKey(bytes.fromhex(text))
    try:
        secret = base64.b64decode(text, validate=True)
    except (binascii.Error, ValueError):
        secret = b""
    if len(secret) != KEY_BYTES:
        raise KeyFormatError("a key is 64 hexadecimal digits, base64 of 32 bytes, or passphrase: and words")
    return SigningKey(secret)


class Verdict(StrEnum):
    """What a frame's signature says."""

    GENUINE = "verified"
    UNSIGNED = "unsigned"
    WRONG_KEY = "wrong_key"
    REPLAYED = "replayed"
    UNVERIFIED = "no_key"


class Memory(Protocol):
    """Keeps times over a restart."""

    def load(self) -> tuple[int, Mapping[Stream, int]]:
        """This side's time, and the last one of each stream; 0 and none where nothing is kept."""

    def save(self, timestamp: int, streams: Mapping[Stream, int]) -> None:
        """Keep them; never raises."""


class NoMemory:
    """Keeps nothing."""

    def load(self) -> tuple[int, Mapping[Stream, int]]:
        """Nothing."""
        return 0, {}

    def save(self, timestamp: int, streams: Mapping[Stream, int]) -> None:
        """Forget them."""


class Signing:
    """Signs what one side sends, and verifies what it hears.

    Parameters
    ----------
    clock
        Seconds since 1970.
    link_id
        The number of this side's link: each of several that share a key has its own.
    memory
        Keeps the times, so that a restart does not go back and nothing heard before is believed again.
    """

    def __init__(
        self, key: SigningKey, clock: Callable[[], float], link_id: int = 0, memory: Memory | None = None
    ) -> None:
        self.key = key
        self._clock = clock
        self._link_id = link_id
        self._memory = memory or NoMemory()
        self._timestamp, streams = self._memory.load()
        self._streams = dict(streams)
        self._written = self._timestamp

    @property
    def timestamp(self) -> int:
        """This side's time: that of its clock, and never behind what it has sent or heard."""
        units = round((self._clock() - _EPOCH_S) * UNITS_PER_S)
        self._timestamp = min(max(self._timestamp, units), _LATEST)
        return self._timestamp

    def signature(self, frame: bytes) -> bytes:
        """What stands behind a frame, which ends with its checksum and says that it is signed."""
        self._timestamp = self.timestamp + 1
        if self._timestamp >= self._written:
            self._written = self._timestamp + _AHEAD
            self._memory.save(self._written, self._streams)
        tail = bytes([self._link_id]) + self._timestamp.to_bytes(_TIME_BYTES, "little")
        return tail + self._digest(frame + tail)

    def check(self, frame: bytes) -> Verdict:
        """What a whole frame's signature says; nothing is noted."""
        if frame[0] != _MAGIC_V2 or not frame[_FLAGS_AT] & SIGNED:
            return Verdict.UNSIGNED
        signed, digest = frame[:-_DIGEST_BYTES], frame[-_DIGEST_BYTES:]
        if not hmac.compare_digest(self._digest(signed), digest):
            return Verdict.WRONG_KEY
        stream, sent = _stream(frame)
        last = self._streams.get(stream)
        if sent <= last if last is not None else sent + _NEW_STREAM_BEHIND < self.timestamp:
            return Verdict.REPLAYED
        return Verdict.GENUINE

    def take(self, frame: bytes) -> Verdict:
        """The same, and a genuine frame is noted: it does not count twice."""
        verdict = self.check(frame)
        if verdict is Verdict.GENUINE:
            stream, sent = _stream(frame)
            self._streams[stream] = sent
            self._timestamp = max(self._timestamp, sent)
        return verdict

    def close(self) -> None:
        """Keep the times as they are."""
        self._memory.save(max(self.timestamp, self._written), self._streams)

    def _digest(self, signed: bytes) -> bytes:
        return hashlib.sha256(self.key.reveal() + signed).digest()[:_DIGEST_BYTES]


def _stream(frame: bytes) -> tuple[Stream, int]:
    link_at = len(frame) - SIGNATURE_BYTES
    sent = int.from_bytes(frame[link_at + 1 : link_at + 1 + _TIME_BYTES], "little")
    return (frame[_SYSTEM_AT], frame[_SYSTEM_AT + 1], frame[link_at]), sent
