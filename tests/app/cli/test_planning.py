"""Plan and validate: results, messages, exit codes."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import rasterio
from rasterio.transform import from_origin

from app.routers.bodies import EXAMPLE
from tests.app.cli.conftest import Command, broken
from tests.planner.search.searches import WING, document


def test_plan_from_file_to_file(swathplan: Command, scenario_file: Path, tmp_path: Path) -> None:
    """The plan goes to the file, its figures to standard output, messages to standard error."""
    output = tmp_path / "plan.geojson"
    ended = swathplan("plan", str(scenario_file), "-o", str(output), "--json")
    plan = json.loads(output.read_text())
    summary = json.loads(ended.out)
    assert ended.code == 0
    assert summary["metrics"] == plan["metrics"]
    assert min(plan["metrics"]["coverage"].values()) >= 0.9999
    assert "2 of 2 regions covered" in ended.err
    assert [path.name for path in tmp_path.iterdir() if "partial" in path.name] == []


def test_segments_of_a_plan_are_written_and_counted(swathplan: Command, tmp_path: Path) -> None:
    """Of the files alone; a target that is none of the regions is bad input."""
    scenario, plan = tmp_path / "scenario.geojson", tmp_path / "plan.geojson"
    scenario.write_text(json.dumps(EXAMPLE))
    swathplan("plan", str(scenario), "-o", str(plan))
    output = tmp_path / "network.geojson"
    ended = swathplan("network", str(plan), str(scenario), "-o", str(output), "--json")
    assert ended.code == 0
    found = [f["properties"] for f in json.loads(output.read_text())["features"]]
    segments = [each for each in found if each["role"] == "segment"]
    told = json.loads(ended.out)
    assert told["segments"] == len(segments)
    assert told["chosen"] == sum(each["chosen"] for each in segments)
    wrong = swathplan("network", str(plan), str(scenario), "--target", "nowhere")
    assert wrong.code == 2
    assert "nowhere" in wrong.err


def test_plan_through_pipes_is_repeatable(swathplan: Command) -> None:
    """``-`` is standard input, the plan comes on standard output; times aside it is the same each time."""
    first, second = (swathplan("plan", "-", "--seed", "3", stdin=json.dumps(EXAMPLE)) for _ in range(2))
    plans = [json.loads(ended.out) for ended in (first, second)]
    for plan in plans:
        plan["metrics"].pop("planning_time_s")
    assert plans[0] == plans[1]
    assert plans[0]["seed"] == 3


@pytest.mark.parametrize("command", ["plan", "validate"])
def test_refused_scenario_exits_2_with_every_finding(swathplan: Command, command: str) -> None:
    """A refused scenario is told rule by rule, as text and as JSON, never as a traceback."""
    text = swathplan(command, "-", stdin=json.dumps(broken()))
    as_json = swathplan(command, "-", "--json", stdin=json.dumps(broken()))
    assert (text.code, as_json.code) == (2, 2)
    told = text.out + text.err
    assert "harbour" in told
    assert "altitude_m" in told
    assert "Traceback" not in told
    body = json.loads(as_json.out or as_json.err)
    findings = body.get("errors") or body["findings"]
    assert {"harbour", "scenario"} <= {finding["feature"] for finding in findings}


def test_a_search_is_told_by_what_it_sees(swathplan: Command, tmp_path: Path) -> None:
    """Ground seen, importance and energy, on standard error; a raster of importance is a file."""
    worth = tmp_path / "worth.tif"
    scores = np.full((8, 8), 2.0, dtype=np.float32)
    shape = {"driver": "GTiff", "width": 8, "height": 8, "count": 1, "dtype": "float32", "crs": "EPSG:4326"}
    with rasterio.open(worth, "w", **shape, transform=from_origin(9.99, 47.02, 0.005, 0.005)) as file:
        file.write(scores, 1)
    asked = ("plan", "-", "--importance-raster", str(worth), "-o", str(tmp_path / "plan.geojson"), "--json")
    ended = swathplan(*asked, stdin=json.dumps(document(vehicle=WING | {"energy_wh": 14})))
    metrics = json.loads(ended.out)["metrics"]
    assert ended.code == 0
    assert metrics["importance_collected"] == pytest.approx(2.0 * metrics["area_seen_m2"], rel=0.05)
    assert "searched: " in ended.err
    assert "km² seen" in ended.err
    assert "regions covered" not in ended.err
    assert swathplan("validate", "-", stdin=json.dumps(document(max_height_m=50))).code == 2
