"""Export, upload, download and the demo: results, messages, exit codes."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from app.routers.bodies import EXAMPLE
from mavlink.formats import qgc_plan, waypoints
from mavlink.wire import items
from tests.app.cli.conftest import Command
from tests.patience import PATIENCE_S
from tests.planner.as_flown.test_photos import asked


def test_export_writes_what_readers_read(swathplan: Command, plan_file: Path) -> None:
    """Each format can be exported; .plan and .waypoints hold the same items."""
    plan = qgc_plan.read_plan(swathplan("export", str(plan_file)).out)
    rows = waypoints.read_waypoints(swathplan("export", str(plan_file), "--format", "waypoints").out)
    assert [item.command for item in plan.mission] == [item.command for item in rows.mission]
    assert "<kml" in swathplan("export", str(plan_file), "--format", "kml").out
    assert swathplan("export", str(plan_file), "--payload", "laser").code == 2
    assert swathplan("export", str(plan_file), "--gimbal", "crane").code == 2
    pointed = qgc_plan.read_plan(swathplan("export", str(plan_file), "--gimbal", "manager:tilt=45").out)
    assert items.Command.DO_GIMBAL_MANAGER_PITCHYAW in {item.command for item in pointed.mission}
    assert swathplan("export", str(plan_file), "--vehicle", "nobody").code == 2


def test_upload_reads_back_and_tells(swathplan: Command, plan_file: Path) -> None:
    """An upload ends with the comparison; one the aircraft alters exits with 1."""
    ended = swathplan(
        "upload", str(plan_file), "--to", "sim:", "--part", "mission", "--part", "fence", "--json"
    )
    report = json.loads(ended.out)
    assert (ended.code, report["outcome"], report["verified"]) == (0, "accepted", True)
    assert "read back equal" in ended.err
    altered = swathplan("upload", str(plan_file), "--to", "sim:?fault=altered_item")
    assert altered.code == 1
    assert "read back with 1 difference\n" in altered.err


def test_an_interrupted_upload_says_what_is_not_known(plan_file: Path) -> None:
    """Ctrl-C while the vehicle asks for nothing more: told in words, 130, no traceback."""
    # Where the suite itself runs in the background, its processes are begun with interrupts ignored.
    heeding = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    program = [sys.executable, "-c", f"{heeding}; from app.cli import main; main()"]
    command = [*program, "upload", str(plan_file), "--to", "sim:?fault=no_request_1"]
    # The aircraft, a process of its own, may begin late on a busy machine.
    command += ["--timeout-s", str(PATIENCE_S)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as running:
        assert running.stderr is not None
        told = []
        for line in running.stderr:
            told.append(line)
            if "sending the mission" in line:
                running.send_signal(signal.SIGINT)
    assert running.returncode == 130, told
    assert told[-1].startswith("interrupted: the vehicle may hold what it held before")
    assert "Traceback" not in "".join(told)


def test_a_mission_over_the_limit_is_refused_with_number_limit_and_fix(
    swathplan: Command, plan_file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The command line says how many items there are, how many are held, and what to do."""
    monkeypatch.setattr("mavlink.dialects.px4.DEFAULT_MISSION_LIMIT", 9)
    refused = swathplan("upload", str(plan_file), "--to", "sim:?autopilot=px4", "--override", "a test")
    assert refused.code == 2
    assert "items, the vehicle holds 9" in refused.err
    assert "sorties: plan each with a part of the regions" in refused.err


def test_upload_of_a_violating_plan_needs_a_reason(
    swathplan: Command, plan_file: Path, tmp_path: Path
) -> None:
    """Hard violations stop an upload unless a reason is given."""
    plan = json.loads(plan_file.read_text())
    violation = {"constraint": "hard-zone", "feature": "site", "message": "flown through", "amount": 1.0}
    plan["violations"] = [violation | {"unit": "m", "where": None, "hard": True}]
    path = tmp_path / "violating.geojson"
    path.write_text(json.dumps(plan))
    refused = swathplan("upload", str(path), "--to", "sim:")
    assert refused.code == 1
    assert "flown through" in refused.err
    assert swathplan("upload", str(path), "--to", "sim:", "--override", "zone is cold").code == 0


def test_upload_of_a_plan_of_another_scenario_needs_a_reason(
    swathplan: Command, plan_file: Path, scenario_file: Path, tmp_path: Path
) -> None:
    """Held against the scenario as it is now: the same goes up, a changed one only with a reason."""
    same = swathplan("upload", str(plan_file), "--to", "sim:", "--scenario", str(scenario_file))
    assert same.code == 0, same.err
    changed = tmp_path / "changed.geojson"
    changed.write_text(json.dumps(EXAMPLE | {"seed": 1}))
    stale = ("upload", str(plan_file), "--to", "sim:", "--scenario", str(changed))
    refused = swathplan(*stale)
    assert refused.code == 1
    assert "plan-stale" in refused.err
    assert swathplan(*stale, "--override", "only the seed differs").code == 0


def test_download_from_an_empty_vehicle(swathplan: Command) -> None:
    """What a fresh aircraft holds can be saved in each form."""
    held = json.loads(swathplan("download", "--from", "sim:", "--json").out)
    assert set(held) == {"mission", "fence", "rally"}
    assert held["fence"] == held["rally"] == []


