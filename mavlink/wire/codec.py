"""MAVLink frames: messages to bytes and bytes to messages. The only file that knows pymavlink.

pymavlink's generated dialect gives the layout of every message; the framing is done here, because its
parser throws away everything inside a frame whose checksum fails, good frames included.

Source: https://mavlink.io/en/guide/serialization.html (frame formats, zero truncation, CRC-16/MCRF4XX).
"""

from __future__ import annotations

import contextlib
import operator
import re
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from pymavlink.dialects.v20 import ardupilotmega as dialect

from mavlink.errors import CodecError
from mavlink.wire.extra_messages import EXTRA_FIELDS, EXTRA_MESSAGES, Definition
from mavlink.wire.messages import Message, Value
from mavlink.wire.signing import SIGNATURE_BYTES, SIGNED, Signing, Verdict

_MAGIC_V1: Final = 0xFE
_MAGIC_V2: Final = 0xFD
#: The first byte of a frame.
MAGIC: Final = re.compile(rb"[\xfd\xfe]")
_HEADER_V1: Final = struct.Struct("<BBBBBB")
_HEADER_V2: Final = struct.Struct("<BBBBBBBHB")
_CRC_BYTES: Final = 2
#: Not for recordings: it holds a key.
_SECRET: Final = frozenset({"SETUP_SIGNING"})
#: What pymavlink's own class calls where it is installed: CRC-16/MCRF4XX in one call.
_FAST_CRC: Final[Callable[[bytes], int] | None] = getattr(dialect, "mcrf4xx", None)


@dataclass(frozen=True, slots=True)
class _Field:
    """Where a field lies in the unpacked tuple; ``text_bytes`` > 0 marks a char array."""

    name: str
    first: int
    length: int
    text_bytes: int


@dataclass(frozen=True, slots=True)
class _Layout:
    """One message of the dialect, fields in wire order."""

    message_id: int
    name: str
    crc_extra: bytes
    payload: struct.Struct
    fields: tuple[_Field, ...]
    names: tuple[str, ...]
    known: frozenset[str]
    plain: bool  # numbers only, one a field: packed and unpacked without looking at each
    every: Callable[[Mapping[str, Value]], Sequence[Any]] | None  # all values in one call, where it is plain


def _every(names: tuple[str, ...], plain: bool) -> Callable[[Mapping[str, Value]], Sequence[Any]] | None:
    # Of one name alone it gives the value itself.
    return operator.itemgetter(*names) if plain and len(names) > 1 else None


def _layout(message_id: int, definition: Any) -> _Layout:
    """Read a generated message class; its ``lengths`` and ``array_lengths`` are in wire order."""
    wire_type = dict(zip(definition.fieldnames, definition.fieldtypes, strict=True))
    fields = []
    first = 0
    for name, length, array_length in zip(
        definition.ordered_fieldnames, definition.lengths, definition.array_lengths, strict=True
    ):
        text_bytes = max(array_length, 1) if wire_type[name] == "char" else 0
        fields.append(_Field(name, first, length, text_bytes))
        first += length
    payload = definition.unpacker
    for kind, name in EXTRA_FIELDS.get(definition.msgname, ()):
        if name not in wire_type:  # else pymavlink has it by now
            fields.append(_Field(name, first, 1, 0))
            first += 1
            payload = struct.Struct(payload.format + kind)
    names = tuple(field.name for field in fields)
    plain = all(field.length == 1 and not field.text_bytes for field in fields)
    return _Layout(
        message_id,
        definition.msgname,
        bytes([definition.crc_extra]),
        payload,
        tuple(fields),
        names,
        frozenset(names),
        plain,
        _every(names, plain),
    )


def _extra_layout(definition: Definition) -> _Layout:
    """Read a message that pymavlink lacks."""
    fields = []
    first = 0
    for _, name, length in definition.fields:
        fields.append(_Field(name, first, max(length, 1), 0))
        first += max(length, 1)
    crc = int(dialect.x25crc(definition.signature).crc)
    names = tuple(field.name for field in fields)
    plain = all(field.length == 1 for field in fields)
    return _Layout(
        definition.message_id,
        definition.name,
        bytes([(crc & 0xFF) ^ (crc >> 8)]),
        struct.Struct(definition.layout),
        tuple(fields),
        names,
        frozenset(names),
        plain,
        _every(names, plain),
    )


_BY_ID: Final[dict[int, _Layout]] = {
    # Once pymavlink has them too, its own count.
    **{definition.message_id: _extra_layout(definition) for definition in EXTRA_MESSAGES},
    **{number: _layout(number, definition) for number, definition in dialect.mavlink_map.items()},
}
_BY_NAME: Final[dict[str, _Layout]] = {layout.name: layout for layout in _BY_ID.values()}


