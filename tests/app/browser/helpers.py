"""What the browser tests do again and again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx
from playwright.sync_api import Page

from tests.app.browser.conftest import EXAMPLES, Service
from tests.patience import PATIENCE_S


def ask(page: Page, expression: str) -> Any:
    """Evaluate something of the page's test hook."""
    return page.evaluate(f"window.swathplan.{expression}")


def await_hook(page: Page, condition: str, limit_s: float = PATIENCE_S) -> None:
    """Wait until an expression of the test hook is true."""
    page.wait_for_function(f"window.swathplan.{condition}", timeout=limit_s * 1000)


def open_scenario(page: Page, path: Path = EXAMPLES / "sar-case-1.geojson") -> None:
    """Open a scenario by the file input and wait until the service has judged it."""
    page.get_by_role("tab", name="Scenario").click()
    count = ask(page, "replaced()")
    page.set_input_files("#file", path)
    page.wait_for_function(
        "count => document.querySelector('#dialog-go') || window.swathplan.replaced() > count", arg=count
    )
    if page.locator("#dialog-go").count():
        # Edits of a test before are nowhere else: the page asks.
        page.click("#dialog-go")
        page.wait_for_function("count => window.swathplan.replaced() > count", arg=count)
    # A tab that was just opened may have taken the newest plan's scenario first.
    if name := json.loads(path.read_text()).get("name"):
        page.wait_for_function("name => window.swathplan.scenario().name === name", arg=name)
    page.wait_for_selector("#findings:not([data-state=asking]):not([data-state=empty])")


def on_screen(page: Page, lon_deg: float, lat_deg: float) -> tuple[float, float]:
    """Where a place is on the screen, in pixels."""
    box = page.locator("#map").bounding_box()
    assert box is not None
    x, y = ask(page, f"project({lon_deg}, {lat_deg})")
    return box["x"] + x, box["y"] + y


def click_place(page: Page, lon_deg: float, lat_deg: float) -> None:
    """Click a place on the map, as a hand does: move there, then press."""
    x, y = on_screen(page, lon_deg, lat_deg)
    page.mouse.move(x - 3, y - 3)
    page.mouse.move(x, y)
    page.mouse.click(x, y)
    # A second click too soon after would be a double click.
    page.wait_for_timeout(350)


def feature(page: Page, name: str) -> dict[str, Any] | None:
    """A feature of the scenario being edited."""
    found = [f for f in ask(page, "scenario()")["features"] if f["id"] == name]
    return found[0] if found else None


@contextmanager
def connected(service: Service, *names: str, speedup: int = 50) -> Iterator[list[str]]:
    """Simulated vehicles of these names, for as long as they are needed: their ids."""
    path = service.address + "/api/v1/vehicles"
    ids: list[str] = []
    try:
        for name in names:
            answer = httpx.post(
                path, json={"name": name, "url": f"sim:?speedup={speedup}"}, timeout=PATIENCE_S
            )
            answer.raise_for_status()
            ids.append(answer.json()["id"])
        yield ids
    finally:
        for vehicle in ids:
            httpx.delete(f"{path}/{vehicle}?in_flight=true", timeout=PATIENCE_S).raise_for_status()