def test_demo_flies_what_it_planned(swathplan: Command, scenario_file: Path) -> None:
    """The whole journey, told as JSON: planned, uploaded, read back, flown, all but all of it seen."""
    scenario = json.loads(scenario_file.read_text())
    for holder, name in (("vehicles", "settle_m"), ("sensors", "pointing_margin_deg")):
        scenario[holder][0][name] = 0.0
    scenario_file.write_text(json.dumps(scenario))
    ended = swathplan("demo", str(scenario_file), "--speedup", "500", "--margins", "autopilot", "--json")
    told = json.loads(ended.out)
    assert ended.code == 0, ended.err
    assert told["read_back_equal"]
    assert told["cross_track_max_m"] < 10.0
    assert min(told["seen"].values()) > 0.999


@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_demo_flies_a_multirotor_where_the_plan_has_one(
    swathplan: Command, scenario_file: Path, autopilot: str
) -> None:
    """What is simulated is the plan's vehicle: lines within a metre, all of the regions seen."""
    scenario = json.loads(scenario_file.read_text())
    scenario["vehicles"][0] |= {"type": "multirotor", "autopilot": autopilot, "min_turn_radius_m": 60}
    scenario_file.write_text(json.dumps(scenario))
    ended = swathplan("demo", str(scenario_file), "--speedup", "500", "--json")
    assert ended.code == 0, ended.err
    told = json.loads(ended.out)
    assert told["violations"] == []
    assert told["read_back_equal"]
    assert told["cross_track_max_m"] < 1.5
    assert min(told["seen"].values()) > 0.9999


def test_demo_counts_the_photos_of_a_camera(swathplan: Command, tmp_path: Path) -> None:
    """As many as were planned, and all of the region seen in them."""
    scenario = tmp_path / "survey.geojson"
    scenario.write_text(json.dumps(asked()))
    ended = swathplan("demo", str(scenario), "--speedup", "500", "--margins", "autopilot", "--json")
    assert ended.code == 0, ended.err
    told = json.loads(ended.out)
    assert told["photos_taken"] == told["photos_counted"] == told["photos_planned"] > 0
    assert told["seen"]["A"] > 0.999


def test_demo_says_why_it_flies_no_vtol(swathplan: Command, scenario_file: Path) -> None:
    """Exit code 2 and the reason."""
    scenario = json.loads(scenario_file.read_text())
    scenario["vehicles"][0]["type"] = "vtol"
    scenario_file.write_text(json.dumps(scenario))
    ended = swathplan("demo", str(scenario_file))
    assert ended.code == 2
    assert "no vtol is simulated" in ended.err


def test_a_mission_file_is_judged_and_uploaded_as_it_is(swathplan: Command, tmp_path: Path) -> None:
    """The items of a .waypoints go up, are read back and compared; out of its own fence they do not."""
    place = "\t{}\t0\t3\t{}\t{}\t0\t0\t0\t{}\t{}\t{}\t1"
    route = ["0\t1\t0\t16\t0\t0\t0\t0\t47.1\t8.2\t450\t1"]
    route += [place.format(0, 16, 0, 47.105, 8.2, 60)[1:], place.format(0, 16, 0, 47.105, 8.21, 60)[1:]]
    square = [(47.0, 8.1), (47.2, 8.1), (47.2, 8.3), (47.0, 8.3)]
    fence = [place.format(0, 5001, 4, lat, lon, 0)[1:] for lat, lon in square]
    file = tmp_path / "flight.waypoints"
    file.write_text("\n".join(["QGC WPL 110", "# a survey", *route, *fence]))
    ended = swathplan(
        *("upload", str(file), "--to", "sim:", "--part", "mission", "--part", "fence", "--json")
    )  # fmt: skip
    assert ended.code == 0, ended.err
    parts = json.loads(ended.out)["parts"]
    assert [parts[name]["meant"] for name in ("mission", "fence")] == [3, 4]
    assert all(part["verified"] for part in parts.values())
    assert "line 2: the comments are left out" in ended.err
    file.write_text("\n".join(["QGC WPL 110", *route, *fence]).replace("8.3\t", "8.205\t"))
    refused = swathplan("upload", str(file), "--to", "sim:")
    assert refused.code == 1
    assert "are flown outside the operating area (area)" in refused.err


def test_a_mission_file_is_judged_in_a_scenario(
    swathplan: Command, scenario_file: Path, tmp_path: Path
) -> None:
    """Hard zones of --scenario hold for a file too; what cannot be read exits with 2."""
    scenario = json.loads(scenario_file.read_text())
    start = next(f for f in scenario["features"] if f["properties"]["role"] == "start")
    lon, lat = start["geometry"]["coordinates"][:2]
    zone = {"type": "Point", "coordinates": [lon, lat + 0.004]}
    scenario["features"].append(
        {"type": "Feature", "geometry": zone, "id": "mast", "properties": {"role": "no_fly", "radius_m": 50}}
    )
    zoned = tmp_path / "zoned.geojson"
    zoned.write_text(json.dumps(scenario))
    file = tmp_path / "flight.waypoints"
    rows = [
        f"0\t1\t0\t16\t0\t0\t0\t0\t{lat}\t{lon}\t0\t1",
        f"1\t0\t3\t16\t0\t0\t0\t0\t{lat + 0.01}\t{lon}\t60\t1",
    ]
    file.write_text("\n".join(["QGC WPL 110", *rows]))
    refused = swathplan("upload", str(file), "--to", "sim:", "--scenario", str(zoned))
    assert refused.code == 1
    assert "inside mast" in refused.err
    file.write_text("QGC WPL 110\n0\t1\n")
    assert swathplan("upload", str(file), "--to", "sim:").code == 2
