"""The command line: results, messages, exit codes."""

from __future__ import annotations

import fcntl
import io
import json
import socket
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from app.cli.root import run
from app.routers.bodies import EXAMPLE
from mavlink.formats import qgc_plan, waypoints
from mavlink.wire import items

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True, slots=True)
class Ended:
    """How a command ended."""

    code: int
    out: str
    err: str


Command = Callable[..., Ended]


@pytest.fixture
def swathplan(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Command:
    """Runs the command line in this process."""

    def command(*arguments: str, stdin: str = "") -> Ended:
        monkeypatch.setattr(sys, "argv", ["swathplan", *arguments])
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin.encode())))
        capfd.readouterr()
        with pytest.raises(SystemExit) as end:
            run()
        written = capfd.readouterr()
        code = end.value.code
        return Ended(code if isinstance(code, int) else 0, written.out, written.err)

    return command


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    """The example in a file."""
    path = tmp_path / "scenario.geojson"
    path.write_text(json.dumps(EXAMPLE))
    return path


def broken() -> dict[str, Any]:
    """The example with a ring that crosses itself and a wrong altitude."""
    scenario: dict[str, Any] = json.loads(json.dumps(EXAMPLE))
    ring = scenario["features"][0]["geometry"]["coordinates"][0]
    ring[1], ring[2] = ring[2], ring[1]
    return scenario | {"altitude_m": -1}


