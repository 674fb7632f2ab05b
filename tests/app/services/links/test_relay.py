"""The log of one process, repeated by another."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.services.links.relay import LogRelay


def test_what_is_added_is_repeated_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """From where it begins, also in a log that is begun anew meanwhile; what stood there before is not."""
    path = tmp_path / "links.log"
    relay = LogRelay(path)
    relay.skip()
    relay.copy()
    path.write_text("long before\n")
    relay.skip()
    path.write_text("long before\none\ntwo\n")
    relay.copy()
    relay.copy()
    assert capsys.readouterr().err == "one\ntwo\n"
    assert relay.last_words() == "one\ntwo"
    path.write_text("anew\n")
    relay.copy()
    assert capsys.readouterr().err == "anew\n"
