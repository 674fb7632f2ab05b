"""Which format a log is in, and what it tells."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from mavlink.encoding.payload import Payload
from mavlink.formats.errors import FormatError
from mavlink.formats.onboard import dataflash, ulog
from mavlink.formats.onboard.log import OnboardLog
from mavlink.links.recording import read_tlog
from mavlink.state.outputs import output_of, switched_by
from mavlink.state.telemetry import VehicleState, updated
from mavlink.state.track import CAMERA_MESSAGES, TrackRecorder
from mavlink.wire.codec import MAGIC, Codec

#: A recording is one whose first frame stands behind a time of eight bytes.
_TIME_BYTES: Final = 8
_AUTOPILOT: Final = 1


def read_log(path: Path, payload: Payload) -> OnboardLog:
    """A ``.bin``, ``.ulg`` or ``.tlog``, told apart by how it begins.

    Parameters
    ----------
    payload
        What of a recording of the link is the sensor's switch.

    Raises
    ------
    FormatError
        It is none of them, or holds no places.
    """
    with path.open("rb") as file:
        head = file.read(16)
    try:
        return _read(path, head, payload)
    except FormatError:
        raise
    except Exception as error:
        # What the readers raise for broken files is of every kind.
        raise FormatError(f"the log cannot be read: {type(error).__name__}: {error}") from error


def _read(path: Path, head: bytes, payload: Payload) -> OnboardLog:
    if head.startswith(ulog.MAGIC):
        return ulog.read_ulog(path)
    if head.startswith(dataflash.MAGIC):
        return dataflash.read_dataflash(path)
    if MAGIC.match(head[_TIME_BYTES : _TIME_BYTES + 1]):
        return _recording(path, payload)
    raise FormatError("the file is no log: a .bin of ArduPilot's, a .ulg of PX4's or a .tlog is meant")


def _recording(path: Path, payload: Payload) -> OnboardLog:
    """A recording of a link: the first autopilot that tells where it is."""
    codec, state, system = Codec(), VehicleState(), None
    recorder = TrackRecorder()
    clock_s: float | None = None
    records = list(read_tlog(path))
    for at_s, frame in records:
        for message in codec.feed(frame):
            if system is None and message.name == "GLOBAL_POSITION_INT":
                system = message.system_id
            own = message.component_id == _AUTOPILOT or message.name in CAMERA_MESSAGES
            if message.system_id != (system or message.system_id) or not own:
                continue
            state = updated(state, message, at_s)
            if message.name == "HEARTBEAT" and recorder.output is None:
                recorder.output = output_of(switched_by(payload, state.autopilot), state.autopilot)
            recorder.take(message, state)
            if message.name == "GLOBAL_POSITION_INT":
                clock_s = at_s - message.number("time_boot_ms") / 1000.0
    track = recorder.track()
    if not track.points:
        raise FormatError("the recording tells no places (GLOBAL_POSITION_INT)")
    photos = tuple(event for event in track.events if event.kind == "photo")
    return OnboardLog(state.autopilot, track.points, photos, unix_minus_boot_s=clock_s)
