"""A camera survey from the request to the landing: uploaded by its own triggers, flown, its photos told."""

from __future__ import annotations

import json
from typing import Any

import httpx
import pytest

from tests.app.small_flight import in_flight, planned
from tests.app.test_vehicles import connected, until

_DEGREE_M = 111_200.0
START = (8.0, 0.1)


def survey(autopilot: str, kind: str, trigger: str) -> dict[str, Any]:
    """A field of 400 by 120 m near the equator, in lanes from 60 m up."""

    def place(east_m: float, north_m: float) -> list[float]:
        return [START[0] + east_m / _DEGREE_M, START[1] + north_m / _DEGREE_M]

    ring = [place(*corner) for corner in ((150, 250), (550, 250), (550, 370), (150, 370), (150, 250))]
    features = [
        {"type": "Feature", "id": "field", "geometry": {"type": "Polygon", "coordinates": [ring]},
         "properties": {"role": "roi"}},
        {"type": "Feature", "id": "start", "geometry": {"type": "Point", "coordinates": place(0, 0)},
         "properties": {"role": "start"}},
    ]  # fmt: skip
    camera = {"name": "eye", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 4.5e-6}
    vehicle = {"name": "uav-1", "type": kind, "autopilot": autopilot, "airspeed_m_s": 15.0, "finish": "land"}
    return {
        "type": "FeatureCollection",
        "features": features,
        "vehicles": [vehicle | {"min_turn_radius_m": 60.0, "settle_m": 60.0}],
        "sensors": [camera | {"image_px": [7952, 5304], "trigger": trigger}],
        "altitude_m": 60.0,
        "altitude_reference": "home",
    }


@pytest.mark.parametrize(
    ("autopilot", "kind", "trigger", "command"),
    [("ardupilot", "fixed_wing", "distance", 206), ("px4", "multirotor", "distance", 206)],
)
async def test_a_surveys_photos_are_taken_and_told(
    client: httpx.AsyncClient, autopilot: str, kind: str, trigger: str, command: int
) -> None:
    """Nothing is said of the payload: the plan's camera takes its photos, as many as planned within 1 %."""
    plan_id = await planned(client, survey(autopilot, kind, trigger))
    plan = (await client.get(f"/api/v1/plans/{plan_id}/plan.geojson")).json()
    photos = [f["properties"] for f in plan["features"] if f["properties"]["role"] == "photos"]
    expected = sum(one["count"] for one in photos)
    assert expected == plan["metrics"]["photos"] > 60
    url = f"sim:?speedup=100&autopilot={autopilot}&type={kind}&airspeed=15&turn_radius=60&sensor_reports=no"
    vehicle = await connected(client, url)
    report = (await client.post(vehicle + "/mission", json={"plan_id": plan_id})).json()
    assert report["verified"], report
    held = [item for item in report["parts"]["mission"]["held"] if item["command"] == command]
    assert len(held) == 2 * len(photos) + 1
    assert report["preflight"]["ready"], json.dumps(report["preflight"])
    await in_flight(client, vehicle)
    flights = await until(
        client, "/api/v1/flights", lambda body: [flight["state"] for flight in body["flights"]] == ["ended"]
    )
    (flight,) = flights["flights"]
    assert flight["payload"].startswith(f"trigger:{trigger}=")
    assert abs(flight["photos"] - expected) <= max(1, 0.01 * expected)
    coverage = (await client.get(flight["links"]["coverage.geojson"])).json()
    assert {trigger["state"] for trigger in coverage["triggers"]} == {"ok"}
    assert all(not one["actions"] for one in flights["flights"]), "nothing had to be switched off"
