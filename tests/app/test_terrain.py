"""Elevation rasters: read, refused, kept, named by scenarios."""

from __future__ import annotations

import contextlib
import json
import re
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pyproj
import pytest
import rasterio.shutil
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from rasterio.io import MemoryFile
from rasterio.transform import from_origin
from typer.testing import CliRunner

from app.cli.root import cli
from app.main import create_app
from app.services.errors import RefusedError
from app.services.terrain import rasters
from app.services.terrain.rasters import pack, read_raster, stored_terrain, unpack
from app.settings import Settings
from tests.app.conftest import fake_house, serving
from tests.app.rasters import jacksboro, ramp, written
from tests.patience import PATIENCE_S
from tests.planner.scenarios import feature, small, square

TERRAIN = "/api/v1/terrain"
HGT = "N36W085.hgt"
WHOLE = ramp()


def hgt() -> bytes:
    """An SRTM tile of three seconds: big-endian, rows from the north, no header."""
    rows, columns = np.indices((1201, 1201))
    heights = (300 + rows // 10 + columns // 20).astype(">i2")
    heights[0, 0] = -32768
    return heights.tobytes()


def on_jacksboro(**members: Any) -> dict[str, Any]:
    """Two regions among the hills of the Jacksboro fault."""
    return small(**members) | {
        "features": [
            feature("A", "roi", "Polygon", square(-84.26, 36.60, 0.004)),
            feature("B", "roi", "Polygon", square(-84.22, 36.58, 0.004)),
            feature("area", "area", "Polygon", square(-84.32, 36.53, 0.14)),
            feature("start", "start", "Point", [-84.24, 36.56]),
        ]
    }


def test_geotiff_posts_lie_where_gdal_says() -> None:
    """Heights at pixel centres equal what rasterio samples there."""
    content = ramp()
    terrain = read_raster(content, "ramp.tif", "ramp")
    with MemoryFile(content) as memory, memory.open() as dataset:
        places = [dataset.xy(i, j) for i, j in ((0, 0), (3, 7), (60, 60))]
        expected = [float(value[0]) for value in dataset.sample(places)]
    assert terrain.heights_at(places) == pytest.approx(expected, abs=1e-4)
    assert terrain.datum == rasters.UNSTATED


def test_hgt_lies_where_its_name_says() -> None:
    """A tile's first post is its north-west corner, its last the south-east; missing posts are gaps."""
    terrain = read_raster(hgt(), HGT, "srtm")
    assert terrain.bounds_deg == pytest.approx((-85.0, 36.0, -84.0, 37.0), abs=1e-9)
    assert float(terrain.heights_at((-84.0, 36.0))) == pytest.approx(300 + 120 + 60)
    assert np.isnan(terrain.heights_at((-85.0, 37.0)))
    assert terrain.datum == "EGM96"


def test_dted_is_read() -> None:
    """A DTED cell written by GDAL gives its heights back, over EGM96."""
    heights = np.fromfunction(lambda i, j: 100 + i // 7 + j // 9, (121, 121)).astype(np.int16)
    step_deg = 1.0 / 120.0
    origin = from_origin(-85.0 - step_deg / 2, 37.0 + step_deg / 2, step_deg, step_deg)
    with MemoryFile(ext=".tif") as source_file:
        with source_file.open(
            driver="GTiff", width=121, height=121, count=1, dtype="int16", crs="EPSG:4326", transform=origin
        ) as source:
            source.write(heights, 1)
        with source_file.open() as source, MemoryFile(ext=".dt0") as target:
            rasterio.shutil.copy(source, target.name, driver="DTED")
            content = bytes(target.read())
    terrain = read_raster(content, "w085n36.dt0", "dted")
    assert terrain.datum == "EGM96"
    assert float(terrain.heights_at((-84.5, 36.5))) == pytest.approx(float(heights[60, 60]))


def test_projected_rasters_are_laid_into_degrees() -> None:
    """Heights of a UTM raster are found at the WGS 84 place of their UTM coordinates."""
    heights = (500 + 0.5 * np.arange(200)[None, :] + 0.0 * np.arange(150)[:, None]).astype(np.float32)
    content = written(heights, crs="EPSG:32616", transform=from_origin(750_000.0, 4_055_000.0, 30.0, 30.0))
    terrain = read_raster(content, "utm.tif", "utm")
    to_degrees = pyproj.Transformer.from_crs("EPSG:32616", "EPSG:4326", always_xy=True)
    places = [
        to_degrees.transform(750_000.0 + 30.0 * (j + 0.5), 4_055_000.0 - 2000.0) for j in (20, 100, 180)
    ]
    assert terrain.heights_at(places) == pytest.approx([510.0, 550.0, 590.0], abs=0.5)


@pytest.mark.parametrize("content", [b"not a raster", ramp()[:3000]])
def test_a_broken_file_is_named_as_the_sender_has_it(content: bytes) -> None:
    """The reason names the file sent, not the place in memory it was read from."""
    with pytest.raises(RefusedError) as caught:
        read_raster(content, "hills.tif", "hills")
    (finding,) = caught.value.findings
    assert "hills.tif" in finding.message
    assert "vsimem" not in finding.message + str(caught.value)


@pytest.mark.parametrize(
    ("content", "filename", "rule"),
    [
        (b"not a raster", "x.tif", "raster-format"),
        (ramp()[:3000], "x.tif", "raster-format"),
        (ramp(crs=None), "x.tif", "no-georeference"),
        (hgt(), "heights.hgt", "no-georeference"),
        (written(np.full((5, 5), -1, np.int16), crs="EPSG:4326", nodata=-1,
                 transform=from_origin(0, 0, 0.1, 0.1)), "x.tif", "no-heights"),
        (ramp(1, 9), "x.tif", "raster-format"),
        (written(np.full((5, 5), -32768, np.int16), crs="EPSG:4326",
                 transform=from_origin(0, 0, 0.1, 0.1)), "x.tif", "implausible-heights"),
        (written(np.zeros((3, 5, 5), np.uint8), crs="EPSG:4326",
                 transform=from_origin(0, 0, 0.1, 0.1)), "x.tif", "raster-format"),
        (ramp(crs="EPSG:4979"), "x.tif", "geoid-grid-missing"),
        (ramp(transform=from_origin(575.0, 37.0, 0.002, 0.002)), "x.tif", "no-georeference"),
        (ramp(transform=from_origin(0.0, 120.0, 0.002, 0.002)), "x.tif", "no-georeference"),
    ],
)  # fmt: skip
def test_refused_files(content: bytes, filename: str, rule: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each kind of unusable file is refused by its own rule."""
    monkeypatch.setattr(rasters, "geoid_transform", lambda: None)
    with pytest.raises(RefusedError) as caught:
        read_raster(content, filename, "x")
    assert [finding.rule for finding in caught.value.findings] == [rule]


def test_values_that_are_no_heights_are_taken_as_they_are() -> None:
    """Importance of any size, in any unit; as heights the same file is refused, and infinity always."""
    georeference = {"crs": "EPSG:4326", "transform": from_origin(0, 0, 0.1, 0.1)}
    content = written(np.full((5, 5), 3e7, np.float32), **georeference)
    with pytest.raises(RefusedError, match="heights run"):
        read_raster(content, "x.tif", "x")
    found = read_raster(content, "x.tif", "x", "none")
    assert (found.datum, float(found.heights_m.max())) == ("none", 3e7)
    endless = written(np.full((5, 5), np.inf, np.float32), **georeference)
    with pytest.raises(RefusedError) as caught:
        read_raster(endless, "x.tif", "x", "none")
    assert [finding.rule for finding in caught.value.findings] == ["not-finite"]


@hypothesis_settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_broken_files_are_refused_or_read(seed: int) -> None:
    """A GeoTIFF with bytes exchanged, or cut short, is either read as a raster on Earth or refused."""
    rng = np.random.default_rng(seed)
    content = bytearray(WHOLE)
    for _ in range(rng.integers(1, 12)):
        place = rng.integers(0, 600) if rng.random() < 0.5 else len(content) - 1 - rng.integers(0, 600)
        content[place] = rng.integers(0, 256)
    if rng.random() < 0.2:
        content = content[: rng.integers(1, len(content))]
    with contextlib.suppress(RefusedError):
        terrain = read_raster(bytes(content), "x.tif", "x")
        assert terrain.resolution_m > 0.0
        assert np.isfinite(terrain.bounds_deg).all()


def test_too_many_posts_are_refused_before_they_are_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """The size is known from the header."""
    monkeypatch.setattr(rasters, "MAX_POSTS", 1000)
    with pytest.raises(RefusedError, match="61 × 61"):
        read_raster(ramp(), "x.tif", "x")


def test_a_missing_geoid_grid_is_noticed() -> None:
    """Either the grid moves heights by what the EGM96 geoid is known to be, or it is said to be missing."""
    lift = rasters.geoid_transform()
    if lift is None:
        plain = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:9707", always_xy=True)
        assert plain.transform(0.0, 0.0, 100.0)[2] == 100.0
    else:
        assert lift(np.zeros(1), np.zeros(1), np.zeros(1))[0] == pytest.approx(-17.16, abs=0.1)


def test_ellipsoidal_heights_are_converted_with_the_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    """With the grid every post is lifted by the geoid at its own place."""
    monkeypatch.setattr(rasters, "geoid_transform", lambda: lambda lon, lat, h: h - 1000.0 * lon - 10.0 * lat)
    content = ramp(crs="EPSG:4979")
    plain = read_raster(content, "x.tif", "x", "EGM2008")
    lifted = read_raster(content, "x.tif", "x")
    place = (0.011, -0.013)
    expected = float(plain.heights_at(place)) - 11.0 + 0.13
    assert float(lifted.heights_at(place)) == pytest.approx(expected, abs=1e-3)
    assert (plain.datum, lifted.datum) == ("EGM2008", "EGM96")


def test_stored_rasters_come_back_as_they_were(tmp_path: Path) -> None:
    """Packing and unpacking lose nothing; ids that are no ids never touch the disk."""
    terrain = read_raster(ramp(), "x.tif", "x")
    name = "0" * 36
    (tmp_path / f"{name}.npz").write_bytes(pack(terrain))
    back = stored_terrain(tmp_path, name)
    assert back is not None
    assert np.array_equal(back.heights_m, terrain.heights_m)
    assert (back.affine, back.datum, back.name) == (terrain.affine, terrain.datum, name)
    assert unpack(tmp_path / f"{name}.npz", "y").name == "y"
    assert stored_terrain(tmp_path, "../" + name) is None


async def test_post_list_get_delete(client: httpx.AsyncClient) -> None:
    """A raster is taken in once, listed, read, deleted; the record tells what it is."""
    answer = await client.post(TERRAIN, content=ramp(), params={"filename": "ramp.tif"})
    assert answer.status_code == 201, answer.text
    record = answer.json()
    assert record["name"] == "ramp"
    assert record["bounds_deg"] == pytest.approx([-0.049, -0.051, 0.071, 0.069])
    assert (record["rows"], record["columns"], record["min_m"], record["max_m"]) == (61, 61, 100.0, 280.0)
    assert record["resolution_m"] == pytest.approx(221.0, abs=2.0)
    assert re.fullmatch(r"[0-9a-f]{64}", record["sha256"])
    again = await client.post(TERRAIN, content=ramp(), params={"filename": "other.tif"})
    assert (again.status_code, again.json()["id"]) == (200, record["id"])
    assert (await client.get(TERRAIN)).json() == {"terrain": [record], "total": 1}
    place = answer.headers["location"]
    assert (await client.get(place)).json() == record
    assert (await client.delete(place)).status_code == 204
    assert (await client.get(place)).status_code == 404
    assert (await client.delete(place)).status_code == 404


async def test_bad_uploads_are_problem_documents(settings: Settings) -> None:
    """Nonsense, emptiness and too much are 422, with the rule."""
    small_cap = settings.model_copy(update={"max_terrain_bytes": 10_000})
    async with serving(create_app(small_cap, fake_house)) as client:
        for content, rule in ((b"x", "raster-format"), (b"", "raster-format"), (ramp(), "body-too-large")):
            answer = await client.post(TERRAIN, content=content)
            assert answer.status_code == 422
            assert answer.headers["content-type"] == "application/problem+json"
            assert answer.json()["errors"][0]["rule"] == rule


async def test_a_scenario_is_planned_on_real_ground(client: httpx.AsyncClient) -> None:
    """Upload the hills, name them, plan: level, clear of the ground, every region seen."""
    sent = await client.post(TERRAIN, content=jacksboro(), params={"vertical_datum": "EGM96"})
    terrain_id = sent.json()["id"]
    document = on_jacksboro(terrain=terrain_id, altitude_m=600.0)
    answer = await client.post("/api/v1/plans", json=document, params={"wait": PATIENCE_S})
    assert answer.json()["state"] == "done", answer.text
    assert answer.json()["violations"] == []
    assert "terrain-level" in {warning["rule"] for warning in answer.json()["warnings"]}
    plan = (await client.get(answer.headers["location"] + "/plan.geojson")).json()
    assert plan["altitude_reference"] == "amsl"
    unknown = await client.post("/api/v1/scenarios/validate", json=document | {"terrain": "nowhere"})
    assert unknown.status_code == 422
    assert "unknown-terrain" in {entry["rule"] for entry in unknown.json()["errors"]}


def test_the_command_line_plans_on_a_raster(tmp_path: Path) -> None:
    """``plan --terrain FILE`` reads the raster and plans on it; a file that is none ends with 2."""
    (tmp_path / "hills.tif").write_bytes(jacksboro())
    (tmp_path / "scenario.geojson").write_text(json.dumps(on_jacksboro(altitude_m=600.0)))
    arguments = ["plan", str(tmp_path / "scenario.geojson"), "-o", str(tmp_path / "plan.geojson")]
    result = CliRunner().invoke(cli, [*arguments, "--terrain", str(tmp_path / "hills.tif")])
    assert result.exit_code == 0, result.output
    plan = json.loads((tmp_path / "plan.geojson").read_text())
    assert plan["altitude_reference"] == "amsl"
    assert plan["altitude_m"] > 900.0
    refused = CliRunner().invoke(cli, [*arguments, "--terrain", str(tmp_path / "scenario.geojson")])
    assert refused.exit_code != 0
