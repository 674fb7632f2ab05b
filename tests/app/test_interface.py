"""The page that describes the interface."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path

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
