"""What a plan gives over HTTP: GeoJSON, missions, report; and what OpenAPI tells of it all."""

from __future__ import annotations

import io
import json
import xml.etree.ElementTree as ElementTree
import zipfile
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import httpx
import jsonschema
import pytest

from app.routers.bodies import EXAMPLE
from tests.app.conftest import stored
from tests.app.test_problems import check_problem
from tests.patience import PATIENCE_S


class Tags(HTMLParser):
    """Counts the tags of a page and collects its text."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.texts: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)

    def handle_data(self, data: str) -> None:
        self.texts.append(data)


async def test_scenario_and_plan_come_back_as_they_were(
    client: httpx.AsyncClient, plan_id: str, plan_file: Path
) -> None:
    """The stored scenario and plan are handed out unchanged, as GeoJSON."""
    scenario = await client.get(f"/api/v1/plans/{plan_id}/scenario")
    plan = await client.get(f"/api/v1/plans/{plan_id}/plan.geojson")
    assert scenario.json()["fake_plan"] == str(plan_file)
    assert plan.json() == json.loads(plan_file.read_text())
    assert {scenario.headers["content-type"], plan.headers["content-type"]} == {"application/geo+json"}


async def test_segments_round_the_targets_are_handed_out(client: httpx.AsyncClient) -> None:
    """All of the example's, or one target's; an unknown one is named, and a search chooses none."""
    record = (await client.post("/api/v1/plans", json=EXAMPLE, params={"wait": PATIENCE_S})).json()
    link = record["links"]["network.geojson"]
    found = (await client.get(link)).json()["features"]
    regions = {f["id"] for f in EXAMPLE["features"] if f["properties"]["role"] == "roi"}
    assert {f["id"] for f in found if f["properties"]["role"] == "target"} == regions
    segments = [f["properties"] for f in found if f["properties"]["role"] == "segment"]
    assert {each["state"] for each in segments} >= {"chosen", "open"}
    one = sorted(regions)[0]
    only = (await client.get(link, params={"target": one})).json()["features"]
    assert {f["properties"]["target"] for f in only} == {one}
    refused = await client.get(link, params={"target": "nowhere"})
    check_problem(refused, 422)
    assert "nowhere" in refused.text
    search = EXAMPLE | {"task": "search"}
    record = (await client.post("/api/v1/plans", json=search, params={"wait": PATIENCE_S})).json()
    check_problem(await client.get(record["links"]["network.geojson"]), 409)


async def test_missions_are_what_other_programs_read(client: httpx.AsyncClient, plan_id: str) -> None:
    """The .plan file, the waypoint file and the KML have the marks of their formats, for either autopilot."""
    base = f"/api/v1/plans/{plan_id}/"
    qgc = (await client.get(base + "mission.plan")).json()
    px4 = (await client.get(base + "mission.plan", params={"autopilot": "px4"})).json()
    assert (qgc["fileType"], qgc["mission"]["firmwareType"], px4["mission"]["firmwareType"]) == (
        "Plan",
        3,
        12,
    )
    rows = (await client.get(base + "mission.waypoints")).text.splitlines()
    assert rows[0] == "QGC WPL 110"
    assert [row.split("\t")[0] for row in rows[1:]] == [str(n) for n in range(len(rows) - 1)]
    kmz = await client.get(base + "mission.kmz")
    assert kmz.headers["content-type"] == "application/vnd.google-earth.kmz"
    assert zipfile.ZipFile(io.BytesIO(kmz.content)).namelist() == ["doc.kml"]
    kml = await client.get(base + "mission.kml")
    assert ElementTree.fromstring(kml.text).tag == "{http://www.opengis.net/kml/2.2}kml"


async def test_a_plan_that_returns_is_no_mission_of_px4s_wings(
    client: httpx.AsyncClient, plan_file: Path, tmp_path: Path
) -> None:
    """PX4 wants a landing: refused with the finish to plan with, while ArduPilot's file is handed out."""
    plan = json.loads(plan_file.read_text())
    plan["vehicles"][0]["finish"] = "return"
    returning = tmp_path / "returning.geojson"
    returning.write_text(json.dumps(plan))
    base = f"/api/v1/plans/{await stored(client, returning)}/mission.plan"
    refused = await client.get(base, params={"autopilot": "px4"})
    check_problem(refused, 422, "cannot-be-encoded")
    assert "plan again with finish 'land' of vehicle uav-1" in refused.json()["detail"]
    items = (await client.get(base)).json()["mission"]["items"]
    assert items[-1]["command"] == 20


