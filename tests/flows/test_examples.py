"""Every example runs as its reader would run it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from planner.geojson import read_plan

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"


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
    assert min(seen.values()) > 0.99
