"""The command line and files of other programs: ``convert`` and ``import``."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import pytest

from app.routers.bodies import EXAMPLE
from mavlink.encoding.encode import encode
from mavlink.formats import read_plan, read_waypoints, write_plan, write_waypoints
from tests.app.cli.conftest import Command, swathplan
from tests.app.imports.samples import GPX, RING, kml, line, placemark, polygon, shapefiles
from tests.mavlink.formats.test_qgc_complex import LANDING, SURVEY, plan_of, simple
from tests.mavlink.plans import make_plan
from tests.mavlink.strategies import same

__all__ = ["swathplan"]

MISSION = encode(make_plan())


def test_a_mission_survives_both_conversions(swathplan: Command, tmp_path: Path) -> None:
    """.plan to .waypoints and back gives the same items; the loss of the fence is said."""
    plan, rows = tmp_path / "a.plan", tmp_path / "a.waypoints"
    plan.write_text(write_plan(MISSION))
    ended = swathplan("convert", str(plan), "-o", str(rows), "--json")
    assert ended.code == 0
    assert json.loads(ended.out)["items"] == len(MISSION.mission)
    assert "the fence has no place" in ended.err
    assert same(read_waypoints(rows.read_text()).mission, MISSION.mission)
    again = swathplan("convert", str(rows))
    assert same(read_plan(again.out).mission, MISSION.mission)


def test_a_type_is_said_where_the_file_has_none(swathplan: Command, tmp_path: Path) -> None:
    """Without --type a .waypoints file gives a .plan without type and speeds, and a note."""
    rows = tmp_path / "a.waypoints"
    rows.write_text(write_waypoints(MISSION))
    bare = swathplan("convert", str(rows))
    assert not {"vehicleType", "cruiseSpeed", "hoverSpeed"} & json.loads(bare.out)["mission"].keys()
    assert "--type" in bare.err
    said = swathplan("convert", str(rows), "--type", "multirotor")
    assert json.loads(said.out)["mission"]["vehicleType"] == 2
    assert "--type" not in said.err


def test_complex_items_are_laid_out(swathplan: Command) -> None:
    """A survey and a landing pattern become rows, and what was made is told."""
    plan = json.dumps(plan_of(simple(22, 47.3977, 8.5456, 50, 1), SURVEY, LANDING))
    ended = swathplan("convert", "-", stdin=plan)
    assert len(ended.out.splitlines()) == 1 + 1 + 1 + 8 + 6
    assert "fwLandingPattern" in ended.err


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("QGC WPL 99\n", "line 1: the version is '99'"),
        ('{\n"fileType": 1,}', "line 2: no JSON"),
        (write_waypoints(MISSION).replace("33.49", "133.49"), "latitude"),
    ],
)
def test_bad_mission_files_exit_2(swathplan: Command, text: str, says: str) -> None:
    """Line, column and fault stand on standard error, nothing on standard output."""
    ended = swathplan("convert", "-", stdin=text)
    assert (ended.code, ended.out) == (2, "")
    assert says in ended.err


def test_imported_regions_plan(swathplan: Command, tmp_path: Path) -> None:
    """What import writes stands in a scenario beside its own features, and the scenario is sound."""
    features = EXAMPLE["features"]
    region = next(f for f in features if f["properties"]["role"] == "roi")
    ring = [(lon, lat) for lon, lat, *_ in region["geometry"]["coordinates"][0]]
    drawn = tmp_path / "fields.kml"
    drawn.write_bytes(kml(placemark("from the map", polygon(ring)), placemark("lane", line(ring[:2]))))
    written = tmp_path / "regions.geojson"
    ended = swathplan("import", str(drawn), "--width-m", "80", "-o", str(written), "--json")
    assert (ended.code, json.loads(ended.out)["features"]) == (0, 2)
    imported = json.loads(written.read_text())["features"]
    merged = EXAMPLE | {"features": [*(f for f in features if f is not region), *imported]}
    checked = swathplan("validate", "-", stdin=json.dumps(merged))
    assert checked.code == 0, checked.err


def test_a_shapefile_is_read_with_what_lies_beside_it(swathplan: Command, tmp_path: Path) -> None:
    """The .prj and .dbf of a lone .shp are found; without the first the reference system is asked for."""
    for ending, content in shapefiles([[RING[::-1]]], ["meadow"]).items():
        (tmp_path / f"a{ending}").write_bytes(content)
    ended = swathplan("import", str(tmp_path / "a.shp"))
    assert json.loads(ended.out)["features"][0]["id"] == "meadow"
    (tmp_path / "a.prj").unlink()
    refused = swathplan("import", str(tmp_path / "a.shp"))
    assert (refused.code, refused.out) == (2, "")
    assert "EPSG" in refused.err
    assert swathplan("import", str(tmp_path / "a.shp"), "--crs", "EPSG:4326").code == 0


def test_import_refuses_with_findings(swathplan: Command, tmp_path: Path) -> None:
    """Lines without a width are named, each; the exit code is 2."""
    path = tmp_path / "a.gpx"
    path.write_bytes(GPX)
    ended = swathplan("import", str(path), "--json")
    assert (ended.code, ended.out) == (2, "")
    rules = [finding["rule"] for finding in json.loads(ended.err)["errors"]]
    assert rules == ["width_m-missing", "width_m-missing"]


def test_import_says_what_every_shape_became(swathplan: Command, tmp_path: Path) -> None:
    """Roles and reasons stand on standard error and in --json; --role-of settles a doubt."""
    path, out = tmp_path / "a.kml", tmp_path / "out.geojson"
    path.write_bytes(
        kml(placemark("NFZ north", polygon(RING)), placemark("odd", polygon(RING), role="cloud"))
    )
    ended = swathplan("import", str(path), "-o", str(out), "--json")
    assert ended.code == 0
    assert "NFZ north: no_fly (its name says 'nfz')" in ended.err
    assert "IN DOUBT" in ended.err
    assert [(one["role"], one["in_doubt"]) for one in json.loads(ended.out)["shapes"]] == [
        ("no_fly", False),
        ("no_fly", True),
    ]
    scenario = EXAMPLE | {"features": [*EXAMPLE["features"], *json.loads(out.read_text())["features"]]}
    refused = swathplan("validate", "-", "--json", stdin=json.dumps(scenario))
    assert refused.code == 2
    assert "role-in-doubt" in refused.out + refused.err
    ended = swathplan("import", str(path), "--role-of", "odd=roi", "--role-of", "#1=none")
    (feature,) = json.loads(ended.out)["features"]
    assert feature["properties"] == {"role": "roi", "name": "odd"}
    wrong = swathplan("import", str(path), "--role-of", "od=roi")
    assert (wrong.code, wrong.out) == (2, "")


def test_a_plan_goes_out_as_kmz_and_comes_in_again(
    swathplan: Command, plan_file: Path, tmp_path: Path
) -> None:
    """The archive holds the KML that export writes, the same bytes every time, and import reads it."""
    first, again = tmp_path / "a.kmz", tmp_path / "b.kmz"
    for path in (first, again):
        assert swathplan("export", str(plan_file), "--format", "kmz", "-o", str(path)).code == 0
    assert first.read_bytes() == again.read_bytes()
    with zipfile.ZipFile(first) as archive:
        assert archive.read("doc.kml").decode() == swathplan("export", str(plan_file), "--format", "kml").out
    ended = swathplan("import", str(first), "--width-m", "10", "--radius-m", "10")
    assert ended.code == 0
    names = [feature["id"] for feature in json.loads(ended.out)["features"]]
    assert any(name.startswith("path of") for name in names)
