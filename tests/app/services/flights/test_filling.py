"""Gaps filled from logs over HTTP: matched by time and place, refused where they are another flight's."""

from __future__ import annotations

import math
from collections.abc import AsyncIterator, Callable, Sequence
from dataclasses import replace

import pytest
from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega
from pyproj import Geod

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.services.plans.missions import plan_of
from app.services.records import TrackSample
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.services.flights.test_refly import Flown
from tests.app.services.flights.test_sorties import BEGAN, middle_s, recorded, whole
from tests.app.test_problems import check_problem
from tests.mavlink.logs import Row, dataflash, ulog
from tests.patience import PATIENCE_S

WGS84 = Geod(ellps="WGS84")


@pytest.fixture
async def flown(settings: Settings) -> AsyncIterator[Flown]:
    """A service with the example's plan."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        record = (await client.post("/api/v1/plans", json=EXAMPLE, params={"wait": PATIENCE_S})).json()
        text = (await client.get(f"/api/v1/plans/{record['id']}/plan.geojson")).text
        yield Flown(client, app.state.house, record["id"], plan_of(text))


def courses_deg(samples: Sequence[TrackSample]) -> list[float]:
    """Where each place leads to, by the ellipsoid; the nose points there."""
    ahead = [*samples[1:], samples[-1]]
    found = [
        WGS84.inv(a.lon_deg, a.lat_deg, b.lon_deg, b.lat_deg)[0] for a, b in zip(samples, ahead, strict=True)
    ]
    return [*found[:-1], found[-2]]


def rows_of(samples: Sequence[TrackSample], clock_s: float = 0.0, north_deg: float = 0.0) -> list[Row]:
    """What the vehicle would have written aboard."""
    return [
        Row(
            s.time_s + clock_s,
            s.lon_deg,
            s.lat_deg + north_deg,
            s.altitude_home_m or 0.0,
            s.altitude_amsl_m or 0.0,
            s.roll_deg or 0.0,
            0.0,
            course,
            s.sensor_on,
        )
        for s, course in zip(samples, courses_deg(samples), strict=True)
    ]


def tlog(samples: Sequence[TrackSample]) -> bytes:
    """A recording by another station, packed by pymavlink."""
    mav = ardupilotmega.MAVLink(None, srcSystem=1, srcComponent=1)
    out = bytearray()

    def put(at_s: float, message: ardupilotmega.MAVLink_message) -> None:
        out.extend(int((BEGAN.timestamp() + at_s) * 1e6).to_bytes(8, "big") + message.pack(mav))

    for s, course in zip(samples, courses_deg(samples), strict=True):
        at_ms, place = round(s.time_s * 1000.0), (round(s.lat_deg * 1e7), round(s.lon_deg * 1e7))
        heights = (round((s.altitude_amsl_m or 0.0) * 1000.0), round((s.altitude_home_m or 0.0) * 1000.0))
        put(s.time_s, mav.heartbeat_encode(1, mavutil.mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 128, 10, 4))
        put(s.time_s, mav.relay_status_encode(at_ms, int(s.sensor_on), 1))
        put(s.time_s, mav.attitude_encode(at_ms, 0.0, 0.0, math.radians(course), 0.0, 0.0, 0.0))
        put(s.time_s, mav.global_position_int_encode(at_ms, *place, *heights, 0, 0, 0, 65535))
    return bytes(out)


KINDS: dict[str, Callable[[Sequence[TrackSample]], bytes]] = {
    "bin": lambda samples: dataflash(rows_of(samples)),
    "ulg": lambda samples: ulog(rows_of(samples)),
    "tlog": tlog,
    "bin of another clock": lambda samples: dataflash(
        rows_of(samples, clock_s=1234.5), unix_minus_boot_s=BEGAN.timestamp() - 1234.5 + 3.0
    ),
}


@pytest.mark.parametrize(("kind", "places"), [*((kind, False) for kind in KINDS), ("ulg", True)])
async def test_a_log_fills_what_was_not_recorded(flown: Flown, kind: str, places: bool) -> None:
    """Thirty seconds of a pass without a record: unknown, and seen once the log has told of them.

    So where the places were recorded, and nothing told of the sensor.
    """
    samples, middle = whole(flown), middle_s(flown, 0)
    dark = [middle - 15.0 < s.time_s < middle + 15.0 for s in samples]
    kept = [
        replace(s, sensor_on=None) if gone else s
        for s, gone in zip(samples, dark, strict=True)
        if places or not gone
    ]
    place = f"/api/v1/flights/{await recorded(flown, kept)}"
    before = (await flown.client.get(place + "/coverage.geojson")).json()
    assert max(before["unknown_coverage"].values()) > 0.05
    data = KINDS[kind](samples)
    filled = await flown.client.post(place + "/log", params={"name": kind}, content=data)
    assert filled.status_code == 200, filled.text
    assert (len(filled.json()["filled"]), filled.json()["left"]) == (1, [])
    after = (await flown.client.get(place + "/coverage.geojson")).json()
    assert min(after["coverage"].values()) >= 0.995
    assert after["gaps"] == []
    assert (await flown.client.get(place)).json()["logs"] == [kind]
    again = (await flown.client.post(place + "/log", content=data)).json()
    assert (again["filled"], again["points"]) == ([], 0)
    track = (await flown.client.get(place + "/track.geojson")).json()["features"][0]["properties"]
    assert track["times_s"] == sorted(track["times_s"])
    assert 100 < sum(track["from_log"]) < 200


async def test_the_end_of_an_interrupted_flight_is_in_the_log(flown: Flown) -> None:
    """A restart after the first pass: all behind it is unknown, and known by the log."""
    samples = whole(flown)
    cut_s = flown.plan.collects[0].end_m / 20.0 + 5.0
    flight_id = await recorded(flown, [s for s in samples if s.time_s < cut_s], "interrupted")
    place = f"/api/v1/flights/{flight_id}"
    told = (await flown.client.get(place + "/coverage.geojson")).json()
    assert sum(told["unknown_coverage"].values()) > 0.5
    filled = await flown.client.post(place + "/log", content=dataflash(rows_of(samples)))
    assert filled.json()["filled"] == [{"start_s": pytest.approx(cut_s, abs=1.0), "end_s": None}]
    told = (await flown.client.get(place + "/coverage.geojson")).json()
    assert min(told["coverage"].values()) >= 0.995


async def test_logs_of_other_flights_and_no_logs_are_refused(flown: Flown) -> None:
    """A kilometre aside, at other times, or no log: 422 with the rule; nothing is filled."""
    samples, middle = whole(flown), middle_s(flown, 0)
    place = f"/api/v1/flights/{await recorded(flown, [s for s in samples if abs(s.time_s - middle) > 15.0])}"
    for data, rule in [
        (dataflash(rows_of(samples, north_deg=0.01)), "not-this-flight"),
        (dataflash(rows_of(samples, clock_s=1e5)), "not-this-flight"),
        (dataflash(rows_of(samples[:3])), "not-this-flight"),
        (b"not a log", "log-unreadable"),
        (b"", "log-unreadable"),
    ]:
        check_problem(await flown.client.post(place + "/log", content=data), 422, rule)
    assert (await flown.client.get(place)).json()["logs"] == []
    check_problem(await flown.client.post("/api/v1/flights/none/log", content=b"x"), 404)


async def test_a_log_that_does_not_tell_of_the_sensor_leaves_the_gap(flown: Flown) -> None:
    """Without the relay's state nothing is filled, and the answer says why; what is unknown stays so."""
    samples, middle = whole(flown), middle_s(flown, 0)
    place = f"/api/v1/flights/{await recorded(flown, [s for s in samples if abs(s.time_s - middle) > 15.0])}"
    answer = (await flown.client.post(place + "/log", content=dataflash(rows_of(samples), relay=None))).json()
    assert answer["filled"] == []
    assert "what switches the sensor" in answer["left"][0]["why"]
    short = [row for row in rows_of(samples) if not middle < row.time_s < middle + 9.0]
    answer = (await flown.client.post(place + "/log", content=dataflash(short))).json()
    assert "no places over the whole of it" in answer["left"][0]["why"]
    told = (await flown.client.get(place + "/coverage.geojson")).json()
    assert max(told["unknown_coverage"].values()) > 0.05
