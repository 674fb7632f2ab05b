"""What every autopilot answers whoever asks: the time, a ping, files and logs that are not there.

Source: MAVLink ``common.xml`` (TIMESYNC, PING, FILE_TRANSFER_PROTOCOL, LOG_REQUEST_LIST).
"""

from __future__ import annotations

import struct

from mavlink.sim.streams import Streams
from mavlink.wire.messages import Message

_FTP_HEADER = struct.Struct("<HBBBBBBI")
_FTP_NAK, _FTP_UNKNOWN_COMMAND = 129, 7


def answer(message: Message, time_s: float, streams: Streams) -> list[Message]:
    """Answers to one message, and the rates of streams that it asks for."""
    sender = {"target_system": message.system_id, "target_component": message.component_id}
    match message.name:
        case "TIMESYNC" if message.integer("tc1") == 0:
            return [Message("TIMESYNC", {"tc1": round(time_s * 1e9), "ts1": message.integer("ts1")})]
        case "PING" if message.integer("target_system") == 0:
            asked = {name: message.integer(name) for name in ("time_usec", "seq")}
            return [Message("PING", {**asked, **sender})]
        case "FILE_TRANSFER_PROTOCOL":
            return [Message(message.name, {**sender, "payload": _refused(message)})]
        case "LOG_REQUEST_LIST":
            return [Message("LOG_ENTRY", {})]
        case "REQUEST_DATA_STREAM":
            rate_hz = message.number("req_message_rate") if message.integer("start_stop") else 0.0
            streams.set_group(message.integer("req_stream_id"), rate_hz)
    return []


def _refused(message: Message) -> tuple[int, ...]:
    """The payload that refuses a file operation: nothing is kept in files here."""
    asked = message.fields["payload"]
    if not isinstance(asked, tuple):
        raise TypeError("FILE_TRANSFER_PROTOCOL without its payload")
    sequence, session, opcode, *_ = _FTP_HEADER.unpack(bytes(int(byte) for byte in asked[: _FTP_HEADER.size]))
    header = _FTP_HEADER.pack((sequence + 1) & 0xFFFF, session, _FTP_NAK, 1, opcode, 0, 0, 0)
    return (*header, _FTP_UNKNOWN_COMMAND)
