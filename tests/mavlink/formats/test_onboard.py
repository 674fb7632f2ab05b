"""Onboard logs: places, attitudes and the sensor's switch as they were written; broken files in words."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mavlink.encoding.options import DEFAULT_PAYLOAD
from mavlink.encoding.payload import Payload, parse_payload
from mavlink.formats import FormatError
from mavlink.formats.onboard import read_log, switch_of
from tests.mavlink.logs import Row, dataflash, ulog

BEGAN_S = 1_790_000_000.0
ROWS = [
    Row(
        100.0 + 0.2 * n,
        8.5 + 1e-5 * n,
        47.3 - 2e-5 * n,
        50.0 + n,
        450.0 + n,
        math.sin(n),
        2.0,
        30.0 * n,
        20 <= n < 60,
    )
    for n in range(100)
]

WRITTEN: list[tuple[Callable[[], bytes], Payload]] = [
    (lambda: dataflash(ROWS, unix_minus_boot_s=BEGAN_S), DEFAULT_PAYLOAD),
    (lambda: dataflash(ROWS, relay=None, servo=9, unix_minus_boot_s=BEGAN_S), parse_payload("servo:9")),
    (lambda: ulog(ROWS, unix_minus_boot_s=BEGAN_S), DEFAULT_PAYLOAD),
]


@pytest.mark.parametrize(("written", "payload"), WRITTEN)
def test_what_was_written_is_read(tmp_path: Path, written: Callable[[], bytes], payload: Payload) -> None:
    """Every place with its height and attitude, the switch at every time, the world's clock."""
    path = tmp_path / "log"
    path.write_bytes(written())
    log = read_log(path, payload)
    switch = switch_of(log, payload)
    assert switch is not None
    assert log.unix_minus_boot_s == pytest.approx(BEGAN_S, abs=1e-3)
    assert len(log.points) == len(ROWS)
    for point, row in zip(log.points, ROWS, strict=True):
        assert point.time_s == pytest.approx(row.time_s)
        assert (point.lon_deg, point.lat_deg) == pytest.approx((row.lon_deg, row.lat_deg), abs=1e-7)
        assert (point.relative_m, point.amsl_m) == pytest.approx((row.relative_m, row.amsl_m), abs=1e-3)
        assert (point.roll_deg, point.pitch_deg) == pytest.approx((row.roll_deg, row.pitch_deg), abs=1e-4)
        assert point.heading_deg is not None
        assert abs(math.remainder(point.heading_deg - row.yaw_deg, 360.0)) < 1e-3
        assert switch(row.time_s + 0.01) == row.on
        assert point.sensor_on is None


@pytest.mark.parametrize(
    ("written", "taken"),
    [
        (lambda: dataflash(ROWS, photos=(3, 40)), (3, 40)),
        # A pin tells of the photos: what was ordered and not confirmed is none.
        (lambda: dataflash(ROWS, orders=(3, 9, 40), photos=(3, 40)), (3, 40)),
        (lambda: ulog(ROWS, captures=(5, 41, 80)), (5, 41, 80)),
        (lambda: ulog(ROWS, captures=(5, 41), triggers={5: True, 30: False, 41: True}), (5, 41)),
        (lambda: ulog(ROWS, triggers={5: False, 41: False}), (5, 41)),
        (lambda: ulog(ROWS, triggers={5: True, 30: False, 41: True}, confirms=True), (5, 41)),
        (lambda: ulog(ROWS, captures=(), triggers={5: False}, confirms=True), ()),
    ],
)
def test_photos_are_where_and_as_they_were_taken(
    tmp_path: Path, written: Callable[[], bytes], taken: tuple[int, ...]
) -> None:
    """Each photo with its time, place, height and attitude; orders that no camera confirmed are none."""
    path = tmp_path / "log"
    path.write_bytes(written())
    photos = read_log(path, DEFAULT_PAYLOAD).taken
    assert [photo.index for photo in photos] == list(taken)
    for photo, row in zip(photos, (ROWS[number] for number in taken), strict=True):
        assert photo.time_s == pytest.approx(row.time_s)
        assert (photo.lon_deg, photo.lat_deg) == pytest.approx((row.lon_deg, row.lat_deg), abs=1e-7)
        assert photo.altitude_amsl_m == pytest.approx(row.amsl_m, abs=0.01)
        told = (photo.roll_rad, photo.pitch_rad)
        assert told == pytest.approx((math.radians(row.roll_deg), math.radians(row.pitch_deg)), abs=1e-4)
        assert photo.yaw_rad is not None
        assert abs(math.remainder(photo.yaw_rad - math.radians(row.yaw_deg), math.tau)) < 1e-3
        assert photo.source == "autopilot"


def test_what_the_log_does_not_tell_is_not_known(tmp_path: Path) -> None:
    """A relay that no message names, and an output whose pulses have ended."""
    path = tmp_path / "log"
    path.write_bytes(dataflash(ROWS, relay=None, servo=9))
    log = read_log(path, DEFAULT_PAYLOAD)
    assert switch_of(log, DEFAULT_PAYLOAD) is None
    assert switch_of(log, parse_payload("camera:distance=25")) is None
    switch = switch_of(log, parse_payload("servo:9"))
    assert switch is not None
    assert [switch(at_s) for at_s in (50.0, 110.0, ROWS[-1].time_s + 5.0)] == [None, True, None]
    assert log.unix_minus_boot_s is None


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 2), st.integers(0, 10**6), st.binary(max_size=30), st.floats(0.0, 1.0))
def test_broken_logs_are_told_in_words(
    tmp_path: Path, kind: int, place: int, noise: bytes, kept: float
) -> None:
    """Cut short or with bytes overwritten: what is left of it is read, or it is said that it cannot be."""
    written, payload = WRITTEN[kind]
    data = bytearray(written())
    at = place % len(data)
    data[at : at + len(noise)] = noise
    path = tmp_path / "log"
    path.write_bytes(data[: int(kept * len(data))])
    with contextlib.suppress(FormatError):
        assert read_log(path, payload).points


@pytest.mark.parametrize(
    "data", [b"", b"\xa3\x95", b"ULog\x01\x12\x35", b"no log at all, only text", bytes(4000)]
)
def test_files_that_are_no_logs_are_refused(tmp_path: Path, data: bytes) -> None:
    """Empty, a head alone, another format: named as that."""
    path = tmp_path / "log"
    path.write_bytes(data)
    with pytest.raises(FormatError):
        read_log(path, DEFAULT_PAYLOAD)
