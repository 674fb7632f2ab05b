"""The page under its own content security policy: all of it works, and nothing is refused."""

from __future__ import annotations

import time

import pytest
from playwright.sync_api import Browser

from tests.app.browser.conftest import EXAMPLES, SCALE, Service
from tests.patience import PATIENCE_S

pytestmark = pytest.mark.browser


def test_nothing_of_the_page_is_refused(browser: Browser, service: Service) -> None:
    """World, scenario, a validation, pictures from elsewhere: drawn, and no violation is told."""
    context = browser.new_context(device_scale_factor=SCALE)
    page = context.new_page()
    told: list[str] = []
    page.on("pageerror", lambda error: told.append(str(error)))
    page.on("console", lambda line: told.append(line.text) if "Content Security" in line.text else None)
    page.goto(service.address)

    def wait(condition: str) -> None:
        # Looked at from outside: waiting within the page would be evaluating a text there.
        end_s = time.monotonic() + PATIENCE_S
        while not page.evaluate(condition):
            assert time.monotonic() < end_s, told
            time.sleep(0.1)

    wait("window.swathplan !== undefined && window.swathplan.rendered()['land'] > 0")
    before = page.evaluate("window.swathplan.replaced()")
    page.set_input_files("#file", EXAMPLES / "sar-case-1.geojson")
    wait(f"window.swathplan.replaced() > {before}")
    page.evaluate(
        """() => {
            const picture = new Image();
            picture.onerror = () => { window.tried = 1; };
            picture.src = "https://127.0.0.1:1/0/0/0.png";
        }"""
    )
    wait("window.tried === 1")
    assert told == []
    # The policy is there: what is no script of the service's is not run.
    page.evaluate(
        """() => {
            const script = document.createElement("script");
            script.text = "window.bad = 1";
            document.body.append(script);
        }"""
    )
    assert page.evaluate("window.bad === undefined")
    assert len(told) == 1
    context.close()
