"""Camera surveys in a real ArduPlane and ArduCopter through the service alone: flown as planned, all seen.

Skipped unless ``SWATHPLAN_ARDUPLANE`` and ``SWATHPLAN_ARDUCOPTER`` name the simulators; see ``arduplane.py``.
``pytest --log-cli-level=INFO`` shows a row of a table for each flight.
"""

from __future__ import annotations

import asyncio
import logging
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from app.main import create_app
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.test_restart import free_port
from tests.flows.arduplane import ARMING_TRIES, BINARY, HOME_ALTITUDE_M, PARAMETERS, arduplane
from tests.flows.test_ardupilot_phases import COPTER, calibrated
from tests.flows.test_ardupilot_photos import CAMERA
from tests.flows.test_service import until
from tests.patience import PATIENCE_S
from tests.planner.as_flown.test_photos import HEIGHT_M, asked

log = logging.getLogger(__name__)

pytestmark = pytest.mark.ardupilot

SPEEDUP = 15.0
WING: Mapping[str, Any] = {"type": "fixed_wing", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0}
ROTORS: Mapping[str, Any] = {"type": "multirotor", "airspeed_m_s": 8.0}
#: What is bolted to a multirotor looks aside of the ground below by as much as it leans into its way.
IN_A_GIMBAL = {"name": "cam", "type": "camera", "model": "DJI Zenmuse P1 35 mm"}
#: Of the whole duration; of each region; and how far off its lines, in metres.
WITHIN, LEAST_SEEN, OFF_LINE_M = 0.03, 0.999, 3.0
#: From the end planned: a wing rolls out.
FROM_END_M = {"fixed_wing": 60.0, "multirotor": 2.0}


@pytest.mark.parametrize(
    ("vehicle", "binary"),
    [
        pytest.param(
            WING,
            BINARY,
            marks=pytest.mark.skipif(not BINARY, reason="SWATHPLAN_ARDUPLANE names no simulator"),
            id="ArduPlane",
        ),
        pytest.param(
            ROTORS,
            COPTER,
            marks=pytest.mark.skipif(not COPTER, reason="SWATHPLAN_ARDUCOPTER names no simulator"),
            id="ArduCopter",
        ),
    ],
)
async def test_a_survey_is_flown_as_planned(tmp_path: Path, vehicle: Mapping[str, Any], binary: str) -> None:
    """Every photo taken, 99.9 % seen, 3 % of the time, on its lines, down where planned."""
    document = asked()
    document["vehicles"][0] |= {**vehicle, "autopilot": "ardupilot", "finish": "land"}
    document["vehicles"][0].pop("settle_m", None)
    rotors = vehicle["type"] == "multirotor"
    if rotors:
        document["sensors"] = [IN_A_GIMBAL]
    settings = Settings(database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error")
    port = free_port()
    (tmp_path / "vehicle").mkdir()
    async with serving(create_app(settings, fake_house)) as client:
        record = (await client.post("/api/v1/plans", json=document, params={"wait": PATIENCE_S})).json()
        assert record["state"] == "done", record
        plan = (await client.get(record["links"]["plan.geojson"])).json()
        path = next(f for f in plan["features"] if f["properties"]["role"] == "path")
        line, heading_deg = path["geometry"]["coordinates"], path["properties"]["take_off_heading_deg"]
        parameters = {**PARAMETERS, **CAMERA, **({} if rotors else calibrated(HOME_ALTITUDE_M + HEIGHT_M))}
        defaults = os.environ.get("SWATHPLAN_ARDUCOPTER_PARAMS", str(Path(COPTER).with_name("copter.parm")))
        with arduplane(
            tmp_path / "vehicle", port, tuple(line[0][:2]), SPEEDUP, parameters,
            "+" if rotors else "plane", binary, defaults if rotors else "", heading_deg or 0.0,
        ):  # fmt: skip
            body = {"name": "one", "url": f"udpin:127.0.0.1:{port}", "timeout_s": 60}
            answer = await client.post("/api/v1/vehicles", json=body)
            assert answer.json()["connected"], answer.text
            one = answer.headers["location"]
            await until(client, one, lambda b: b["state"]["home_lat_deg"] is not None, 60.0)
            mission = {"plan_id": record["id"], "parts": ["mission", "fence"]}
            report = (await client.post(one + "/mission", json=mission)).json()
            assert (report["outcome"], report["verified"]) == ("accepted", True), report
            for _ in range(ARMING_TRIES):
                # Until position and attitude have settled it says no.
                order = {"command": "start", "arm_first": True}
                started = await client.post(one + "/commands", json=order)
                if started.status_code == 200:
                    break
                await asyncio.sleep(0.25)
            assert started.status_code == 200, started.text
            flying = await until(client, one, lambda b: b["flight_id"] is not None, 60.0)
            flight_path = f"/api/v1/flights/{flying['flight_id']}"
            flight = await until(client, flight_path, lambda b: b["state"] != "flying", 600.0)
            state = (await client.get(one)).json()["state"]
            coverage = (await client.get(flight_path + "/coverage.geojson")).json()
    assert flight["state"] == "ended"
    phases = coverage["phases"]
    planned_s, flown_s = (sum(phase[name] for phase in phases) for name in ("planned_s", "flown_s"))
    off_m = max(each["cross_track_p95_m"] for each in coverage["collects"])
    east_m = (state["lon_deg"] - line[-1][0]) * 111_195.0 * math.cos(math.radians(line[-1][1]))
    from_end_m = math.hypot(east_m, (state["lat_deg"] - line[-1][1]) * 111_195.0)
    log.info(
        "| %s | %d of %d | %.4f | %.1f m | %s | %.0f → %.0f s | %.3f | %.1f m |",
        "ArduCopter" if rotors else "ArduPlane",
        flight["photos"],
        plan["metrics"]["photos"],
        min(coverage["coverage"].values()),
        off_m,
        " · ".join(f"{p['kind']} {p['planned_s']:.0f} → {p['flown_s']:.0f} s" for p in phases),
        planned_s,
        flown_s,
        flown_s / planned_s,
        from_end_m,
    )
    assert flight["photos"] == plan["metrics"]["photos"]
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}
    assert min(coverage["coverage"].values()) >= LEAST_SEEN
    assert off_m < OFF_LINE_M
    assert flown_s == pytest.approx(planned_s, rel=WITHIN)
    assert from_end_m < FROM_END_M[vehicle["type"]]
    assert coverage["gaps"] == []
