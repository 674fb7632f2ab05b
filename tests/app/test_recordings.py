"""Recordings over HTTP: links recorded, listed, downloaded, and played back as vehicles."""

from __future__ import annotations

import asyncio
from datetime import UTC, datetime
from pathlib import Path
from xml.etree import ElementTree

import httpx
from pymavlink import mavutil

from app.main import create_app
from app.settings import Settings
from tests.app.conftest import fake_house, serving, stored
from tests.app.test_problems import check_problem
from tests.app.test_vehicles import VEHICLES, connected, until

GPX_TIME = "{http://www.topografix.com/GPX/1/1}time"


async def fly(client: httpx.AsyncClient, plan_id: str) -> str:
    """The place of a simulated vehicle that has flown a plan."""
    vehicle = await connected(client, "sim:?speedup=300&sensor_reports=no")
    mission = {"plan_id": plan_id, "payload": "servo:9"}
    uploaded = await client.post(vehicle + "/mission", json=mission)
    assert uploaded.json()["verified"]
    for command in ("arm", "start"):
        await client.post(vehicle + "/commands", json={"command": command})
    await until(client, vehicle, lambda body: body["flight_id"] is not None)
    await until(client, "/api/v1/flights", lambda body: body["flights"][0]["state"] == "ended")
    return vehicle


async def test_a_flight_is_recorded_and_flown_again_from_its_recording(
    client: httpx.AsyncClient, tmp_path: Path, plan_id: str
) -> None:
    """The recording of a flight, played as a vehicle, gives the same track; pymavlink reads it too."""
    vehicle = await fly(client, plan_id)
    logs = (await client.get(vehicle + "/logs")).json()["logs"]
    data = b"".join([(await client.get(log["url"])).content for log in logs])
    # The link goes on, and its recording grows.
    assert len(data) >= sum(log["size_bytes"] for log in logs) > 10_000
    path = tmp_path / "downloaded.tlog"
    path.write_bytes(data)
    log = mavutil.mavlogfile(str(path))
    reached = {m.seq for m in iter(lambda: log.recv_match(type="MISSION_ITEM_REACHED"), None)}
    log.f.close()
    assert len(reached) > 5
    (flown,) = (await client.get("/api/v1/flights")).json()["flights"]
    body = {"name": "again", "url": f"replay:{path}?speedup=10&plan={plan_id}&payload=servo:9"}
    again = await client.post(VEHICLES, json=body)
    assert again.status_code == 201, again.text
    assert (again.json()["replay"], again.json()["simulated"]) == (True, False)
    place = again.headers["location"]
    await until(client, "/api/v1/flights", lambda body: len(body["flights"]) == 2)
    for answer in (
        await client.post(place + "/mission", json={"plan_id": plan_id}),
        await client.get(place + "/mission"),
        await client.delete(place + "/mission"),
        await client.post(place + "/commands", json={"command": "arm"}),
    ):
        check_problem(answer, 409)
        assert "again is a recording" in answer.json()["detail"]
    flights = await until(client, "/api/v1/flights", lambda body: body["flights"][0]["state"] != "flying")
    replayed = flights["flights"][0]
    assert (replayed["vehicle_name"], replayed["plan_id"]) == ("again", plan_id)
    assert replayed["link"] == []
    assert replayed["points"] > 0.8 * flown["points"]
    track = (await client.get(replayed["links"]["track.geojson"])).json()
    assert track["features"][0]["properties"]["times_s"] == sorted(
        track["features"][0]["properties"]["times_s"]
    )
    assert "sensor_on" in [feature["properties"]["role"] for feature in track["features"]]
    assert (await client.get(place + "/logs")).json()["logs"] == []
    await client.delete(vehicle)
    assert (await client.get(vehicle + "/logs")).json()["logs"]


async def test_recordings_that_are_not_there(client: httpx.AsyncClient, tmp_path: Path) -> None:
    """Unknown vehicles, names and ways out of the folder are a 404; unknown recordings a 409, none a 422."""
    vehicle = await connected(client)
    check_problem(await client.get(VEHICLES + "/nobody/logs"), 404)
    check_problem(await client.get(vehicle + "/logs/none.tlog"), 404)
    check_problem(await client.get(vehicle + "/logs/..%2F..%2Fplans.db"), 404)
    check_problem(await client.post(VEHICLES, json={"name": "x", "url": "replay:/no.tlog"}), 409)
    check_problem(await client.post(VEHICLES, json={"name": "x", "url": "replay:"}), 422, "link-address")
    odd = {"name": "x", "url": "replay:/no.tlog?plan=p&payload=laser"}
    check_problem(await client.post(VEHICLES, json=odd), 422, "payload")


async def test_two_recordings_do_not_share_a_name(settings: Settings, plan_file: Path) -> None:
    """A name is taken at once, also while the plan that a recording flew is still being read."""
    app = create_app(settings, fake_house)
    async with serving(app) as client:
        url = f"replay:/no.tlog?plan={await stored(client, plan_file)}"
        fleet = app.state.house.fleet
        outcomes = await asyncio.gather(
            *(fleet.connect("again", f"{url}&speedup={n}") for n in (1, 2)), return_exceptions=True
        )
        said = sorted(str(outcome) for outcome in outcomes)
        assert said[1] == "there is a vehicle called again already"
        assert "no.tlog" in said[0]
        assert fleet.all() == ()


async def test_recording_can_be_switched_off(tmp_path: Path) -> None:
    """With record_links false nothing is written."""
    settings = Settings(
        database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error", record_links=False
    )
    async with serving(create_app(settings, fake_house)) as client:
        vehicle = await connected(client)
        await asyncio.sleep(0.2)
        assert (await client.get(vehicle + "/logs")).json() == {
            "vehicle_id": vehicle.rpartition("/")[2],
            "failure": None,
            "logs": [],
        }
    assert list(tmp_path.rglob("*.tlog")) == []


async def test_a_flight_of_2021_is_one_of_2021(client: httpx.AsyncClient) -> None:
    """Date, duration and GPX of a replayed flight are those of the recording, however fast it is played."""
    path = Path(__file__).parents[1] / "faults" / "21-flown-in-2021.tlog"
    body = {"name": "then", "url": f"replay:{path}?speedup=25"}
    assert (await client.post(VEHICLES, json=body)).status_code == 201
    flights = await until(
        client,
        "/api/v1/flights",
        lambda body: bool(body["flights"]) and body["flights"][0]["state"] != "flying",
    )
    (flight,) = flights["flights"]
    began, ended = (datetime.fromisoformat(flight[name]) for name in ("started_at", "ended_at"))
    # What pymavlink reads of the log: in the air from 10.4 s to 171.8 s, disarmed 176 s behind its begin. A
    # quarter of a second of a busy machine is six of them.
    assert abs((began - datetime(2021, 6, 10, 11, 0, 10, tzinfo=UTC)).total_seconds()) < 10.0
    assert abs((ended - began).total_seconds() - 163.0) < 16.0
    gpx = ElementTree.fromstring((await client.get(flight["links"]["track.gpx"])).text)
    times = [datetime.fromisoformat(node.text or "") for node in gpx.iter(GPX_TIME)]
    assert abs((times[0] - began).total_seconds()) < 0.01
    assert abs((times[-1] - ended).total_seconds()) < 8.0
