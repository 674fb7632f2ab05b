"""A flown track as GPX."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from datetime import UTC, datetime

import httpx

from app.imports import ImportOptions, import_regions
from app.main import create_app
from app.services.flights.gpx import write_gpx
from app.services.records import FlightRecord, TrackSample
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.test_problems import check_problem

NS = {"g": "http://www.topografix.com/GPX/1/1"}
RECORD = FlightRecord(
    id="f1",
    vehicle_id="v1",
    vehicle_name="uav <1> & \x00co",
    plan_id=None,
    plan_vehicle=None,
    state="ended",
    started_at=datetime(2026, 5, 1, 12, 0, 0, tzinfo=UTC),
    ended_at=None,
    points=3,
)
SAMPLES = tuple(
    TrackSample(
        time_s=100.0 + 0.5 * n,
        lon_deg=8.5 + 0.001 * n * n,
        lat_deg=47.3 + 0.001 * n,
        altitude_amsl_m=None if n == 2 else 500.0 + n,
        altitude_home_m=100.0,
        heading_deg=0.0,
        roll_deg=0.0,
        ground_speed_m_s=20.0,
        mission_seq=1,
        sensor_on=False,
    )
    for n in range(4)
)


def test_places_heights_and_times_are_in_the_track() -> None:
    """Every sample is a point; times run as the vehicle's clock did; an unknown height is left out."""
    root = ElementTree.fromstring(write_gpx(RECORD, SAMPLES))
    points = root.findall("g:trk/g:trkseg/g:trkpt", NS)
    assert [(float(p.attrib["lat"]), float(p.attrib["lon"])) for p in points] == [
        (round(s.lat_deg, 7), round(s.lon_deg, 7)) for s in SAMPLES
    ]
    assert [p.findtext("g:ele", None, NS) for p in points] == ["500.00", "501.00", None, "503.00"]
    assert points[3].findtext("g:time", None, NS) == "2026-05-01T12:00:01.500Z"
    assert root.findtext("g:trk/g:name", None, NS) == "uav <1> & co"


def test_a_track_can_come_back_as_a_corridor() -> None:
    """What was flown is read by our own import as a region along the track."""
    data = write_gpx(RECORD, SAMPLES).encode()
    (feature,) = import_regions(data, ImportOptions(width_m=50.0)).collection["features"]
    assert feature["properties"]["width_m"] == 50.0
    assert feature["geometry"]["coordinates"][0] == [8.5, 47.3]
    assert len(feature["geometry"]["coordinates"]) == 4


def test_a_flight_without_a_track_is_an_empty_track() -> None:
    """No samples make no points, and the document is still whole."""
    root = ElementTree.fromstring(write_gpx(RECORD, ()))
    assert root.findall("g:trk/g:trkseg/g:trkpt", NS) == []


async def test_an_unknown_flight_is_a_problem(client: httpx.AsyncClient) -> None:
    """404 as everywhere."""
    check_problem(await client.get("/api/v1/flights/none/track.gpx"), 404)


async def test_a_stored_flight_is_handed_out(settings: Settings) -> None:
    """The route gives the stored track under GPX's media type."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        store = app.state.house.flights._store
        flight_id = await store.begin("v1", "uav-1", None, None)
        await store.add(flight_id, SAMPLES)
        answer = await client.get(f"/api/v1/flights/{flight_id}/track.gpx")
    assert answer.headers["content-type"] == "application/gpx+xml"
    points = ElementTree.fromstring(answer.text).findall("g:trk/g:trkseg/g:trkpt", NS)
    assert len(points) == len(SAMPLES)
