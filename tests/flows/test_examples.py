"""Every example runs as its reader would run it."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from planner.geojson import read_plan

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"


@pytest.fixture
def service(tmp_path: Path) -> Iterator[str]:
    """A service of its own on a free port."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [
        sys.executable,
        "-m",
        "app.cli",
        "serve",
        "--port",
        str(port),
        "--database",
        str(tmp_path / "s.db"),
    ]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    address = f"http://127.0.0.1:{port}"
    try:
        for _ in range(300):
            try:
                if httpx.get(f"{address}/health/ready").status_code == 200:
                    break
            except httpx.TransportError:
                time.sleep(0.1)
        else:
            pytest.fail("the service did not come up")
        yield address
    finally:
        process.terminate()
        process.wait(timeout=30)


def test_library_example_writes_a_sound_plan(tmp_path: Path) -> None:
    """The library example prints the coverage and writes a plan without violations and a mission file."""
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / "library.py"), str(EXAMPLES / "sar-case-2.geojson"), str(tmp_path)],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=120,
        check=True,
    )
    assert "R1: 100.00% seen" in done.stdout
    plan = read_plan(json.loads((tmp_path / "plan.geojson").read_text()))
    assert plan.violations == ()
    assert json.loads((tmp_path / "mission.plan").read_text())["fileType"] == "Plan"


def test_curl_journey_flies_and_sees(service: str, tmp_path: Path) -> None:
    """The curl script plans, uploads, flies a simulated aircraft, and what was seen is nearly everything."""
    done = subprocess.run(
        ["sh", str(EXAMPLES / "journey.sh"), str(EXAMPLES / "sar-case-1.geojson"), service],
        capture_output=True,
        text=True,
        timeout=180,
        check=False,
        env=os.environ | {"TMPDIR": str(tmp_path)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "upload: accepted, read back equal: True" in done.stdout
    seen = json.loads(done.stdout.rsplit("seen: ", 1)[1].replace("'", '"'))
    assert set(seen) == {"R1", "R2", "R3", "R4", "R5", "R6"}
    assert min(seen.values()) > 0.995
