"""Photos as the proof that a camera worked: on between photos, and each missing one named by its pass."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.services.flights.photos import Spacing, photos_of, spacing_of, switched_by_photos
from app.services.plans.missions import plan_of
from app.services.records import FlightEvent, TrackSample
from app.services.store.flights import FlightStore
from app.settings import Settings
from planner.frames import LocalFrame
from planner.plan import Plan
from tests.app.conftest import fake_house, serving
from tests.app.services.flights.test_refly import SCENARIO, Flown, track_of
from tests.app.test_problems import check_problem
from tests.patience import PATIENCE_S

FRAME = LocalFrame(-117.75, 33.5)
SPEED_M_S = 20.0
SPACING_M = 25.0


def sample(time_s: float) -> TrackSample:
    """A place of a flight due east."""
    lon_deg, lat_deg = FRAME.to_wgs84((SPEED_M_S * time_s, 0.0))
    return TrackSample(
        time_s, float(lon_deg), float(lat_deg), 500.0, 500.0, 90.0, 3.0, SPEED_M_S, None, False
    )


def photo(index: int, time_s: float) -> FlightEvent:
    """A photo taken on the same flight."""
    place = sample(time_s)
    return FlightEvent(time_s, "photo", "camera", index, place.lon_deg, place.lat_deg, roll_deg=1.0)


def on_s(samples: tuple[TrackSample, ...]) -> list[tuple[float, float]]:
    """When the sensor was on, from and to."""
    runs: list[list[float]] = [[]]
    for each in samples:
        if each.sensor_on:
            runs[-1].append(each.time_s)
        elif runs[-1]:
            runs.append([])
    return [(run[0], run[-1]) for run in runs if run]


@pytest.mark.parametrize(
    ("payload", "spacing"),
    [
        (None, None),
        ("relay:0", None),
        ("servo:9", None),
        ("camera:distance=25", Spacing(distance_m=25.0)),
        ("image:interval=2", Spacing(interval_s=2.0)),
    ],
)
def test_payloads_that_take_photos(payload: str | None, spacing: Spacing | None) -> None:
    """Those ordered by distance and by interval, no others."""
    assert spacing_of(payload) == spacing


@pytest.mark.parametrize("spacing", [Spacing(distance_m=SPACING_M), Spacing(interval_s=1.25)])
@given(
    missing=st.sets(st.integers(1, 38), max_size=6),
    every_s=st.sampled_from([0.2, 1.0, 7.0]),
)
def test_on_is_from_photo_to_photo_until_one_is_missing(
    spacing: Spacing, missing: set[int], every_s: float
) -> None:
    """Forty photos 25 m apart, some missing: on between neighbours, off where one is missing between two.

    Whatever places that adds, the aircraft was there at their time.
    """
    samples = [sample(t) for t in np.arange(0.0, 70.0, every_s)]
    taken = [n for n in range(40) if n not in missing]
    photos = [photo(n, 10.0 + 1.25 * n) for n in taken]
    expected, run = [], [taken[0]]
    for number in taken[1:]:
        if number == run[-1] + 1:
            run.append(number)
            continue
        expected.append(run)
        run = [number]
    expected.append(run)
    wanted = [(10.0 + 1.25 * r[0], 10.0 + 1.25 * r[-1]) for r in expected if len(r) > 1]
    made = switched_by_photos(samples, photos, spacing)
    assert all(each.lon_deg == pytest.approx(sample(each.time_s).lon_deg, abs=1e-9) for each in made)
    found = [times for times in on_s(made) if times[1] > times[0]]
    assert len(found) == len(wanted)
    assert np.allclose(found, wanted)


def test_without_photos_nobody_knows_of_any() -> None:
    """A shutter that was ordered is no photo; photos without a place are none either."""
    ordered = [replace(sample(t), sensor_on=True) for t in (1.0, 2.0)]
    placeless = photos_of([FlightEvent(1.0, "photo", "camera", 1), FlightEvent(1.0, "on", "camera")])
    assert placeless == ()
    made = switched_by_photos(ordered, placeless, Spacing(distance_m=SPACING_M))
    assert {each.sensor_on for each in made} == {None}


def photos_along(plan: Plan, taken: Callable[[int, float], bool]) -> list[FlightEvent]:
    """A photo every 25 m of each collect, but where not ``taken(seq, metres into it)``."""
    made = []
    for each in track_of(plan, lambda seq, along_m: False):
        along_m = each.time_s * SPEED_M_S
        for collect in plan.collects:
            into_m = along_m - collect.start_m
            near = into_m % SPACING_M < 5.0 and 0.0 <= into_m <= collect.end_m - collect.start_m
            if near and taken(collect.seq, into_m):
                place = (each.lon_deg, each.lat_deg, each.altitude_amsl_m, each.altitude_home_m)
                made.append(FlightEvent(each.time_s, "photo", "camera", len(made), *place, 90.0, 1.0, 2.0))
    return made


@pytest.fixture
async def flown(settings: Settings) -> AsyncIterator[Flown]:
    """A service with the example's plan."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        record = (await client.post("/api/v1/plans", json=EXAMPLE, params={"wait": PATIENCE_S})).json()
        text = (await client.get(f"/api/v1/plans/{record['id']}/plan.geojson")).text
        yield Flown(client, app.state.house, record["id"], plan_of(text))


