"""The built page, served by the real service, in Debian's chromium."""

from __future__ import annotations

import json
import os
import select
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest
from playwright.sync_api import Browser, Page, expect, sync_playwright

from tests.patience import PATIENCE_S

ROOT = Path(__file__).resolve().parents[3]
PAGE = ROOT / "static" / "dist" / "index.html"
EXAMPLES = ROOT / "examples"
CHROMIUM = shutil.which("chromium")
CHROMIUM_FLAGS = [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
#: How long the page may take for anything, ms.
PATIENCE_MS = PATIENCE_S * 1000.0
#: Slower for a good picture: see docs/map.md.
SPEEDUP = int(os.environ.get("SWATHPLAN_TEST_SPEEDUP", "200"))
#: The processor draws a quarter of the points where nobody looks; the page's own pixels are as ever.
SCALE = 1.0 if "SWATHPLAN_SCREENSHOT" in os.environ else 0.2


@dataclass(frozen=True, slots=True)
class Service:
    """A running service and where it answers."""

    address: str

    def get(self, path: str) -> httpx.Response:
        return httpx.get(self.address + path, timeout=PATIENCE_S)


def _first_line(process: subprocess.Popen[str]) -> str:
    assert process.stdout is not None
    ready, _, _ = select.select([process.stdout], [], [], PATIENCE_S)
    line = process.stdout.readline() if ready else ""
    if not line:
        raise RuntimeError("the service did not say where it listens")
    return line


@contextmanager
def serving(folder: Path, speedup: int) -> Iterator[Service]:
    """A service of its own: fresh database, free port, one simulated aircraft in quick motion."""
    if not PAGE.is_file():
        pytest.skip("the map is not built: run npm ci and npm run build in static/")
    command = [sys.executable, "-m", "app.cli", "serve", "--port", "0", "--json"]
    command += ["--database", str(folder / "swathplan.db"), "--workers", "1"]
    command += ["--sim", "--sim-url", f"sim:?speedup={speedup}"]
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(
            command,
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
            env=os.environ | {"PYTHONPATH": "", "SWATHPLAN_REQUEST_TIME_LIMIT_S": str(PATIENCE_S)},
        )
        try:
            address = json.loads(_first_line(process))["address"]
            yield Service(address)
        finally:
            process.terminate()
            try:
                process.wait(15.0)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            if process.stdout is not None:
                process.stdout.close()


@pytest.fixture(scope="package")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """The service that most of the page's tests share."""
    with serving(tmp_path_factory.mktemp("service"), SPEEDUP) as started:
        yield started


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    """Chromium without a window; WebGL is drawn by the processor."""
    if CHROMIUM is None:
        pytest.skip("Debian's chromium is not installed")
    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=CHROMIUM, headless=True, args=CHROMIUM_FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def page(browser: Browser, service: Service) -> Iterator[Page]:
    """A page of its own for each test file, since opening one costs seconds where no GPU draws.

    At the end no script may have failed, and nothing may have been asked of another host. To wait for a
    function is to evaluate a text, which the page's policy forbids: it is off here, and has its own test.
    """
    context = browser.new_context(
        bypass_csp=True,
        viewport={"width": 1400, "height": 860},
        color_scheme="light",
        device_scale_factor=SCALE,
    )
    # The suite's other processes share the processors; what comes late is still right.
    context.set_default_timeout(PATIENCE_MS)
    expect.set_options(timeout=PATIENCE_MS / 3)
    opened = context.new_page()
    failures: list[str] = []
    opened.on("pageerror", lambda error: failures.append(str(error)))
    outside: list[str] = []
    opened.on(
        "request",
        lambda request: (
            outside.append(request.url)
            if not request.url.startswith((service.address, "blob:", "data:"))
            else None
        ),
    )
    opened.goto(service.address)
    opened.wait_for_function("window.swathplan !== undefined")
    yield opened
    context.close()
    assert failures == []
    assert outside == [], "the page asked for something that is not its own"
