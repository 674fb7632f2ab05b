"""Flights that were split, records with gaps, sensors left on: what is told of them over HTTP."""

from __future__ import annotations

from collections.abc import AsyncIterator, Sequence
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import update

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.services.plans.missions import plan_of
from app.services.records import FlightState, FlownEnergy, TrackSample
from app.services.store.flights import FlightStore
from app.services.store.tables import FlightRow
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.services.flights.test_phases import recorded as along
from tests.app.services.flights.test_refly import Flown, track_of
from tests.app.test_problems import check_problem
from tests.patience import PATIENCE_S
from tests.planner.scenarios import small

BEGAN = datetime(2026, 5, 1, 12, 0, tzinfo=UTC)


@pytest.fixture
async def flown(settings: Settings) -> AsyncIterator[Flown]:
    """A service with the example's plan."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        record = (await client.post("/api/v1/plans", json=EXAMPLE, params={"wait": PATIENCE_S})).json()
        text = (await client.get(f"/api/v1/plans/{record['id']}/plan.geojson")).text
        yield Flown(client, app.state.house, record["id"], plan_of(text))


def whole(flown: Flown) -> list[TrackSample]:
    """The plan flown exactly."""
    return track_of(flown.plan, lambda seq, along_m: False)


async def recorded(flown: Flown, samples: Sequence[TrackSample], state: FlightState = "ended") -> str:
    """The id of a flight with a track, begun when its first place says."""
    store = FlightStore(flown.house.database)
    flight_id = await store.begin("vehicle", "uav", flown.plan_id, flown.plan.vehicles[0].name)
    await store.add(flight_id, samples)
    await store.end(flight_id, state)
    began = BEGAN + timedelta(seconds=samples[0].time_s)
    async with flown.house.database.writing() as session:
        await session.execute(update(FlightRow).where(FlightRow.id == flight_id).values(started_at=began))
    return flight_id


def middle_s(flown: Flown, number: int) -> float:
    """When the middle of a collect is flown, by the track's clock."""
    collect = flown.plan.collects[number]
    return (collect.start_m + collect.end_m) / 2.0 / 20.0


@pytest.mark.parametrize("gap_s", [12.0, 200.0])
async def test_a_gap_is_named_with_its_time_neither_seen_nor_missed(flown: Flown, gap_s: float) -> None:
    """Seconds of silence in a pass: unknown ground there, an unknown trigger, the gap in the report."""
    middle = middle_s(flown, 0)
    kept = [s for s in whole(flown) if not middle - gap_s / 2.0 < s.time_s < middle + gap_s / 2.0]
    flight_id = await recorded(flown, kept)
    place = f"/api/v1/flights/{flight_id}"
    told = (await flown.client.get(place + "/coverage.geojson")).json()
    (gap,) = told["gaps"]
    assert gap["duration_s"] == pytest.approx(gap_s, abs=0.6)
    began = datetime.fromisoformat(gap["start_at"])
    assert began == BEGAN + timedelta(seconds=gap["start_s"])
    first = flown.plan.collects[0]
    trigger = next(t for t in told["triggers"] if t["seq"] == first.seq)
    assert trigger["state"] == "unknown"
    assert 0.0 < trigger["unknown_m"] <= first.end_m - first.start_m + 1.0
    for name in first.regions:
        assert told["unknown_coverage"][name] > 0.02
        assert told["coverage"][name] + told["unknown_coverage"][name] <= 1.0 + 1e-9
        assert told["coverage"][name] < 0.995
    assert {f["properties"]["role"] for f in told["features"]} >= {"seen", "unknown"}
    page = (await flown.client.get(place + "/report.html")).text
    assert "Not recorded" in page
    assert gap["start_at"][:19].replace("T", " ") in page
    # What nobody knows is planned again.
    again = await flown.client.post(place + "/refly", params={"wait": PATIENCE_S})
    assert again.status_code == 202