class Codec:
    """One sender's encoder and one byte stream's decoder.

    Parameters
    ----------
    system_id, component_id
        The sender written into every frame; 255/190 is a ground station's mission planner.

    Attributes
    ----------
    bad_frames
        Frame starts given up: checksum wrong, or flags nobody here understands.
    unknown_frames
        Whole frames skipped because the dialect does not define their message.
    tap
        Called with every whole frame taken in or packed, as it is on the wire; None to do without.
    heard
        Called with every whole frame taken in, and its message: None where the dialect does not define it.
    signing
        Signs what is packed and verifies what is fed; then nothing unsigned, wrongly signed or played again
        is taken in. None: frames go unsigned, and signatures are not looked at.
    noted
        Called with what the signature of every known message says; not of unsigned ones without ``signing``.
    refused_frames
        Frames not taken in for their signature, or for want of one.
    """

    def __init__(self, system_id: int = 255, component_id: int = 190) -> None:
        for name, number in (("system_id", system_id), ("component_id", component_id)):
            if not 1 <= number <= 255:
                raise CodecError(f"{name} is {number}; senders are numbered 1 to 255")
        self.system_id = system_id
        self.component_id = component_id
        self.bad_frames = 0
        self.unknown_frames = 0
        self.tap: Callable[[bytes], None] | None = None
        self.heard: Callable[[bytes, Message | None], None] | None = None
        self.signing: Signing | None = None
        self.noted: Callable[[Message, Verdict], None] | None = None
        self.refused_frames = 0
        self._sequence = 0
        self._buffer = b""
        self._ready: tuple[Message, int, bytes] | None = None

    def pack(self, message: Message) -> bytes:
        """Encode as one MAVLink 2 frame from this codec's sender.

        Fields left out are zero, as the wire's own truncation has it. Text longer than its field is cut
        at a character's end.

        Raises
        ------
        CodecError
            The message or a field is not in the dialect, or a value does not fit its field.
        """
        ready, self._ready = self._ready, None
        if ready is not None and ready[0] is message and ready[1] == self._sequence and self.signing is None:
            frame = ready[2]
        else:
            frame = self._frame(message)
        self._sequence = (self._sequence + 1) & 0xFF
        if self.signing is not None:
            frame += self.signing.signature(frame)
        if self.tap is not None and message.name not in _SECRET:
            self.tap(frame)
        return frame

    def prepare(self, message: Message) -> None:
        """Encode what is to be packed next, if it will be, before there is haste."""
        if self.signing is None and (self._ready is None or self._ready[0] is not message):
            with contextlib.suppress(CodecError):  # packing it will say so
                self._ready = message, self._sequence, self._frame(message)

    def _frame(self, message: Message) -> bytes:
        """The next frame but for its signature."""
        layout = _BY_NAME.get(message.name)
        if layout is None:
            raise CodecError(f"no message is called {message.name!r} in the dialect")
        flat = _flat(message, layout)
        try:
            payload = layout.payload.pack(*flat)
        except (struct.error, OverflowError) as error:
            raise CodecError(f"{message.name}{dict(message.fields)}: {error}") from error
        payload = payload.rstrip(b"\0") or b"\0"
        header = _HEADER_V2.pack(
            _MAGIC_V2,
            len(payload),
            0 if self.signing is None else SIGNED,
            0,
            self._sequence,
            self.system_id,
            self.component_id,
            layout.message_id & 0xFFFF,
            layout.message_id >> 16,
        )
        body = header + payload
        return body + _crc(body[1:] + layout.crc_extra)

    def signed(self, frame: bytes) -> bytes | None:
        """Another sender's frame, signed from here where it is not; None where it cannot be."""
        if self.signing is None or _says_signed(frame):
            return frame
        layout = _BY_ID.get(int.from_bytes(frame[7:10], "little")) if frame[0] == _MAGIC_V2 else None
        if layout is None:
            return None
        body = frame[:2] + bytes([SIGNED]) + frame[3:-_CRC_BYTES]
        frame = body + _crc(body[1:] + layout.crc_extra)
        return frame + self.signing.signature(frame)

    def feed(self, data: bytes) -> list[Message]:
        """Decode what is complete; keep the rest for the next call. Never raises, whatever the bytes.

        After a failed checksum the search goes on one byte further, so a good frame behind or inside a
        damaged one is still found.
        """
        # As a rule a datagram holds whole frames, and nothing is left over: it is read where it lies.
        buffer = self._buffer + data if self._buffer else data
        messages: list[Message] = []
        position = 0
        while (start := MAGIC.search(buffer, position)) is not None:
            position = start.start()
            end = frame_end(buffer, position)
            if end is None:
                break
            taken = self._decode(buffer, position, end) if end > position else False
            if taken is False:
                self.bad_frames += 1
                position += 1
                continue
            frame = buffer[position:end]
            position = end
            if (self.signing is not None or _says_signed(frame)) and not self._trusts(frame, taken):
                continue
            if self.tap is not None:
                self.tap(frame)
            if self.heard is not None:
                self.heard(frame, taken)
            if taken is not None:
                messages.append(taken)
        else:
            position = len(buffer)
        self._buffer = buffer[position:]
        return messages

    def _trusts(self, frame: bytes, message: Message | None) -> bool:
        """Whether a frame that is signed, or should be, is to be taken in."""
        if self.signing is not None:
            verdict = self.signing.take(frame)
            self.refused_frames += verdict is not Verdict.GENUINE
        else:
            verdict = Verdict.UNVERIFIED
        if message is not None and self.noted is not None:
            self.noted(message, verdict)
        return verdict in (Verdict.GENUINE, Verdict.UNVERIFIED)

    def _decode(self, buffer: bytes, start: int, end: int) -> Message | Literal[False] | None:
        """Decode the frame at ``start``: None when its message is not known, False when it is no frame."""
        signature = 0
        if buffer[start] == _MAGIC_V2:
            _, length, flags, _, sequence, system_id, component_id, low, high = _HEADER_V2.unpack_from(
                buffer, start
            )
            message_id = low | high << 16
            body = start + _HEADER_V2.size
            signature = SIGNATURE_BYTES if flags & SIGNED else 0
        else:
            _, length, sequence, system_id, component_id, message_id = _HEADER_V1.unpack_from(buffer, start)
            body = start + _HEADER_V1.size
        layout = _BY_ID.get(message_id)
        if layout is None:
            # Its checksum cannot be verified; believe it if something frame-like, or nothing, follows.
            believed = end == len(buffer) or buffer[end] in (_MAGIC_V1, _MAGIC_V2)
            self.unknown_frames += believed
            return None if believed else False
        crc_at = end - signature - _CRC_BYTES
        if buffer[crc_at : crc_at + _CRC_BYTES] != _crc(buffer[start + 1 : crc_at] + layout.crc_extra):
            return False
        size = layout.payload.size
        payload = buffer[body : body + min(length, size)].ljust(size, b"\0")
        flat = layout.payload.unpack(payload)
        if layout.plain:
            fields: dict[str, Value] = dict(zip(layout.names, flat, strict=True))
        else:
            fields = {field.name: _value(flat, field) for field in layout.fields}
        return Message(layout.name, fields, system_id, component_id, sequence)