async def photographed(flown: Flown, taken: Callable[[int, float], bool], payload: str) -> str:
    """The place of a flight along the plan whose camera took these photos; its switch was on all along."""
    store = FlightStore(flown.house.database)
    name = flown.plan.vehicles[0].name
    flight_id = await store.begin("vehicle", "uav", flown.plan_id, name, payload)
    await store.add(flight_id, track_of(flown.plan, lambda seq, along_m: False))
    await store.add_events(flight_id, photos_along(flown.plan, taken))
    await store.end(flight_id, "ended")
    return f"/api/v1/flights/{flight_id}"


async def test_photos_missing_are_named_by_pass(flown: Flown) -> None:
    """The switch was on all the time; the photos tell which part of which pass was not taken."""
    first = flown.plan.collects[0]
    length_m = first.end_m - first.start_m
    metres, seconds = "camera:distance=25", "image:interval=1.25"
    for payload, taken, state, gap in [
        (metres, lambda seq, into_m: True, "ok", None),
        (seconds, lambda seq, into_m: seq != first.seq, "missed", (0.0, length_m)),
        (metres, lambda seq, into_m: seq != first.seq or into_m > 100.0, "late", (0.0, 112.5)),
        (seconds, lambda seq, into_m: seq != first.seq or into_m < 100.0, "early", (88.0, length_m)),
        (
            metres,
            lambda seq, into_m: seq != first.seq or not 90.0 < into_m < 210.0,
            "interrupted",
            (87.5, 225.0),
        ),
    ]:
        place = await photographed(flown, taken, payload)
        record = (await flown.client.get(place)).json()
        assert record["payload"] == payload
        coverage = (await flown.client.get(place + "/coverage.geojson")).json()
        triggers = {trigger["seq"]: trigger for trigger in coverage["triggers"]}
        trigger = triggers.pop(first.seq)
        assert {other["state"] for other in triggers.values()} == {"ok"}
        assert trigger["state"] == state
        assert trigger["photos_expected"] == int(length_m // SPACING_M) + 1
        if gap is None:
            assert trigger["photo_gaps"] == []
            assert abs(trigger["photos_taken"] - trigger["photos_expected"]) <= 1
            continue
        assert trigger["photos_taken"] < trigger["photos_expected"] - 3
        assert trigger["photo_gaps"] == [pytest.approx(gap, abs=13.0)]
        assert min(coverage["coverage"][name] for name in first.regions) < 0.9
        page = (await flown.client.get(place + "/report.html")).text
        assert f"of {trigger['photos_expected']}" in page


async def test_photos_are_in_the_track(flown: Flown) -> None:
    """Each with place, height, attitude, time and number."""
    place = await photographed(flown, lambda seq, into_m: True, "camera:distance=25")
    track = (await flown.client.get(place + "/track.geojson")).json()
    photos = [f for f in track["features"] if f["properties"]["role"] == "photo"]
    assert len(photos) == (await flown.client.get(place)).json()["photos"] > 20
    told = photos[3]["properties"]
    assert (told["index"], told["heading_deg"], told["roll_deg"], told["pitch_deg"]) == (3, 90.0, 1.0, 2.0)
    assert photos[3]["geometry"]["coordinates"][2] == flown.plan.altitude_m
    on = [f["properties"] for f in track["features"] if f["properties"]["role"] == "sensor_on"]
    assert len(on) == len(flown.plan.collects)
    assert on[0]["start_s"] == photos[0]["properties"]["time_s"]


async def test_photos_of_a_sensor_that_is_no_camera_are_told_and_judge_nothing(flown: Flown) -> None:
    """Beside a relay a camera may work too: the relay says whether the sensor was on."""
    place = await photographed(flown, lambda seq, into_m: False, "relay:0")
    coverage = (await flown.client.get(place + "/coverage.geojson")).json()
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}
    assert {trigger["photos_expected"] for trigger in coverage["triggers"]} == {None}
    check_problem(await flown.client.post(place + "/refly"), 409)
    assert all(region["seen"] for region in coverage["regions"])
    assert len(coverage["regions"]) == len(SCENARIO.regions)
