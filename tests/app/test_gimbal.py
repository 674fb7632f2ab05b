"""A gimbal from the request to the vehicle: exported, uploaded, judged by the plan's sensor, remembered."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.routers.bodies import EXAMPLE
from app.services.vehicles.pointing import pointing_findings
from app.settings import Settings
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.encoding.gimbal import parse_gimbal
from mavlink.encoding.payload import RelayPayload
from mavlink.rules.table import needs_of
from mavlink.wire.items import Command
from tests.app.conftest import stored
from tests.app.test_problems import check_problem
from tests.app.test_restart import VEHICLES, add, autopilot, free_port, held_plan, service, until
from tests.app.test_vehicles import connected
from tests.mavlink.cameras import with_photos
from tests.mavlink.plans import make_plan

RADAR = {"name": "sar", "type": "sar", "incidence_deg": 45.0}


def commands(rows: str) -> list[str]:
    return [row.split("\t")[3] for row in rows.splitlines()[1:]]


async def test_files_hold_the_pointing_asked_for(client: httpx.AsyncClient, plan_id: str) -> None:
    """One pointing and the neutral position, by either command; none means none, nonsense is refused."""
    base = f"/api/v1/plans/{plan_id}/mission.waypoints"
    for gimbal, command in (("manager:tilt=45", "1000"), ("mount:tilt=45", "205")):
        rows = commands((await client.get(base, params={"gimbal": gimbal})).text)
        assert rows.count(command) >= 2
    bolted = (await client.get(base)).text
    assert (await client.get(base, params={"gimbal": "none"})).text == bolted
    assert not {"1000", "205"} & set(commands(bolted))
    check_problem(await client.get(base, params={"gimbal": "manager"}), 422, "gimbal")


@pytest.mark.parametrize("kind", ["ardupilot", "px4"])
async def test_an_upload_with_a_gimbal_is_held_and_ready(
    client: httpx.AsyncClient, plan_file: Path, kind: str
) -> None:
    """Read back equal; the check before flight says how the sensor is held, and misses no parameter."""
    plan_id = await stored(client, plan_file, EXAMPLE)
    vehicle = await connected(client, f"sim:?speedup=20&autopilot={kind}")
    body = {"plan_id": plan_id, "gimbal": "manager:tilt=45"}
    report = (await client.post(vehicle + "/mission", json=body | {"parts": ["mission", "fence"]})).json()
    assert report["verified"], report
    assert report["preflight"]["ready"], report["preflight"]
    check = {check["name"]: check for check in report["preflight"]["checks"]}
    assert (check["gimbal"]["status"], "45° from straight down" in check["gimbal"]["detail"]) == ("ok", True)
    assert "MNT" not in check["parameters"]["detail"], check["parameters"]
    held = (await client.get(vehicle + "/mission")).json()["parts"]["mission"]
    assert [item["command"] for item in held].count(Command.DO_GIMBAL_MANAGER_PITCHYAW) >= 2
    without = (await client.post(vehicle + "/preflight", json={"plan_id": plan_id})).json()
    mission = next(check for check in without["checks"] if check["name"] == "mission")
    assert mission["status"] == "failed", "a mission without the gimbal is another mission"


async def test_a_radar_held_aside_of_its_swath_is_refused(client: httpx.AsyncClient, plan_file: Path) -> None:
    """The example's radar looks 45° from straight down: 30° is refused, with what to write."""
    plan_id = await stored(client, plan_file, EXAMPLE)
    vehicle = await connected(client)
    body = {"plan_id": plan_id, "gimbal": "manager:tilt=30"}
    answer = await client.post(vehicle + "/mission", json=body)
    check_problem(answer, 422, "gimbal-tilt")
    (error,) = answer.json()["errors"]
    assert "tilt=45" in error["fix"]
    checked = (await client.post(vehicle + "/preflight", json=body)).json()
    gimbal = next(check for check in checked["checks"] if check["name"] == "gimbal")
    assert gimbal["status"] == "failed"
    assert not checked["ready"]


async def test_a_mission_with_a_gimbal_is_recognised_after_a_restart(
    settings: Settings, plan_file: Path
) -> None:
    """What is read back is compared with the plan as it was sent, gimbal and all."""
    url = f"127.0.0.1:{free_port()}"
    async with autopilot(f"udpout:{url}"):
        async with service(settings) as client:
            vehicle = await add(client, "uav", f"udpin:{url}")
            plan_id = await stored(client, plan_file)
            body = {"plan_id": plan_id, "gimbal": "mount:tilt=45"}
            report = await client.post(f"{VEHICLES}/{vehicle['id']}/mission", json=body)
            assert report.json()["verified"], report.text
        async with service(settings) as client:
            assert (await until(client, lambda body: body["plan_id"] is not None))["plan_id"] == plan_id
    assert held_plan(settings) == plan_id


def rules(gimbal: str, sensor: dict[str, Any], wind: dict[str, float] | None = None) -> list[tuple[str, str]]:
    """Rule and severity of what is found."""
    plan = make_plan()
    mission = encode(plan, options=EncodeOptions(gimbal=parse_gimbal(gimbal)))
    needs = needs_of(plan, mission, RelayPayload(0))
    scenario = {"sensors": [sensor, {"name": "other", "type": "sar", "incidence_deg": 10.0}], "wind": wind}
    return [(found.rule, found.severity) for found in pointing_findings(plan, scenario, mission, needs)]


def test_the_tilt_is_that_of_the_sensor_flown_with() -> None:
    """Half a degree is what ArduPilot rounds; sensors that no pass uses do not count, nor do unknown ones."""
    assert rules("manager:tilt=45", RADAR) == []
    assert rules("manager:tilt=45", RADAR | {"incidence_deg": 45.5}) == []
    assert rules("manager:tilt=45", RADAR | {"incidence_deg": 46.0}) == [("gimbal-tilt", "error")]
    assert rules("manager:tilt=45", {"name": "sar", "type": "camera"}) == []
    assert rules("none", RADAR | {"incidence_deg": 46.0}) == []


@pytest.mark.parametrize(
    ("yaw", "stabilised", "found"),
    [("vehicle", False, 0), ("vehicle", True, 1), ("course", False, 1), ("course", True, 0)],
)
def test_in_wind_the_yaw_is_held_as_planned(yaw: str, stabilised: bool, found: int) -> None:
    """An antenna planned as turning with the nose is not kept abeam, nor the other way round."""
    sensor, gimbal = RADAR | {"stabilised": stabilised}, f"manager:tilt=45,yaw={yaw}"
    assert rules(gimbal, sensor, {"speed_m_s": 8.0, "from_deg": 270.0}) == [("gimbal-yaw", "warning")] * found
    assert rules(gimbal, sensor, {"speed_m_s": 0.0}) == []
    assert rules(gimbal, sensor) == []


def test_a_cameras_tilt_is_the_plans() -> None:
    """Forwards or backwards, as many degrees from straight down."""
    for planned_deg, said_deg, found in ((30.0, 30, []), (-30.0, 30, []), (0.0, 30, ["gimbal-tilt"])):
        plan = with_photos(make_plan())
        plan = replace(plan, cameras=(replace(plan.cameras[0], tilt_deg=planned_deg),))
        mission = encode(plan, options=EncodeOptions(gimbal=parse_gimbal(f"manager:tilt={said_deg}")))
        needs = needs_of(plan, mission, RelayPayload(0))
        scenario = {"sensors": [{"name": "eye", "type": "camera"}]}
        assert [each.rule for each in pointing_findings(plan, scenario, mission, needs)] == found