async def test_a_sensor_that_nothing_told_of_is_unknown(flown: Flown) -> None:
    """Of a whole pass: unknown to the trigger, to the ground and in the track; none of it is missed."""
    first = flown.plan.collects[0]
    start_s, end_s = first.start_m / 20.0 - 5.0, first.end_m / 20.0 + 5.0
    samples = [replace(s, sensor_on=None) if start_s < s.time_s < end_s else s for s in whole(flown)]
    place = f"/api/v1/flights/{await recorded(flown, samples)}"
    told = (await flown.client.get(place + "/coverage.geojson")).json()
    assert [t["state"] for t in told["triggers"]] == ["unknown", *["ok"] * (len(told["triggers"]) - 1)]
    assert told["gaps"] == []
    for region in told["regions"]:
        assert region["fraction"] + region["unknown_fraction"] == pytest.approx(1.0, abs=1e-3)
    assert all(told["unknown_coverage"][name] > 0.1 for name in first.regions)
    track = (await flown.client.get(place + "/track.geojson")).json()["features"][0]["properties"]
    assert set(track["sensor_on"]) == {True, False, None}


async def test_parts_of_a_split_flight_are_one_sortie(flown: Flown) -> None:
    """Cut by a restart between two passes: each part leaves ground out, both together nothing."""
    collects = flown.plan.collects
    cut_s = (collects[0].end_m + collects[1].start_m) / 2.0 / 20.0
    samples = whole(flown)
    parts = [s for s in samples if s.time_s <= cut_s], [s for s in samples if s.time_s > cut_s]
    ids = [await recorded(flown, parts[0], "interrupted"), await recorded(flown, parts[1])]
    alone = [(await flown.client.get(f"/api/v1/flights/{one}/coverage.geojson")).json() for one in ids]
    assert all(min(told["coverage"].values()) < 0.995 for told in alone)
    # Of the first, nobody knows what came after; of the second everything is known.
    assert alone[0]["gaps"][0]["end_s"] is None
    assert {t["state"] for t in alone[0]["triggers"]} == {"ok", "unknown"}
    assert "missed" in {t["state"] for t in alone[1]["triggers"]}
    together = (await flown.client.get(f"/api/v1/plans/{flown.plan_id}/coverage")).json()
    assert together["flights"] == ids
    assert min(together["coverage"].values()) >= 0.995
    assert {t["state"] for t in together["triggers"]} == {"ok"}
    for place in (f"/api/v1/plans/{flown.plan_id}", f"/api/v1/flights/{ids[1]}"):
        check_problem(await flown.client.post(place + "/refly"), 409)


async def test_a_pass_lost_between_two_parts_is_unknown_until_it_is_flown(flown: Flown) -> None:
    """A restart over a whole pass: its ground is unknown, by the plan's coverage too, and planned again."""
    first = flown.plan.collects[0]
    start_s, end_s = first.start_m / 20.0 - 5.0, first.end_m / 20.0 + 5.0
    samples = whole(flown)
    ids = [
        await recorded(flown, [s for s in samples if s.time_s < start_s], "interrupted"),
        await recorded(flown, [s for s in samples if s.time_s > end_s]),
    ]
    told = (await flown.client.get(f"/api/v1/plans/{flown.plan_id}/coverage")).json()
    assert next(t for t in told["triggers"] if t["seq"] == first.seq)["state"] == "unknown"
    (gap,) = told["gaps"]
    assert (gap["flight"], gap["duration_s"]) == (ids[0], pytest.approx(end_s - start_s, abs=1.0))
    assert all(told["unknown_coverage"][name] > 0.1 for name in first.regions)
    again = await flown.client.post(f"/api/v1/plans/{flown.plan_id}/refly", params={"wait": PATIENCE_S})
    assert again.json()["state"] == "done"
    await recorded(flown, [s for s in samples if start_s - 10.0 < s.time_s < end_s + 10.0])
    told = (await flown.client.get(f"/api/v1/plans/{flown.plan_id}/coverage")).json()
    assert min(told["coverage"].values()) >= 0.995


