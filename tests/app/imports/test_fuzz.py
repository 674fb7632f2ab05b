"""Bytes of any kind against every reader: an answer, or an error with a name."""

from __future__ import annotations

import json
import math
import random
import warnings

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from app.imports import FORMATS, ImportOptions, RegionFileError, import_regions
from mavlink.encoding.encode import encode
from mavlink.formats import FormatError, read_plan, read_waypoints, write_waypoints
from tests.app.imports.mutations import of_any
from tests.app.imports.samples import (
    GPX,
    HOLE,
    RING,
    archive_of,
    folder,
    kml,
    line,
    packed,
    placemark,
    point,
    polygon,
    shapefiles,
)
from tests.mavlink.formats.test_qgc_complex import LANDING, STRUCTURE, SURVEY, plan_of, simple
from tests.mavlink.plans import make_plan

FUZZ = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
OPTIONS = ImportOptions(width_m=10.0, radius_m=10.0, height_m=10.0, crs="EPSG:32632")
WITH_PRJ = ImportOptions(width_m=10.0, radius_m=10.0, height_m=10.0)
KML = kml(
    folder("No fly", placemark("a", polygon(RING, HOLE))),
    placemark("b", line(RING[:3]), priority=2),
    placemark("c", f"<MultiGeometry>{point(8.5, 47.3)}{polygon(RING)}</MultiGeometry>"),
)
UTM = [[(500000.0, 5200000.0), (500000.0, 5201000.0), (501000.0, 5201000.0), (500000.0, 5200000.0)]]
SHAPES = shapefiles([UTM, UTM], ["one", "two"], "EPSG:32632")
GEOJSON = json.dumps(
    {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "id": 7,
                "properties": {"name": "x", "priority": 2},
                "geometry": {"type": "MultiPolygon", "coordinates": [[RING], [RING, HOLE]]},
            }
        ],
    }
).encode()
FEATURE = json.dumps(json.loads(GEOJSON)["features"][0]).encode()
ESRI = json.dumps(
    {
        "geometryType": "esriGeometryPolygon",
        "spatialReference": {"wkid": 32632},
        "features": [{"attributes": {"name": "x"}, "geometry": {"rings": [RING, HOLE]}}],
    }
).encode()
GML = (
    b'<c xmlns="u" xmlns:g="http://www.opengis.net/gml"><g:featureMember><f><name>x</name>'
    b'<g:Polygon srsName="EPSG:4326"><g:exterior><g:LinearRing><g:posList>8 47 8 48 9 48 8 47</g:posList>'
    b"</g:LinearRing></g:exterior></g:Polygon></f></g:featureMember>"
    b'<g:featureMember><f><g:Curve srsName="EPSG:4326"><g:segments><g:CircleByCenterPoint>'
    b'<g:pos>8 47</g:pos><g:radius uom="m">90</g:radius></g:CircleByCenterPoint></g:segments></g:Curve></f>'
    b"</g:featureMember></c>"
)
WKT = b"SRID=4326;POLYGON ((8 47, 8 48, 9 48, 8 47))\nMULTIPOINT ((8 47), (9 47))\n"
CSV = b"name,lat,lon,radius_m\nno fly,47.5,8.5,30\nroi,47.6,8.6,\n"
FENCE = b"47.35 8.55\n47.3 8.5\n47.3 8.6\n47.4 8.6\n47.3 8.5\n"
SEEDS = {
    "kml": KML,
    "kmz": packed({"doc.kml": KML}),
    "gpx": GPX,
    "shp": SHAPES[".shp"],
    "shapefile": archive_of(SHAPES),
    "zip": packed({"a/doc.kml": KML, "b/points.geojson": GEOJSON} | {f"c{e}": d for e, d in SHAPES.items()}),
    "geojson": GEOJSON,
    "geojsonl": b"\n".join([FEATURE, FEATURE]),
    "esrijson": ESRI,
    "gml": GML,
    "wkt": WKT,
    "csv": CSV,
    "mission": FENCE,
}