def test_help_lists_every_command() -> None:
    """A process of its own answers --help with all commands and exit code 0."""
    command = [sys.executable, "-m", "app.cli", "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=30, check=True)
    commands = ("serve", "plan", "validate", "export", "upload", "download", "convert", "import", "sim")
    commands = (*commands, "bench", "demo")
    assert all(f" {name} " in ended.stdout for name in commands)


@pytest.mark.parametrize("name", ["serve", "upload"])
def test_help_tells_what_is_taken_when_left_out(name: str) -> None:
    """The help's text reaches the screen whole: words in square brackets would be taken for markup."""
    command = [sys.executable, "-m", "app.cli", name, "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=30, check=True)
    assert "when left out" in " ".join(ended.stdout.replace("│", " ").split())


def test_serve_on_what_is_taken_exits_1(tmp_path: Path) -> None:
    """A taken port and a database in use end the service with 1 and the reason in words."""

    def serve(port: int, database: Path) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "app.cli", "serve", "--port", str(port), "--database", str(database)]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60, check=False)

    with socket.create_server(("127.0.0.1", 0)) as taken:
        ended = serve(taken.getsockname()[1], tmp_path / "a.db")
    assert ended.returncode == 1
    assert "Choose another with --port" in ended.stderr
    with (tmp_path / "b.db.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        ended = serve(0, tmp_path / "b.db")
    assert ended.returncode == 1
    assert "error: the service cannot start: another service is at work on" in ended.stderr


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


@pytest.mark.parametrize(
    ("arguments", "stdin"),
    [
        (("plan", "-"), "{"),
        (("plan", "-"), '{"altitude_m": NaN}'),
        (("plan", "-"), "[]"),
        (("plan", "no-such-file"), ""),
        (("plan", "-", "--method", "transit"), "{}"),
        (("plan",), ""),
        (("plan", "-", "--no-such-option"), ""),
        (("export", "-"), json.dumps(EXAMPLE)),
        (("upload", "-", "--to", "sim:"), "{}"),
        (("download", "--from", "nonsense"), ""),
        (("download", "--from", "udpin:127.0.0.1:port"), ""),
        (("download", "--from", "tcp:127.0.0.1:99999"), ""),
        (("download", "--from", "serial:/dev/ttyUSB0:0"), ""),
        (("download", "--from", "replay:flight.tlog?speedup=-1"), ""),
        (("download", "--from", "sim:?airspeed=300"), ""),
        (("sim", "--url", "nonsense"), ""),
        (("sim", "--url", "udpout:127.0.0.1:99999"), ""),
        (("sim", "--url", "replay:flight.tlog"), ""),
        (("serve", "--sim-url", "sim:?wind=-3,270"), ""),
        (("serve", "--sim-url", "udpin:127.0.0.1:14550"), ""),
        (("serve", "--port", "99999"), ""),
        (("bench", "no-such"), ""),
        (("serve", "--host", "0.0.0.0"), ""),
    ],
)
def test_bad_usage_and_input_exit_2(swathplan: Command, arguments: tuple[str, ...], stdin: str) -> None:
    """Bad usage and bad input exit with 2, a message on standard error and nothing on standard output."""
    ended = swathplan(*arguments, stdin=stdin)
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err
    assert "Traceback" not in ended.err


def without_regions() -> str:
    """The example without its regions."""
    return json.dumps(
        EXAMPLE | {"features": [f for f in EXAMPLE["features"] if f["properties"]["role"] != "roi"]}
    )


def exchanged() -> str:
    """The example, west of 90° W, with latitude first."""

    def turned(value: Any) -> Any:
        if isinstance(value[0], list):
            return [turned(item) for item in value]
        return [value[1], value[0]]

    features = [
        feature
        | {"geometry": feature["geometry"] | {"coordinates": turned(feature["geometry"]["coordinates"])}}
        for feature in EXAMPLE["features"]
    ]
    return json.dumps(EXAMPLE | {"features": features})


@pytest.mark.parametrize(
    ("arguments", "stdin", "code", "words"),
    [
        (("validate", "-"), '{"type": }', 2, ("standard input", "line 1, column 10", "json-syntax", "mend")),
        (("validate", "-"), "<kml/>", 2, ("looks like XML", "json-syntax", "swathplan import")),
        (("validate", "-"), "", 2, ("is empty", "json-syntax", "FeatureCollection")),
        (("validate", "-"), without_regions(), 2, ("scenario", "no-region", "Add a feature of role roi")),
        (("validate", "-"), exchanged(), 2, ("scenario", "axes-swapped", "write [longitude, latitude]")),
        (
            ("validate", "-"),
            json.dumps(EXAMPLE | {"altitude_m": 0.01}),
            2,
            ("too-many-passes", "0.01 m up", "Fly higher"),
        ),
        (("validate", "-"), json.dumps(EXAMPLE | {"altitude_m": 4}), 0, ("many-passes", "Fly higher")),
        (
            ("plan", "-", "--method", "routing=magic"),
            json.dumps(EXAMPLE),
            2,
            ("method", "unknown-value", "Use one of: auto, joint"),
        ),
        (
            ("plan", "-"),
            json.dumps(EXAMPLE | {"method": "magic"}),
            2,
            ("method", "bad-value", "Write method"),
        ),
        (
            ("download", "--from", "http://127.0.0.1:8000"),
            "",
            2,
            ("not the service's", "link-address", "udpin:"),
        ),
        (("download", "--from", "tcp:127.0.0.1:1"), "", 1, ("tcp:127.0.0.1:1", "start the simulator")),
        (
            ("download", "--from", "udpin:127.0.0.1:0", "--timeout-s", "0.1"),
            "",
            1,
            ("no autopilot was heard on udpin:127.0.0.1:0", "does it send to this port"),
        ),
    ],
)
def test_likely_mistakes_are_told_with_thing_rule_and_fix(
    swathplan: Command, arguments: tuple[str, ...], stdin: str, code: int, words: tuple[str, ...]
) -> None:
    """Each names what is wrong, by which rule, and what to do."""
    ended = swathplan(*arguments, stdin=stdin)
    assert ended.code == code
    for word in words:
        assert word in ended.out + ended.err


def test_upload_names_what_is_wrong_with_the_address(swathplan: Command, plan_file: Path) -> None:
    """A good plan and an address that no try will open: 2, and the reason."""
    ended = swathplan("upload", str(plan_file), "--to", "udpin:127.0.0.1:99999")
    assert (ended.code, ended.out) == (2, "")
    assert "port 99999 is not in 0 to 65535" in ended.err


def test_ports_in_use_exit_1(swathplan: Command) -> None:
    """The address is good and the port another's: 1, with the port, as another try may do better."""
    with (
        socket.create_server(("127.0.0.1", 0)) as listener,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken,
    ):
        taken.bind(("127.0.0.1", 0))
        port, udp_port = str(listener.getsockname()[1]), str(taken.getsockname()[1])
        for arguments, number in (
            (("sim", "--url", f"tcpin:127.0.0.1:{port}"), port),
            (("download", "--from", f"udpin:127.0.0.1:{udp_port}"), udp_port),
        ):
            ended = swathplan(*arguments)
            assert ended.code == 1, arguments
            assert number in ended.err
            assert "in use" in ended.err


def test_what_fails_exits_1(swathplan: Command, scenario_file: Path, tmp_path: Path) -> None:
    """A result that cannot be written and a vehicle that is not there exit with 1."""
    assert swathplan("plan", str(scenario_file), "-o", str(tmp_path / "no" / "plan")).code == 1
    silent = swathplan("download", "--from", "udpin:127.0.0.1:0", "--timeout-s", "0.2")
    assert silent.code == 1
    assert "no autopilot" in silent.err


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
    assert "1 differences" in altered.err


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
    """The whole journey, told as JSON: planned, uploaded, read back, flown, seen."""
    ended = swathplan("demo", str(scenario_file), "--speedup", "500", "--json")
    told = json.loads(ended.out)
    assert ended.code == 0, ended.err
    assert told["read_back_equal"]
    assert told["cross_track_max_m"] < 10.0
    assert min(told["seen"].values()) > 0.99


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


def test_demo_says_why_it_flies_no_vtol(swathplan: Command, scenario_file: Path) -> None:
    """Exit code 2 and the reason."""
    scenario = json.loads(scenario_file.read_text())
    scenario["vehicles"][0]["type"] = "vtol"
    scenario_file.write_text(json.dumps(scenario))
    ended = swathplan("demo", str(scenario_file))
    assert ended.code == 2
    assert "no vtol is simulated" in ended.err


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--scenario", "-"), "crossing"),
        (("--sim", "--sim-url", "udpin:127.0.0.1:0"), "not the address of a simulated aircraft"),
        (("--sim", "--sim-url", "sim:?colour=red"), "has no option colour"),
        (("--vehicle", "pigeon:post"), "no link address"),
        (("--vehicle", "udpin:127.0.0.1:99999"), "not in 0 to 65535"),
        (("--sim", "--forward", "serial:/dev/ttyS0:57600"), "no address to forward to"),
        (("--sim", "--sim-count", "2", "--forward", "udpout:14550"), "needs one vehicle"),
        (("--forward-write", "udpout:14550"), "needs one vehicle"),
        (("--vehicle", "udpin:127.0.0.1:14550", "--forward", "udpout:14550"), "for ever"),
    ],
)
def test_serve_refuses_wishes_it_cannot_fulfil(
    swathplan: Command, tmp_path: Path, arguments: tuple[str, ...], told: str
) -> None:
    """A scenario or simulated aircraft that is wrong ends the start with 2 and its findings."""
    crossing = [[8.55, 47.37], [8.56, 47.38], [8.56, 47.37], [8.55, 47.38], [8.55, 47.37]]
    scenario = json.loads(json.dumps(EXAMPLE))
    scenario["features"][0] |= {"id": "crossing", "geometry": {"type": "Polygon", "coordinates": [crossing]}}
    database = tmp_path / "plans.db"
    ended = swathplan(
        "serve", "--port", "0", "--database", str(database), *arguments, stdin=json.dumps(scenario)
    )
    assert ended.code == 2, ended
    assert told in ended.err
    assert not database.exists()


@pytest.mark.parametrize(
    "arguments", [("frobnicate",), ("plan",), ("bench", "nope"), ("plan", "-", "--seed", "x")]
)
def test_wrong_usage_is_told_as_json_where_json_is_asked_for(
    swathplan: Command, arguments: tuple[str, ...]
) -> None:
    """With --json a usage error is one JSON object on standard error, and still exits with 2."""
    ended = swathplan(*arguments, "--json")
    assert (ended.code, ended.out) == (2, "")
    assert json.loads(ended.err)["error"]
    plain = swathplan(*arguments)
    assert plain.code == 2
    assert "Usage" in plain.err


def test_a_result_with_nowhere_to_go_is_said_before_planning(
    swathplan: Command, scenario_file: Path, tmp_path: Path
) -> None:
    """A folder that is not there, or is given for the file, ends the command before anything is planned."""
    for place, reason in ((tmp_path / "no" / "plan", "no folder"), (tmp_path, "it is a folder")):
        ended = swathplan("plan", str(scenario_file), "-o", str(place))
        assert ended.code == 1
        assert reason in ended.err
    assert "%" not in ended.err