async def test_a_sensor_left_on_in_a_turn_is_shown_and_not_counted(flown: Flown) -> None:
    """Banked by 61° outside the passes, sensor on: nothing is seen by it, and it is told where and why."""

    def left_on(sample: TrackSample) -> TrackSample:
        return sample if sample.sensor_on else replace(sample, sensor_on=True, roll_deg=61.0)

    exact = await recorded(flown, whole(flown))
    place = f"/api/v1/flights/{await recorded(flown, [left_on(s) for s in whole(flown)])}"
    told = (await flown.client.get(place + "/coverage.geojson")).json()
    plain = (await flown.client.get(f"/api/v1/flights/{exact}/coverage.geojson")).json()
    assert told["coverage"] == pytest.approx(plain["coverage"], abs=1e-3)
    assert plain["not_counted"] == []
    assert {one["reason"] for one in told["not_counted"]} == {"bank"}
    lines = [f for f in told["features"] if f["properties"]["role"] == "not_counted"]
    assert [line["geometry"]["type"] for line in lines] == ["LineString"] * len(told["not_counted"])
    assert "banked by more than 10°" in (await flown.client.get(place + "/report.html")).text


async def test_energy_stands_beside_the_plans(flown: Flown) -> None:
    """What batteries told, in the flight's record, the coverage and the report."""
    flight_id = await recorded(flown, whole(flown))
    await FlightStore(flown.house.database).draw(flight_id, FlownEnergy(123.4, "counted", True))
    place = f"/api/v1/flights/{flight_id}"
    record = (await flown.client.get(place)).json()
    assert record["energy"] == {"used_wh": 123.4, "source": "counted", "complete": True}
    (energy,) = (await flown.client.get(place + "/coverage.geojson")).json()["energy"]
    assert (energy["drawn_wh"], energy["planned_wh"]) == (123.4, flown.plan.paths[0].energy_wh)
    assert "123.4 Wh drawn" in (await flown.client.get(place + "/report.html")).text


async def test_plans_that_were_not_flown_have_no_coverage(flown: Flown) -> None:
    """A 404 for a plan there is not, a 409 for one that nobody flew."""
    check_problem(await flown.client.get("/api/v1/plans/none/coverage"), 404)
    check_problem(await flown.client.get(f"/api/v1/plans/{flown.plan_id}/coverage"), 409)
    check_problem(await flown.client.post(f"/api/v1/plans/{flown.plan_id}/refly"), 409)


async def test_a_later_sortie_is_held_against_its_own_passes(settings: Settings) -> None:
    """Of a mission in several flights each has its own phases, passes and energy, flown in their times."""
    document = small()
    document["vehicles"][0] |= {"max_items": 25, "cruise_power_w": 200.0}
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        record = (await client.post("/api/v1/plans", json=document, params={"wait": PATIENCE_S})).json()
        assert record["state"] == "done", record
        plan = plan_of((await client.get(f"/api/v1/plans/{record['id']}/plan.geojson")).text)
        assert [path.sortie for path in plan.paths] == [1, 2]
        store = FlightStore(app.state.house.database)
        told = []
        for path in plan.paths:
            flight_id = await store.begin(
                "vehicle", "uav", record["id"], path.vehicle, plan_sortie=path.sortie
            )
            await store.add(flight_id, [replace(at, sensor_on=True) for at in along(path, 1.0)])
            await store.end(flight_id, "ended")
            place = f"/api/v1/flights/{flight_id}"
            assert (await client.get(place)).json()["plan_sortie"] == path.sortie
            told.append((await client.get(place + "/coverage.geojson")).json())
        together = (await client.get(f"/api/v1/plans/{record['id']}/coverage")).json()
    switched = [(collect.vehicle, collect.seq) for collect in plan.collects]
    assert [(t["vehicle"], t["seq"]) for t in together["triggers"]] == switched
    for path, each in zip(plan.paths, told, strict=True):
        seqs = [collect.seq for collect in plan.of(path.vehicle, path.sortie).collects]
        assert 0 < len(seqs) < len(plan.collects)
        assert [(t["seq"], t["state"]) for t in each["triggers"]] == [(seq, "ok") for seq in seqs]
        assert [collect["seq"] for collect in each["collects"]] == seqs
        assert [p["kind"] for p in each["phases"]] == [p.kind for p in path.phases]
        for phase, own in zip(each["phases"], path.phases, strict=True):
            assert phase["planned_s"] == pytest.approx(own.end_s - own.start_s)
            assert phase["flown_s"] == pytest.approx(phase["planned_s"], abs=4.0)
        (energy,) = each["energy"]
        assert energy["planned_wh"] == pytest.approx(path.energy_wh, rel=1e-3)
    assert plan.paths[0].energy_wh != pytest.approx(plan.paths[1].energy_wh, rel=1e-2)