@st.composite
def spoiled(draw: st.DrawFn, good: bytes) -> bytes:
    """A good file with some bytes changed, taken out or put in, or cut short."""
    data = bytearray(good)
    for _ in range(draw(st.integers(1, 6))):
        at = draw(st.integers(0, max(0, len(data) - 1)))
        kind = draw(st.sampled_from(["flip", "insert", "delete", "cut", "ends"]))
        if kind == "flip" and data:
            data[at] = draw(st.integers(0, 255))
        elif kind == "insert":
            data[at:at] = draw(st.binary(min_size=1, max_size=8))
        elif kind == "delete":
            del data[at : at + draw(st.integers(1, 16))]
        elif kind == "ends" and len(data) > 4:
            data[at : at + 4] = draw(st.sampled_from([b"\xff" * 4, b"\x00" * 4, b"\x7f\xff\xff\xff"]))
        elif kind == "cut" and draw(st.integers(0, 3)) == 0:
            del data[at:]
    return bytes(data)


def check(data: bytes, options: ImportOptions, form: str | None, **more: dict[str, bytes]) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            found = import_regions(data, options, form, **more)
        except RegionFileError as error:
            findings = error.findings
        else:
            assert found.collection["features"]
            json.dumps(found.collection, allow_nan=False)
            assert all(_on_earth(f["geometry"]["coordinates"]) for f in found.collection["features"])
            return
    assert findings
    assert all(f.feature and f.rule and f.message and f.fix for f in findings)


def _on_earth(value: object) -> bool:
    if isinstance(value, list) and value and isinstance(value[0], float):
        return abs(value[0]) <= 180.0 and abs(value[1]) <= 90.0
    return isinstance(value, list) and all(map(_on_earth, value))


def test_the_seeds_are_good() -> None:
    """Fuzzing begins at files that are read."""
    assert set(SEEDS) == set(FORMATS)
    for form, data in SEEDS.items():
        assert import_regions(data, OPTIONS).format == form


@pytest.mark.parametrize("form", FORMATS)
def test_spoiled_files_are_read_or_refused(form: str) -> None:
    """Damage to a good file ends in features on Earth or in findings."""

    @given(spoiled(SEEDS[form]), st.sampled_from([OPTIONS, WITH_PRJ]))
    @FUZZ
    def run(data: bytes, options: ImportOptions) -> None:
        check(data, options, None)
        check(data, options, form)

    run()


@pytest.mark.parametrize("form", FORMATS)
def test_files_changed_in_their_structure_are_read_or_refused(form: str) -> None:
    """So do 500 files of each format whose parts were taken out, doubled, exchanged or replaced."""
    dice = random.Random(form)
    for _ in range(500):
        data = of_any(SEEDS[form], dice)
        check(data, dice.choice([OPTIONS, WITH_PRJ]), dice.choice([None, form]))


BEGINNINGS = [b"", *(seed[:40] for seed in SEEDS.values())]


@given(st.binary(max_size=300), st.sampled_from([None, *FORMATS]), st.sampled_from(BEGINNINGS))
@FUZZ
def test_any_bytes_are_read_or_refused(data: bytes, form: str | None, start: bytes) -> None:
    """So does rubbish, with or without a good beginning."""
    check(start + data, OPTIONS, form)


@given(spoiled(SHAPES[".dbf"]), spoiled(SHAPES[".prj"]), spoiled(b"UTF-8"))
@settings(FUZZ, max_examples=40)
def test_spoiled_companions_are_read_or_refused(dbf: bytes, prj: bytes, cpg: bytes) -> None:
    """So does damage to what lies beside a shapefile."""
    check(SHAPES[".shp"], WITH_PRJ, "shp", companions={".dbf": dbf, ".prj": prj, ".cpg": cpg})


PLAN = json.dumps(plan_of(simple(22, 47.3977, 8.5456, 50, 1), SURVEY, STRUCTURE, LANDING)).encode()
ROWS = write_waypoints(encode(make_plan())).encode()


@given(spoiled(PLAN) | st.binary(max_size=200))
@FUZZ
def test_spoiled_plans_are_read_or_refused(data: bytes) -> None:
    """A .plan file gives a mission or FormatError."""
    try:
        mission = read_plan(data.decode("utf-8", "replace"))
    except FormatError:
        return
    assert all(not math.isnan(item.x) for item in mission.mission)


@given(spoiled(ROWS) | st.binary(max_size=200))
@FUZZ
def test_spoiled_rows_are_read_or_refused(data: bytes) -> None:
    """A .waypoints file gives a mission or FormatError with a line."""
    try:
        mission = read_waypoints(data.decode("utf-8", "replace"))
    except FormatError as error:
        found = error
    else:
        assert mission.mission
        return
    assert found.line is not None
