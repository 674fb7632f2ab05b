"""The audit on the command line, from a service that is really there, and from one that is not."""

from __future__ import annotations

import json
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest
import uvicorn
from typer.testing import CliRunner

from app.cli.output import CommandError, Exit
from app.cli.root import cli
from app.main import create_app
from app.settings import Settings
from tests.app.conftest import fake_house
from tests.app.test_restart import free_port

ROW = (
    "INSERT INTO audit (at, actor, kind, vehicle_id, vehicle_name, what, outcome, reason) VALUES "
    "('2026-05-04T08:00:00.000000+00:00', 'local', 'order', 'v', ?, ?, 'refused', 'not armed')"
)


@contextmanager
def serving(settings: Settings) -> Iterator[str]:
    """The address of a service in a thread of the test."""
    app = create_app(settings, fake_house)
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_config=None, access_log=False))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive()
            time.sleep(0.01)
        yield f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()


def test_orders_are_listed(settings: Settings, tmp_path: Path) -> None:
    """One line each, or JSON; by vehicle and kind; wrong filters are bad input."""
    with serving(settings) as address:
        with closing(sqlite3.connect(tmp_path / "plans.db")) as database, database:
            for name in ("uav-1", "uav-2"):
                database.execute(ROW, (name, json.dumps({"command": "start", "arm_first": True})))

        def audit(*arguments: str) -> tuple[int, str]:
            ended = CliRunner().invoke(cli, ["audit", "--service", address, *arguments])
            return ended.exit_code, ended.stdout

        code, told = audit("--vehicle", "uav-2")
        assert (code, told) == (
            0,
            "2026-05-04T08:00:00Z local uav-2 order command=start arm_first=true: refused (not armed)\n",
        )
        code, told = audit("--json", "--until", "2026-06-01")
        assert [entry["vehicle_name"] for entry in json.loads(told)["entries"]] == ["uav-2", "uav-1"]
        assert audit("--kind", "clear") == (0, "nothing was ordered\n")
        with pytest.raises(CommandError, match="valid datetime") as refused:
            cli(["audit", "--service", address, "--since", "soon"], standalone_mode=False)
        assert refused.value.code == Exit.BAD_INPUT


@pytest.mark.parametrize("address", ["http://127.0.0.1:{port}", "nonsense", "http://[bad"])
def test_no_service_is_told(address: str) -> None:
    """Where nobody answers the command fails and names the way out."""
    ended = CliRunner().invoke(cli, ["audit", "--service", address.replace("{port}", str(free_port()))])
    assert ended.exit_code != 0
    assert "--service" in str(ended.exception)
