"""ArduPilot's onboard logs, read by pymavlink's own reader.

Source: ArduPilot's ``LogStructure.h``: POS (place, height over home), ATT (attitude), RELY (a relay changes),
RCOU, RCO2, RCO3 (pulses of the outputs 1 to 14, 15 to 18, 19 to 32), CAM (a photo), GPS (week and
milliseconds), PARM. ``TimeUS`` is the time since boot, that of GLOBAL_POSITION_INT. With a feedback pin TRIG
is the order to the shutter and CAM the photo that the camera confirms: an order alone is no photo.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Final

import numpy as np
from pymavlink.DFReader import DFReader_binary

from mavlink.formats.errors import FormatError
from mavlink.formats.onboard.log import OnboardLog
from mavlink.state.track import SensorEvent, TrackPoint

MAGIC: Final = b"\xa3\x95"
_KINDS: Final = ("POS", "ATT", "RELY", "RCOU", "RCO2", "RCO3", "CAM", "GPS", "PARM", "ORGN")
#: The world's clock of GPS: its first second since 1970, and the leap seconds it is ahead since 2017.
_GPS_EPOCH_S: Final = 315_964_800.0
_WEEK_S: Final = 604_800.0
_LEAP_S: Final = 18.0
_FIX_3D: Final = 3
#: A place has the attitude of the nearest time, no further away than this.
_ATTITUDE_S: Final = 1.0


def read_dataflash(path: Path) -> OnboardLog:
    """A ``.bin``; raises FormatError where it holds no places."""
    found = _messages(path)
    if not found["POS"]:
        raise FormatError("the log holds no places (POS): logging of positions was off, or it is cut short")
    home_m = next((m["Alt"] for m in found["ORGN"] if m.get("Type") == 1), math.nan)
    return OnboardLog(
        "ardupilot",
        _points(found["POS"], found["ATT"], home_m),
        tuple(_photo(m) for m in found["CAM"] if m.get("Lat")),
        _relays(found["RELY"]),
        _pulses([*found["RCOU"], *found["RCO2"], *found["RCO3"]]),
        {str(m["Name"]): float(m["Value"]) for m in found["PARM"]},
        _clock_s(found["GPS"]),
    )


def _messages(path: Path) -> dict[str, list[dict[str, Any]]]:
    found: dict[str, list[dict[str, Any]]] = {kind: [] for kind in _KINDS}
    reader = _Reader()
    try:
        reader.open(path)
        while (message := reader.recv_match(type=list(_KINDS))) is not None:
            found[message.get_type()].append(message.to_dict())
    finally:
        reader.close()
    return found


class _Reader(DFReader_binary):  # type: ignore[misc]
    """The library's reader, closed whatever becomes of the file: it is left open where it breaks."""

    def __init__(self) -> None:
        self.filehandle: Any = None
        self.data_map: Any = None

    def open(self, path: Path) -> None:
        """Begin to read."""
        super().__init__(str(path), zero_time_base=False)

    def close(self) -> None:
        """Let go of the file."""
        for held in (self.data_map, self.filehandle):
            if held is not None:
                held.close()


def _points(
    places: list[dict[str, Any]], attitudes: list[dict[str, Any]], home_m: float
) -> tuple[TrackPoint, ...]:
    times_s = np.array([m["TimeUS"] / 1e6 for m in places])
    at_s = np.array([m["TimeUS"] / 1e6 for m in attitudes])
    rows = _nearest(at_s, times_s)
    made = []
    for place, time_s, row in zip(places, times_s.tolist(), rows, strict=True):
        relative_m = float(place.get("RelHomeAlt", math.nan))
        if math.isnan(relative_m):
            relative_m = float(place["Alt"]) - home_m
        if math.isnan(relative_m) or not (place["Lat"] or place["Lng"]):
            continue
        attitude = attitudes[row] if row is not None else {}
        yaw, roll, pitch = (attitude.get(name) for name in ("Yaw", "Roll", "Pitch"))
        made.append(
            TrackPoint(
                time_s,
                float(place["Lng"]),
                float(place["Lat"]),
                relative_m,
                float(place["Alt"]),
                None if yaw is None else float(yaw) % 360.0,
                None,
                None if roll is None else float(roll),
                None if pitch is None else float(pitch),
            )
        )
    return tuple(made)


def _nearest(at_s: np.ndarray[Any, Any], times_s: np.ndarray[Any, Any]) -> list[int | None]:
    """The row of ``at_s`` nearest to each time, None where none is near."""
    if not len(at_s):
        return [None] * len(times_s)
    after = np.clip(np.searchsorted(at_s, times_s), 1, max(len(at_s) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(at_s) - 1)
    nearer = np.where(np.abs(at_s[before] - times_s) <= np.abs(at_s[after] - times_s), before, after)
    near = np.abs(at_s[nearer] - times_s) <= _ATTITUDE_S
    return [int(row) if is_near else None for row, is_near in zip(nearer, near, strict=True)]


def _photo(message: dict[str, Any]) -> SensorEvent:
    return SensorEvent(
        message["TimeUS"] / 1e6,
        "photo",
        "camera",
        float(message["Lng"]),
        float(message["Lat"]),
        float(message["RelAlt"]),
        int(message["Img"]),
        float(message["Alt"]),
        float(message.get("Y", message.get("Yaw", 0.0))) % 360.0,
        float(message.get("R", message.get("Roll", 0.0))),
        float(message.get("P", message.get("Pitch", 0.0))),
    )


def _relays(messages: Iterable[dict[str, Any]]) -> dict[int, tuple[tuple[float, bool], ...]]:
    found: dict[int, list[tuple[float, bool]]] = {}
    for message in messages:
        change = (message["TimeUS"] / 1e6, bool(message["State"]))
        found.setdefault(int(message["Instance"]), []).append(change)
    return {number: tuple(changes) for number, changes in found.items()}


def _pulses(messages: Iterable[dict[str, Any]]) -> dict[int, tuple[tuple[float, float], ...]]:
    found: dict[int, list[tuple[float, float]]] = {}
    for message in messages:
        for name, value in message.items():
            if name.startswith("C") and name[1:].isdigit():
                found.setdefault(int(name[1:]), []).append((message["TimeUS"] / 1e6, float(value)))
    return {number: tuple(sorted(pulses)) for number, pulses in found.items()}


def _clock_s(fixes: list[dict[str, Any]]) -> float | None:
    told = [m for m in fixes if m.get("Status", 0) >= _FIX_3D and m.get("GWk", 0) > 0]
    if not told:
        return None
    one = told[-1]
    unix_s = _GPS_EPOCH_S + one["GWk"] * _WEEK_S + one["GMS"] / 1000.0 - _LEAP_S
    return float(unix_s - one["TimeUS"] / 1e6)
