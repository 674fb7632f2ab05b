"""Region files over HTTP."""

from __future__ import annotations

import httpx
import jsonschema
import pytest

from tests.app.imports.samples import GPX, RING, archive_of, kml, line, packed, placemark, polygon, shapefiles
from tests.app.test_problems import check_problem

PATH = "/api/v1/scenarios/import"
KML = kml(placemark("field", polygon(RING)))
SHAPES = shapefiles([[RING[::-1]]], ["meadow"])


@pytest.mark.parametrize(
    ("body", "media_type", "form"),
    [
        (KML, "application/vnd.google-earth.kml+xml", "kml"),
        (KML, "application/octet-stream", "kml"),
        (packed({"doc.kml": KML}), "application/vnd.google-earth.kmz", "kmz"),
        (packed({"doc.kml": KML}), "application/zip", "kmz"),
        (archive_of(SHAPES), "application/zip", "shapefile"),
        (GPX, "text/xml", "gpx"),
    ],
)
async def test_files_become_features(
    client: httpx.AsyncClient, body: bytes, media_type: str, form: str
) -> None:
    """The format is found by media type or content, and the answer fits its schema."""
    answer = await client.post(
        PATH, content=body, headers={"content-type": media_type}, params={"width_m": 50, "radius_m": 10}
    )
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/geo+json"
    document = answer.json()
    assert (document["type"], document["format"]) == ("FeatureCollection", form)
    assert document["features"][0]["properties"]["role"] == "roi"
    schema = (await client.get("/openapi.json")).json()["paths"][PATH]["post"]["responses"]["200"]
    jsonschema.validate(document, schema["content"]["application/geo+json"]["schema"])


async def test_options_are_query_parameters(client: httpx.AsyncClient) -> None:
    """The role, and the reference system of a lone .shp, are taken from the query."""
    zone = await client.post(PATH, content=KML, params={"role": "no_fly"})
    assert zone.json()["features"][0]["properties"]["role"] == "no_fly"
    bare = await client.post(PATH, content=SHAPES[".shp"], params={"format": "shp", "crs": "EPSG:4326"})
    assert bare.json()["features"][0]["id"] == "roi 1"


async def test_every_shape_is_accounted_for(client: httpx.AsyncClient) -> None:
    """The file's name counts, roles are chosen by name and number; what became of each is said."""
    data = kml(
        placemark("a", polygon(RING)), placemark("b", polygon(RING)), placemark("road", line(RING[:2]))
    )
    query = {"name": "no-fly.kml", "role_of": ["b=area", "#3=roi"]}
    document = (await client.post(PATH, content=data, params=query)).json()
    assert [(one["role"], one["number"]) for one in document["shapes"]] == [
        ("no_fly", 1),
        ("area", 2),
        ("none", 3),
    ]
    assert document["shapes"][0]["features"] == ["a"]
    assert [(one["feature"], one["rule"]) for one in document["left_out"]] == [("road", "width_m-missing")]


@pytest.mark.parametrize(
    ("body", "query", "rule"),
    [
        (b"", {}, "empty"),
        (b"PK\x03\x04 no archive", {}, "archive-damaged"),
        (b"<!DOCTYPE x [<!ENTITY a 'b'>]><kml>&a;</kml>", {}, "xml-entities"),
        (kml(placemark("road", line(RING[:2]))), {}, "width_m-missing"),
        (SHAPES[".shp"], {}, "crs-missing"),
        (KML, {"crs": "EPSG:4326", "role": "end"}, "wrong-geometry"),
        (KML, {"role": "cloud"}, None),
        (KML, {"role_of": "nothing=roi"}, "bad-option"),
        (KML, {"width_m": "-1"}, None),
        (KML, {"width_m": "inf"}, None),
        (KML, {"format": "dxf"}, None),
    ],
)
async def test_faults_are_problems(
    client: httpx.AsyncClient, body: bytes, query: dict[str, str], rule: str | None
) -> None:
    """Each fault is a 422 problem document naming shape, rule and fix."""
    check_problem(await client.post(PATH, content=body, params=query), 422, rule)


async def test_files_over_the_limit_are_refused(client: httpx.AsyncClient) -> None:
    """The cap on bodies holds for files as well."""
    check_problem(await client.post(PATH, content=b"<" * 5_500_000), 422, "body-too-large")
