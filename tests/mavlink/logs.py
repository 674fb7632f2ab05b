"""Onboard logs written by the formats' own descriptions, for readers to read.

Source: ArduPilot's ``LogStructure.h`` (head 0xA3 0x95, FMT), and https://docs.px4.io/main/en/dev_log/ulog_file_format.html.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A place of a log: seconds since boot, degrees, metres, and whether the sensor is on."""

    time_s: float
    lon_deg: float
    lat_deg: float
    relative_m: float
    amsl_m: float
    roll_deg: float
    pitch_deg: float
    yaw_deg: float
    on: bool


_SHOT = ("<QBHIHii3i2hH", "QBHIHLLeeeccC", "TimeUS,I,Img,GPSTime,GPSWeek,Lat,Lng,Alt,RelAlt,GPSAlt,R,P,Y")
_DATAFLASH = {
    "POS": (10, "<Qiifff", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt"),
    "ATT": (11, "<Qfff", "Qfff", "TimeUS,Roll,Pitch,Yaw"),
    "RELY": (12, "<QBB", "QBB", "TimeUS,Instance,State"),
    "GPS": (13, "<QBIH", "QBIH", "TimeUS,Status,GMS,GWk"),
    "RCOU": (14, "<Q14H", "QHHHHHHHHHHHHHH", "TimeUS," + ",".join(f"C{n}" for n in range(1, 15))),
    "PARM": (15, "<Q16sff", "QNff", "TimeUS,Name,Value,Default"),
    "CAM": (16, *_SHOT),
    "TRIG": (17, *_SHOT),
}


def dataflash(
    rows: Sequence[Row],
    *,
    relay: int | None = 0,
    servo: int | None = None,
    unix_minus_boot_s: float | None = None,
    photos: Sequence[int] = (),
    orders: Sequence[int] = (),
) -> bytes:
    """ArduPilot's: places with attitudes, changes of a relay, pulses of an output, the world's clock.

    At the rows of the numbers given a photo was taken, or ordered where a feedback pin confirms them.
    """
    out = bytearray()
    for name, (kind, layout, form, columns) in _DATAFLASH.items():
        length = struct.calcsize(layout) + 3
        out += b"\xa3\x95\x80" + struct.pack(
            "<BB4s16s64s", kind, length, name.encode(), form.encode(), columns.encode()
        )

    def put(name: str, *values: object) -> None:
        kind, layout, *_ = _DATAFLASH[name]
        out.extend(b"\xa3\x95" + bytes([kind]) + struct.pack(layout, *values))

    put("PARM", 0, b"SYSID_THISMAV", 1.0, 1.0)
    was = False
    for number, row in enumerate(rows):
        at_us = round(row.time_s * 1e6)
        put("ATT", at_us, row.roll_deg, row.pitch_deg, row.yaw_deg)
        place = (round(row.lat_deg * 1e7), round(row.lon_deg * 1e7))
        put("POS", at_us, *place, row.amsl_m, row.relative_m, math.nan)
        if relay is not None and row.on != was:
            put("RELY", at_us, relay, int(row.on))
        if servo is not None:
            pulses = [1500] * 14
            pulses[servo - 1] = 1900 if row.on else 1100
            put("RCOU", at_us, *pulses)
        was = row.on
        shots = [name for name, numbers in (("TRIG", orders), ("CAM", photos)) if number in numbers]
        for name in shots:
            heights = [round(100.0 * height_m) for height_m in (row.amsl_m, row.relative_m, row.amsl_m)]
            angles = [round(100.0 * a) for a in (row.roll_deg, row.pitch_deg, row.yaw_deg % 360.0)]
            put(name, at_us, 0, number, 0, 0, *place, *heights, *angles)
        if unix_minus_boot_s is not None:
            week, into_s = divmod(row.time_s + unix_minus_boot_s - 315_964_800.0 + 18.0, 604_800.0)
            put("GPS", at_us, 3, round(into_s * 1000.0), int(week))
    return bytes(out)


_ULOG = {
    "vehicle_global_position": ("uint64_t timestamp;double lat;double lon;float alt;", "<Qddf"),
    "vehicle_attitude": ("uint64_t timestamp;float[4] q;", "<Q4f"),
    "home_position": ("uint64_t timestamp;float alt;", "<Qf"),
    "actuator_outputs": ("uint64_t timestamp;uint32_t noutputs;float[16] output;", "<QI16f"),
    "sensor_gps": ("uint64_t timestamp;uint64_t time_utc_usec;", "<QQ"),
}
_CAPTURE = (
    "uint64_t timestamp;double lat;double lon;uint32_t seq;float alt;float[4] q;int8_t result;", "<QddIf4fb"
)  # fmt: skip
_TRIGGER = ("uint64_t timestamp;uint32_t seq;bool feedback;", "<QIB")


def ulog(
    rows: Sequence[Row],
    *,
    servo: int = 5,
    unix_minus_boot_s: float | None = None,
    captures: Sequence[int] | None = None,
    triggers: Mapping[int, bool] | None = None,
    confirms: bool = False,
) -> bytes:
    """PX4's: the same, the sensor's switch as pulses of an output that actuator 1 drives.

    Photos at the rows of ``captures``, triggers at those of ``triggers``, each confirmed or not; None leaves
    the topic out. With ``confirms`` the camera confirms what it takes (CAM_CAP_FBACK).
    """
    topics = _ULOG | {
        name: form
        for name, form, rows_of in (
            ("camera_capture", _CAPTURE, captures),
            ("camera_trigger", _TRIGGER, triggers),
        )
        if rows_of is not None
    }
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))

    def message(kind: bytes, payload: bytes) -> None:
        out.extend(struct.pack("<HB", len(payload), kind[0]) + payload)

    for name, (form, _) in topics.items():
        message(b"F", f"{name}:{form}".encode())
    for key, value in ((f"PWM_MAIN_FUNC{servo}", 301.0), ("CAM_CAP_FBACK", float(confirms))):
        text = f"float {key}".encode()
        message(b"P", bytes([len(text)]) + text + struct.pack("<f", value))
    for number, name in enumerate(topics):
        message(b"A", struct.pack("<BH", 0, number) + name.encode())

    def put(name: str, *values: object) -> None:
        number = list(topics).index(name)
        message(b"D", struct.pack("<H", number) + struct.pack(topics[name][1], *values))

    put("home_position", 0, rows[0].amsl_m - rows[0].relative_m)
    for number, row in enumerate(rows):
        at_us = round(row.time_s * 1e6)
        put("vehicle_attitude", at_us, *_quaternion(row.roll_deg, row.pitch_deg, row.yaw_deg))
        put("vehicle_global_position", at_us, row.lat_deg, row.lon_deg, row.amsl_m)
        pulses = [0.0] * 16
        pulses[servo - 1] = 2000.0 if row.on else 1000.0
        put("actuator_outputs", at_us, 16, *pulses)
        if number in (captures or ()):
            q = _quaternion(row.roll_deg, row.pitch_deg, row.yaw_deg)
            put("camera_capture", at_us, row.lat_deg, row.lon_deg, number, row.amsl_m, *q, 1)
        if number in (triggers or {}):
            put("camera_trigger", at_us, number, int((triggers or {})[number]))
        if unix_minus_boot_s is not None:
            put("sensor_gps", at_us, round((row.time_s + unix_minus_boot_s) * 1e6))
    return bytes(out)


def _quaternion(roll_deg: float, pitch_deg: float, yaw_deg: float) -> Iterable[float]:
    (cr, sr), (cp, sp), (cy, sy) = (
        (math.cos(math.radians(a) / 2.0), math.sin(math.radians(a) / 2.0))
        for a in (roll_deg, pitch_deg, yaw_deg)
    )
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )
