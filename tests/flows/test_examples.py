"""Every example runs as its reader would run it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from app.cli.planning import with_raster
from planner.geojson import read_plan
from planner.pipeline import make_plan
from planner.validate import read_valid

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


def test_field_survey_follows_its_wish_over_terrain() -> None:
    """Planned over its raster: all seen, no pixel coarser than asked, overlaps kept, every photo in time."""
    document, terrain = with_raster(
        json.loads((EXAMPLES / "field-survey.geojson").read_text()),
        str(EXAMPLES / "field-survey.tif"),
        "terrain",
    )
    plan = make_plan(read_valid(document, {terrain.name: terrain}))
    survey = plan.metrics.surveys["vineyard"]
    assert plan.violations == ()
    assert plan.metrics.coverage == {"vineyard": 1.0}
    assert survey.gsd_m is not None
    assert survey.gsd_m <= 0.025
    assert min(survey.forward_overlap - 0.8, survey.side_overlap - 0.7) >= -0.002


def test_inspection_has_the_quality_that_it_requires() -> None:
    """Each region from its own height, between the lowest and the highest allowed."""
    document = json.loads((EXAMPLES / "inspection.geojson").read_text())
    plan = make_plan(read_valid(document))
    assert plan.violations == ()
    for name, least in (("panels", 8.8), ("substation", 9.0)):
        niirs = plan.metrics.surveys[name].niirs
        assert niirs is not None
        assert least <= niirs <= least + 0.01
    assert (
        30.0 <= min(c.line[0][2] for c in plan.collects) < max(c.line[0][2] for c in plan.collects) <= 120.0
    )


def test_the_volcano_is_searched_where_it_is_worth_most() -> None:
    """The island's plan keeps its reserve, and sees more of what is important than of the ground."""
    scenario = read_valid(json.loads((EXAMPLES / "island-volcano.geojson").read_text()))
    plan = make_plan(scenario)
    worth = sum(patch.score * patch.area.area for patch in scenario.importance.patches)
    assert plan.violations == ()
    assert (plan.metrics.energy_wh or 0.0) <= (scenario.aircraft[0].usable_wh or 0.0)
    assert (plan.metrics.importance_collected or 0.0) > 1.5 * plan.metrics.coverage["island"] * worth


def test_two_aircraft_search_the_fire_front() -> None:
    """Each keeps its reserve and has a share; both together see more of the front than of the rest."""
    scenario = read_valid(json.loads((EXAMPLES / "fire-front.geojson").read_text()))
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert set(plan.metrics.vehicles) == {"north", "south"}
    for aircraft in scenario.aircraft:
        assert aircraft.usable_wh is not None
        used_wh = plan.metrics.vehicles[aircraft.name].energy_wh
        assert used_wh is not None
        assert 0.5 * aircraft.usable_wh < used_wh <= aircraft.usable_wh
    seen_m2, worth = plan.metrics.area_seen_m2, plan.metrics.importance_collected
    assert seen_m2 is not None
    assert worth is not None
    # A square metre of the front is worth 5, of the village 3, of the rest 0.3 or nothing.
    assert worth > 3.0 * seen_m2


def test_someone_overboard_is_looked_for_where_the_drift_leads() -> None:
    """The flight keeps its reserve, and finds as likely as not who by then is nowhere near the point."""
    scenario = read_valid(json.loads((EXAMPLES / "missing-at-sea.geojson").read_text()))
    plan = make_plan(scenario)
    assert plan.violations == ()
    assert (plan.metrics.energy_wh or 0.0) <= (scenario.aircraft[0].usable_wh or 0.0)
    assert plan.metrics.importance_total == pytest.approx(1.0, rel=1e-3)
    assert (plan.metrics.importance_collected or 0.0) > 0.6