async def test_payload_and_vehicle_are_chosen_by_query(client: httpx.AsyncClient, plan_id: str) -> None:
    """The sensor's switch can be chosen; what cannot be is refused."""
    base = f"/api/v1/plans/{plan_id}/mission.waypoints"
    servo = (await client.get(base, params={"payload": "servo:9:1900:1100", "vehicle": "uav-1"})).text
    assert {row.split("\t")[3] for row in servo.splitlines()[1:]} >= {"183"}
    check_problem(await client.get(base, params={"payload": "laser"}), 422, "payload")
    check_problem(await client.get(base, params={"vehicle": "nobody"}), 404)
    check_problem(await client.get(base, params={"autopilot": "toy"}), 422)


async def test_report_tells_all_and_escapes_names(client: httpx.AsyncClient, plan_file: Path) -> None:
    """The report has a row for each collect, region and phase; a name cannot smuggle markup into it."""
    plan = json.loads(plan_file.read_text())
    scenario = EXAMPLE | {"name": "<script>alert(1)</script>"}
    plan_id = await stored(client, plan_file, scenario, name="<script>alert(1)</script>")
    answer = await client.get(f"/api/v1/plans/{plan_id}/report.html")
    page = Tags()
    page.feed(answer.text)
    assert answer.status_code == 200
    assert "script" not in page.tags
    assert "default-src 'none'" in answer.headers["content-security-policy"]
    collects = [f for f in plan["features"] if f["properties"]["role"] == "collect"]
    (path,) = (f["properties"] for f in plan["features"] if f["properties"]["role"] == "path")
    rows = page.tags.count("tr")
    assert rows > len(collects) + len(plan["metrics"]["coverage"]) + len(path["phases"])
    assert {"take-off", "mission", "landing", "Whole flight"} <= {text.strip() for text in page.texts}
    assert page.tags.count("polygon") >= len(collects)
    assert {"harbour", "depot", "Every constraint is kept."} <= {text.strip() for text in page.texts}


def operations(schema: dict[str, Any]) -> list[tuple[str, str, dict[str, Any]]]:
    """Every operation of an OpenAPI document."""
    return [(path, verb, op) for path, verbs in schema["paths"].items() for verb, op in verbs.items()]


async def test_openapi_documents_every_route_and_its_errors(client: httpx.AsyncClient) -> None:
    """Each operation has a summary, tags, and problem documents for its errors; references resolve."""
    schema = (await client.get("/openapi.json")).json()
    text = json.dumps(schema)
    for reference in {part.split('"')[0] for part in text.split('"$ref": "#/components/schemas/')[1:]}:
        assert reference in schema["components"]["schemas"]
    assert len(operations(schema)) > 25
    for path, verb, operation in operations(schema):
        assert operation["summary"], path
        assert operation["tags"], path
        for status, answer in operation["responses"].items():
            if status[0] == "4":
                assert list(answer["content"]) == ["application/problem+json"], (path, verb, status)


async def test_every_documented_scenario_is_valid_and_plans(
    client: httpx.AsyncClient, plan_file: Path
) -> None:
    """Examples of the OpenAPI document fit their schema, pass validation, and have been planned whole."""
    schema = (await client.get("/openapi.json")).json()
    checked = 0
    for path, _, operation in operations(schema):
        for media in operation.get("requestBody", {}).get("content", {}).values():
            for example in media.get("examples", {}).values():
                jsonschema.validate(example["value"], media["schema"])
                answer = await client.post("/api/v1/scenarios/validate", json=example["value"])
                assert answer.json() == {"valid": True, "findings": []}, path
                assert example["value"] == EXAMPLE
                checked += 1
    assert checked >= 2
    plan = json.loads(plan_file.read_text())
    assert plan["violations"] == []
    assert min(plan["metrics"]["coverage"].values()) >= 0.9999


async def test_map_is_served_or_its_absence_explained(client: httpx.AsyncClient) -> None:
    """Without a built map the first page says how to build it."""
    answer = await client.get("/")
    assert answer.status_code == 200
    assert "make" in answer.text


@pytest.mark.parametrize("path", ["/health/live", "/health/ready", "/metrics"])
async def test_probes(client: httpx.AsyncClient, path: str) -> None:
    """Probes answer; metrics are in the Prometheus format."""
    await client.post("/api/v1/plans", json={"features": [{}]}, params={"wait": PATIENCE_S})
    answer = await client.get(path)
    assert answer.status_code == 200
    if path == "/metrics":
        assert "swathplan_plans_ended_total" in answer.text
