"""The camera database over HTTP."""

from __future__ import annotations

import httpx
import pytest

from planner.sensors.cameras import CAMERAS
from tests.app.test_problems import check_problem


async def test_all_cameras_are_listed(client: httpx.AsyncClient) -> None:
    """Each once, by its name, with the figures that a scenario would give."""
    found = (await client.get("/api/v1/sensors")).json()["sensors"]
    assert [camera["name"] for camera in found] == list(CAMERAS)
    (one,) = [camera for camera in found if camera["name"] == "DJI Phantom 4 RTK"]
    assert one["pixel_pitch_m"] == pytest.approx(0.0132 / 5472)
    assert one | {"pixel_pitch_m": 0.0} == {
        "name": "DJI Phantom 4 RTK",
        "kind": "integrated",
        "type": "camera",
        "spectrum": "visible",
        "focal_length_m": 0.0088,
        "pixel_pitch_m": 0.0,
        "image_px": [5472, 3648],
        "min_interval_s": 2.5,
        "source": "DJI: Phantom 4 RTK",
    }


async def test_they_are_found_by_words(client: httpx.AsyncClient) -> None:
    """All words count, in any order, as a part of name or kind."""
    found = (await client.get("/api/v1/sensors", params={"search": "35 SONY a7r"})).json()["sensors"]
    assert {camera["name"] for camera in found} == {"Sony a7R III 35 mm", "Sony a7R IV 35 mm"}
    thermal = (await client.get("/api/v1/sensors", params={"search": "thermal"})).json()["sensors"]
    assert {camera["spectrum"] for camera in thermal} == {"infrared"}
    assert (await client.get("/api/v1/sensors", params={"search": "no such"})).json() == {
        "sensors": [],
        "radars": [],
    }
    check_problem(await client.get("/api/v1/sensors", params={"search": "x" * 101}), 422)


async def test_radars_are_listed_beside_them(client: httpx.AsyncClient) -> None:
    """Found by words, too, each with its source."""
    found = (await client.get("/api/v1/sensors", params={"search": "sar spotlight"})).json()
    assert found["sensors"] == []
    assert [(radar["name"], radar["resolution_m"]) for radar in found["radars"]] == [
        ("GA-ASI Lynx spot", 0.1)
    ]
    assert found["radars"][0]["source"]
