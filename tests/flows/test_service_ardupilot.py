"""A flight in a real ArduPlane through the service alone, judged by what its relay did.

Skipped unless ``SWATHPLAN_ARDUPLANE`` names the simulator's binary; see ``arduplane.py``.
"""

from __future__ import annotations

import asyncio
import json
from pathlib import Path

import pytest

from app.main import create_app
from app.routers.bodies import EXAMPLE
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.test_restart import free_port
from tests.flows.arduplane import ARMING_TRIES, BINARY, arduplane
from tests.flows.test_service import until
from tests.patience import PATIENCE_S

pytestmark = [
    pytest.mark.ardupilot,
    pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
]

SPEEDUP = 20.0
#: Its tuning needs some straight flight before each collect.
VEHICLE = {"autopilot": "ardupilot", "airspeed_m_s": 22.0, "min_turn_radius_m": 100.0, "settle_m": 300.0}
MARGINS = {"pointing_margin_deg": 1.5, "position_margin_m": 5.0}


async def test_what_arduplane_saw_is_known_to_the_service(tmp_path: Path) -> None:
    """Planned, uploaded, flown and judged over HTTP: every trigger in order, every region seen."""
    scenario = json.loads(json.dumps(EXAMPLE))
    scenario["vehicles"][0].update(VEHICLE)
    scenario["sensors"][0].update(MARGINS)
    settings = Settings(database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error")
    port = free_port()
    (tmp_path / "plane").mkdir()
    async with serving(create_app(settings, fake_house)) as client:
        record = (await client.post("/api/v1/plans", json=scenario, params={"wait": PATIENCE_S})).json()
        assert record["state"] == "done", record
        plan = (await client.get(record["links"]["plan.geojson"])).json()
        start = next(f for f in scenario["features"] if f["properties"]["role"] == "start")
        lon_deg, lat_deg = start["geometry"]["coordinates"][:2]
        with arduplane(tmp_path / "plane", port, (lon_deg, lat_deg), SPEEDUP):
            body = {"name": "plane", "url": f"udpin:127.0.0.1:{port}", "timeout_s": 30}
            answer = await client.post("/api/v1/vehicles", json=body)
            assert answer.json()["connected"], answer.text
            vehicle = answer.headers["location"]
            await until(client, vehicle, lambda b: b["state"]["mode"] not in ("", "INITIALISING"), 30.0)
            mission = {"plan_id": record["id"], "parts": ["mission", "fence"], "payload": "relay:0"}
            report = (await client.post(vehicle + "/mission", json=mission)).json()
            assert (report["outcome"], report["verified"]) == ("accepted", True), report
            for _ in range(ARMING_TRIES):
                # Until position and attitude have settled it says no.
                armed = await client.post(vehicle + "/commands", json={"command": "arm"})
                if armed.status_code == 200:
                    break
                await asyncio.sleep(0.25)
            assert armed.status_code == 200, armed.text
            started = await client.post(vehicle + "/commands", json={"command": "start"})
            assert started.status_code == 200, started.text
            await until(client, vehicle, lambda b: b["flight_id"] is not None, 60.0)
            # The example ends in a return, which circles over home.
            last = len(report["parts"]["mission"]["held"]) - 1
            await until(
                client,
                vehicle,
                lambda b: b["state"]["mode"] == "RTL" or b["state"]["mission_current"] == last,
                300.0,
            )
            flight = (await client.get("/api/v1/flights")).json()["flights"][0]
            coverage = (await client.get(flight["links"]["coverage.geojson"])).json()
            assert (await client.delete(vehicle, params={"in_flight": "true"})).status_code == 204
    collects = [f for f in plan["features"] if f["properties"]["role"] == "collect"]
    assert len(coverage["triggers"]) == len(collects)
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}, coverage["triggers"]
    assert max(collect["cross_track_p95_m"] for collect in coverage["collects"]) < 5.0
    assert min(coverage["coverage"].values()) > 0.995
