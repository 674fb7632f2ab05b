"""A flight in a real PX4 through the service alone: what its sensor did shows in its output, or in photos.

Skipped unless ``SWATHPLAN_PX4`` names the simulator's binary and ``SWATHPLAN_PX4_ROMFS`` its ``etc`` folder.
"""

from __future__ import annotations

import asyncio
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.flows.px4 import (
    AEROPLANE,
    BINARY,
    FIRST_PORT,
    MULTIROTOR,
    NOT_NEEDED,
    PARAMETERS,
    READY_S,
    ROMFS,
    SET_INTERVAL,
    free_instance,
    has_module,
    px4,
)
from tests.patience import PATIENCE_S

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(
        not (BINARY and ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
    ),
]

SPEEDUP = 10.0
#: The simulator's small aeroplane, with some straight flight before each collect, and its multirotor.
VEHICLES = {
    AEROPLANE: {"airspeed_m_s": 14.0, "min_turn_radius_m": 100.0, "settle_m": 150.0},
    MULTIROTOR: {"type": "multirotor", "airspeed_m_s": 10.0, "min_turn_radius_m": 30.0},
}
#: Triggers by distance have to be there at the start; the last photo falls short of a pass's end.
CAMERA = {"TRIG_MODE": 4.0, "TRIG_INTERFACE": 3.0}
MARGINS = {"pointing_margin_deg": 2.0, "position_margin_m": 5.0}


async def until(client: httpx.AsyncClient, path: str, ready: Callable[[Any], bool], within_s: float) -> Any:
    """What stands at a path once it is ready."""
    async with asyncio.timeout(within_s):
        while not ready(body := (await client.get(path)).json()):
            await asyncio.sleep(0.2)
    return body


@pytest.mark.parametrize(
    ("airframe", "payload", "parameters", "least_seen"),
    [
        (AEROPLANE, None, {}, 0.99),
        (AEROPLANE, "camera:distance=10", CAMERA, 0.95),
        pytest.param(
            MULTIROTOR,
            "camera:distance=10",
            CAMERA,
            0.95,
            marks=pytest.mark.skipif(
                bool(BINARY) and not has_module("mc_rate_control"),
                reason="the simulator was built without multirotors",
            ),
        ),
    ],
    ids=["output", "photos", "multirotor-photos"],
)
async def test_what_px4_saw_is_known_to_the_service(
    tmp_path: Path, airframe: str, payload: str | None, parameters: Mapping[str, float], least_seen: float
) -> None:
    """Planned, uploaded, flown and judged over HTTP: every trigger in order, every region seen."""
    scenario = json.loads(json.dumps(EXAMPLE))
    scenario["vehicles"][0].update({"autopilot": "px4", **VEHICLES[airframe]})
    scenario["sensors"][0].update(MARGINS)
    settings = Settings(database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error")
    app = create_app(settings, fake_house)
    instance = free_instance()
    (tmp_path / "px4").mkdir()
    async with serving(app) as client:
        record = (await client.post("/api/v1/plans", json=scenario, params={"wait": PATIENCE_S})).json()
        assert record["state"] == "done", record
        plan = (await client.get(record["links"]["plan.geojson"])).json()
        home = next(f for f in scenario["features"] if f["properties"]["role"] == "start")
        lon_deg, lat_deg = home["geometry"]["coordinates"][:2]
        set_up = {**PARAMETERS, **parameters}
        with px4(tmp_path / "px4", instance, (lon_deg, lat_deg), SPEEDUP, set_up, airframe):
            body = {"name": "px4", "url": f"udpin:127.0.0.1:{FIRST_PORT + instance}", "timeout_s": 30}
            answer = await client.post("/api/v1/vehicles", json=body)
            assert answer.json()["connected"], answer.text
            vehicle = answer.headers["location"]
            await until(client, vehicle, lambda b: b["state"]["home_lat_deg"] is not None, READY_S)
            (known,) = app.state.house.fleet.all()
            for message_id in NOT_NEEDED:
                await known.client.command(SET_INTERVAL, (float(message_id), -1.0))
            mission = {"plan_id": record["id"], "parts": ["mission", "fence"], "payload": payload}
            report = (await client.post(vehicle + "/mission", json=mission)).json()
            assert (report["outcome"], report["verified"]) == ("accepted", True), report
            async with asyncio.timeout(READY_S):
                # Until position and attitude have settled it says no.
                while (
                    await client.post(vehicle + "/commands", json={"command": "start", "arm_first": True})
                ).status_code != 200:
                    await asyncio.sleep(0.5)
            await until(client, vehicle, lambda b: b["flight_id"] is not None, 60.0)
            flown = await until(
                client, "/api/v1/flights", lambda b: b["flights"][0]["state"] != "flying", 300.0
            )
            flight = flown["flights"][0]
            coverage = (await client.get(flight["links"]["coverage.geojson"])).json()
    assert flight["state"] == "ended"
    collects = [f for f in plan["features"] if f["properties"]["role"] == "collect"]
    assert len(coverage["triggers"]) == len(collects)
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}, coverage["triggers"]
    assert min(coverage["coverage"].values()) > least_seen
    assert (flight["photos"] > 0) == (payload is not None)
