"""``swathplan fill`` from a service that is there and refuses, and from one that is not."""

from __future__ import annotations

from pathlib import Path

from typer.testing import CliRunner

from app.cli.output import CommandError
from app.cli.root import cli
from app.settings import Settings
from tests.app.cli.test_audit import serving
from tests.app.test_restart import free_port


def refusal(address: str, log: Path) -> CommandError:
    """What the command says of a flight that nobody knows."""
    arguments = ["fill", "00000000-0000-0000-0000-000000000000", str(log), "--service", address]
    ended = CliRunner().invoke(cli, arguments)
    assert isinstance(ended.exception, CommandError)
    return ended.exception


def test_what_the_service_refuses_is_told(settings: Settings, tmp_path: Path) -> None:
    """An unknown flight is named in the service's own words; where nobody answers that is said."""
    log = tmp_path / "flight.tlog"
    log.write_bytes(b"\0" * 64)
    with serving(settings) as address:
        assert "flight" in str(refusal(address, log))
        assert "no service answers" not in str(refusal(address, log))
    nobody = f"http://127.0.0.1:{free_port()}"
    assert f"no service answers at {nobody}" in str(refusal(nobody, log))
