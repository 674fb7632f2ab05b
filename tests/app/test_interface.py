"""The page that describes the interface."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import httpx
import pytest

from app.main import create_app
from app.settings import Settings
from tests.app.conftest import fake_house, serving


class _Parts(HTMLParser):
    """Ids, and what the page fetches or links to."""

    def __init__(self) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.targets: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note one element."""
        for name, value in attrs:
            if name == "id":
                self.ids.add(value or "")
            elif name in ("src", "href", "srcset"):
                self.targets.append(value or "")


@pytest.fixture
async def answers(tmp_path: Path) -> tuple[httpx.Response, httpx.Response, httpx.Response]:
    """The page, the description it is made of, and a page that is not there."""
    settings = Settings(database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error")
    async with serving(create_app(settings, fake_house)) as client:
        return await client.get("/docs"), await client.get("/openapi.json"), await client.get("/redoc")


async def test_page_tells_every_call_and_needs_no_network(
    answers: tuple[httpx.Response, httpx.Response, httpx.Response],
) -> None:
    """Every call and schema is on the page; it links to itself and this service alone."""
    page, description, absent = answers
    assert page.headers["content-type"].startswith("text/html")
    parts = _Parts()
    parts.feed(page.text)
    api = description.json()
    calls = {call["operationId"] for item in api["paths"].values() for call in item.values()}
    assert calls | {f"schema-{name}" for name in api["components"]["schemas"]} <= parts.ids
    assert [target for target in parts.targets if not re.match(r"/(?!/)|#|data:", target)] == []
    assert {target[1:] for target in parts.targets if target.startswith("#")} <= parts.ids
    assert absent.status_code == 404


def _numbers(
    schema: dict[str, Any], parts: dict[str, Any], where: str
) -> Iterator[tuple[str, dict[str, Any]]]:
    """The numbers that a schema lets in, by where they stand."""
    if "$ref" in schema:
        schema = parts[schema["$ref"].rpartition("/")[2]]
    if schema.get("type") in ("integer", "number"):
        yield where, schema
    for one in (*schema.get("anyOf", ()), *schema.get("oneOf", ()), *schema.get("prefixItems", ())):
        yield from _numbers(one, parts, where)
    for name, one in schema.get("properties", {}).items():
        yield from _numbers(one, parts, f"{where}.{name}")
    for name in ("items", "additionalProperties"):
        if isinstance(schema.get(name), dict):
            yield from _numbers(schema[name], parts, f"{where}[]")


async def test_every_number_of_a_request_has_bounds(
    answers: tuple[httpx.Response, httpx.Response, httpx.Response],
) -> None:
    """Numbers of queries and of bodies say their least and their most."""
    api = answers[1].json()
    parts = api["components"]["schemas"]
    asked: list[tuple[str, dict[str, Any]]] = []
    for path, item in api["paths"].items():
        for method, call in item.items():
            given = [(one["name"], one["schema"]) for one in call.get("parameters", ())]
            bodies = [
                body.get("schema", {}) for body in call.get("requestBody", {}).get("content", {}).values()
            ]
            given += [("body", body) for body in bodies]
            for name, schema in given:
                asked += _numbers(schema, parts, f"{method} {path} {name}")
    assert {where.rpartition(" ")[2] for where, _ in asked} >= {"wait", "limit", "offset", "width_m"}
    boundless = [
        where
        for where, schema in asked
        if not {"minimum", "exclusiveMinimum"} & set(schema)
        or not {"maximum", "exclusiveMaximum"} & set(schema)
    ]
    assert boundless == []


@pytest.mark.parametrize("wait", ["3.7e16", "inf", "nan", "-1"])
async def test_waits_without_end_are_refused(tmp_path: Path, wait: str) -> None:
    """A wait beyond an hour, below nothing or of no number is a 422 that names it and its bounds."""
    settings = Settings(database=tmp_path / "plans.db", workers=1, static_dir=tmp_path, log_level="error")
    async with serving(create_app(settings, fake_house)) as client:
        answer = await client.post("/api/v1/plans", params={"wait": wait}, content=b"{}")
    assert answer.status_code == 422
    assert "wait" in answer.text
