"""The command line as a whole: help, usage, what serve refuses."""

from __future__ import annotations

import fcntl
import json
import socket
import subprocess
import sys
from pathlib import Path

import pytest

from app.cli.bench import ABOUT, Benchmark
from app.routers.bodies import EXAMPLE
from tests.app.cli.conftest import ROOT, Command
from tests.patience import PATIENCE_S


def test_help_lists_every_command() -> None:
    """A process of its own answers --help with all commands and exit code 0."""
    command = [sys.executable, "-m", "app.cli", "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S, check=True)
    commands = ("serve", "plan", "validate", "export", "upload", "download", "convert", "import", "sim")
    commands = (*commands, "bench", "demo", "audit", "flown")
    assert all(f" {name} " in ended.stdout for name in commands)


def test_help_says_what_every_benchmark_shows() -> None:
    """Each module of benchmarks that can be run by name stands there by itself, with a line on it."""
    command = [sys.executable, "-m", "app.cli", "bench", "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S, check=True)
    lines = [line.split() for line in ended.stdout.splitlines()]
    told = {words[0]: " ".join(words[1:]) for words in lines if words}
    files = [file for file in (ROOT / "benchmarks").glob("*.py") if "\ndef run(" in file.read_text()]
    names = {file.stem.replace("_", "-") for file in files}
    assert names == {benchmark.value for benchmark in Benchmark}
    assert {name: told[name] for name in names} == {each.value: ABOUT[each] for each in Benchmark}


@pytest.mark.parametrize("name", ["serve", "upload"])
def test_help_tells_what_is_taken_when_left_out(name: str) -> None:
    """The help's text reaches the screen whole: words in square brackets would be taken for markup."""
    command = [sys.executable, "-m", "app.cli", name, "--help"]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S, check=True)
    assert "when left out" in " ".join(ended.stdout.replace("│", " ").split())


def test_serve_on_what_is_taken_exits_1(tmp_path: Path) -> None:
    """A taken port and a database in use end the service with 1 and the reason in words."""

    def serve(port: int, database: Path) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "app.cli", "serve", "--port", str(port), "--database", str(database)]
        return subprocess.run(
            command, cwd=ROOT, capture_output=True, text=True, timeout=PATIENCE_S, check=False
        )

    with socket.create_server(("127.0.0.1", 0)) as taken:
        ended = serve(taken.getsockname()[1], tmp_path / "a.db")
    assert ended.returncode == 1
    assert "Choose another with --port" in ended.stderr
    with (tmp_path / "b.db.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        ended = serve(0, tmp_path / "b.db")
    assert ended.returncode == 1
    assert "error: the service cannot start: another service is at work on" in ended.stderr


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
