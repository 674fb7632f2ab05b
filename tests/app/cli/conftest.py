"""The command line in the process of the test, and files to give it."""

from __future__ import annotations

import io
import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from app.cli.root import run
from app.routers.bodies import EXAMPLE

ROOT = Path(__file__).resolve().parents[3]


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