def _says_signed(frame: bytes) -> bool:
    return frame[0] == _MAGIC_V2 and bool(frame[2] & SIGNED)


def _crc(data: bytes) -> bytes:
    if _FAST_CRC is not None:
        return int(_FAST_CRC(data)).to_bytes(_CRC_BYTES, "little")
    return int(dialect.x25crc(data).crc).to_bytes(_CRC_BYTES, "little")


def frame_end(buffer: bytes | bytearray, start: int) -> int | None:
    """One past the frame's last byte; None while it is incomplete; ``start`` when it can be no frame.

    ``buffer[start]`` must be the first byte of a frame.
    """
    available = len(buffer) - start
    if buffer[start] == _MAGIC_V1:
        if available < _HEADER_V1.size:
            return None
        size = _HEADER_V1.size + buffer[start + 1] + _CRC_BYTES
    else:
        if available < 3:
            return None
        flags = buffer[start + 2]
        if flags & ~SIGNED:
            return start
        size = _HEADER_V2.size + buffer[start + 1] + _CRC_BYTES + (SIGNATURE_BYTES if flags else 0)
    return start + size if available >= size else None


def _flat(message: Message, layout: _Layout) -> Sequence[Any]:
    """Values in wire order."""
    if layout.every is not None and len(message.fields) == len(layout.names):
        # Mission items, by the thousand: all fields are there, or one is unknown.
        with contextlib.suppress(KeyError):
            return layout.every(message.fields)
    if not layout.known.issuperset(message.fields):
        unknown = sorted(message.fields.keys() - layout.known)
        raise CodecError(f"{message.name} has no field {', '.join(unknown)}")
    if layout.plain:
        return [message.fields.get(name, 0) for name in layout.names]
    flat: list[Any] = []
    for field in layout.fields:
        _append(flat, message, field)
    return flat


def _append(flat: list[Any], message: Message, field: _Field) -> None:
    value = message.fields.get(field.name)
    if field.text_bytes:
        if value is None:
            value = ""
        if not isinstance(value, str):
            raise CodecError(f"{message.name}.{field.name} takes text, not {type(value).__name__}")
        flat.append(value.encode()[: field.text_bytes].decode(errors="ignore").encode())
    elif field.length == 1:
        flat.append(0 if value is None else value)
    elif value is None:
        flat.extend([0] * field.length)
    elif not isinstance(value, (tuple, bytes)) or len(value) > field.length:
        raise CodecError(
            f"{message.name}.{field.name} takes a tuple of {field.length} numbers, got {value!r}"
        )
    else:
        flat.extend(value)
        flat.extend([0] * (field.length - len(value)))


def _value(flat: tuple[Any, ...], field: _Field) -> Value:
    if field.text_bytes:
        raw: bytes = flat[field.first]
        return raw.split(b"\0", 1)[0].decode(errors="replace")
    if field.length == 1:
        number: int | float = flat[field.first]
        return number
    numbers: tuple[int, ...] | tuple[float, ...] = flat[field.first : field.first + field.length]
    return numbers
