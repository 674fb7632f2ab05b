"""Heights along a plan's lines and of the ground below, against the ground's own formula."""

from __future__ import annotations

import json
import uuid
from pathlib import Path
from typing import Any

import httpx
import pyproj
import pytest

from app.services.plans.filed_mission import MEMBER
from app.services.plans.profile import profile_of
from app.services.terrain.rasters import pack, read_raster
from tests.app.conftest import stored
from tests.app.rasters import ramp
from tests.app.test_problems import check_problem
from tests.planner.scenarios import small

LINE = [[-0.02, -0.02, 640.0], [0.01, -0.02, 640.0], [0.01, 0.02, 700.0]]


def plan_of(line: list[list[float]], reference: str, **members: Any) -> dict[str, Any]:
    """A plan of one line, and photos at its corners, as long as the ellipsoid says it is."""
    geod = pyproj.Geod(ellps="WGS84")
    length_m = geod.line_length(*list(zip(*line, strict=True))[:2])
    path = {"role": "path", "vehicle": "uav", "sortie": 1, "length_m": length_m}
    photos = {"role": "photos", "vehicle": "uav", "seq": 3, "sensor": "cam"}
    return {
        "altitude_reference": reference,
        "features": [
            {"properties": path, "geometry": {"type": "LineString", "coordinates": line}},
            {"properties": photos, "geometry": {"type": "MultiPoint", "coordinates": line}},
        ],
    } | members


def asked(plan: dict[str, Any], folder: Path | None = None, **members: Any) -> dict[str, Any]:
    """The profile of a plan made of a small scenario."""
    return profile_of(json.dumps(plan), json.dumps(small(**members)), folder)


def test_over_a_raster_the_ground_below_is_told(tmp_path: Path) -> None:
    """On a plane of 1 m a column and 2 m a row every place has the plane's height, as under every photo."""
    name = str(uuid.uuid4())
    (tmp_path / f"{name}.npz").write_bytes(pack(read_raster(ramp(), "ramp.tif", name)))
    found = asked(plan_of(LINE, "amsl"), tmp_path, terrain=name)
    assert (found["ground"], found["altitude_reference"]) == ("raster", "amsl")
    (path,) = found["paths"]
    assert len(path["at_m"]) == len(path["altitude_m"]) == len(path["ground_m"]) > 50

    def plane_m(lon: float, lat: float) -> float:
        return 100.0 + (lon + 0.05) / 0.002 - 0.5 + 2.0 * ((0.07 - lat) / 0.002 - 0.5)

    assert path["ground_m"][0] == pytest.approx(plane_m(-0.02, -0.02), abs=0.2)
    assert path["ground_m"][-1] == pytest.approx(plane_m(0.01, 0.02), abs=0.2)
    east_m = pyproj.Geod(ellps="WGS84").inv(-0.02, -0.02, 0.01, -0.02)[2]
    halfway = min(range(len(path["at_m"])), key=lambda k: abs(path["at_m"][k] - east_m / 2.0))
    assert path["ground_m"][halfway] == pytest.approx(plane_m(-0.005, -0.02), abs=0.5)
    assert path["altitude_m"][halfway] == pytest.approx(640.0, abs=1e-3)
    assert path["at_m"] == sorted(path["at_m"])
    (photos,) = found["photos"]
    assert photos["ground_m"] == pytest.approx([plane_m(lon, lat) for lon, lat, _ in LINE], abs=0.2)


@pytest.mark.parametrize(
    ("reference", "home_m", "ground_m"), [("terrain", None, 0.0), ("home", 50.0, 0.0), ("amsl", 120.0, 120.0)]
)
def test_without_a_raster_the_ground_is_flat(reference: str, home_m: float | None, ground_m: float) -> None:
    """It lies at the height of home, told over what the plan's altitudes count from; corners are enough."""
    document = small()
    start = next(f for f in document["features"] if f["id"] == "start")
    if home_m is not None:
        start["geometry"]["coordinates"].append(home_m)
    found = asked(plan_of(LINE, reference), altitude_reference=reference, features=document["features"])
    assert found["ground"] == "flat"
    assert found["paths"][0]["ground_m"] == [ground_m] * 3
    assert found["paths"][0]["altitude_m"] == [640.0, 640.0, 700.0]


def test_of_a_mission_file_the_ground_is_not_known() -> None:
    """Its heights are told all the same."""
    found = profile_of(json.dumps(plan_of(LINE, "home", **{MEMBER: {}})), "{}", None)
    assert found["ground"] is None
    assert found["paths"][0]["ground_m"] == [None] * 3
    assert found["paths"][0]["altitude_m"][-1] == 700.0


def test_heights_are_told_where_the_raster_is_gone(tmp_path: Path) -> None:
    """The ground is unknown then, the flight is not."""
    found = asked(plan_of(LINE, "amsl"), tmp_path, terrain=str(uuid.uuid4()))
    assert found["ground"] is None
    assert found["paths"][0]["altitude_m"] == [640.0, 640.0, 700.0]


async def test_it_is_asked_of_a_plan(client: httpx.AsyncClient, plan_file: Path) -> None:
    """A plan's profile ends where its path does; a plan that is not there has none."""
    plan_id = await stored(client, plan_file)
    found = (await client.get(f"/api/v1/plans/{plan_id}/profile")).json()
    plan = json.loads(plan_file.read_text())
    lengths = [f["properties"]["length_m"] for f in plan["features"] if f["properties"]["role"] == "path"]
    assert [path["at_m"][-1] for path in found["paths"]] == pytest.approx(lengths, abs=0.01)
    check_problem(await client.get("/api/v1/plans/none/profile"), 404)
