"""Settings: the page that lists them, what the environment may say, what is refused."""

from __future__ import annotations

from pathlib import Path

import pytest

from app.settings import Settings, unknown_variables
from app.settings_table import table

PAGE = Path(__file__).resolve().parents[2] / "docs" / "settings.md"


def test_the_page_lists_the_settings_as_they_are() -> None:
    """docs/settings.md holds the table made from the settings; every one says what it means."""
    assert table() in PAGE.read_text(), "write it anew: python -m app.settings_table"
    assert all(field.description for field in Settings.model_fields.values())


def test_host_names_come_with_commas(monkeypatch: pytest.MonkeyPatch) -> None:
    """Several host names are one variable."""
    monkeypatch.setenv("SWATHPLAN_ALLOWED_HOSTS", "planner.example, 10.0.0.7,")
    assert Settings().allowed_hosts == ("planner.example", "10.0.0.7")


def test_origins_are_origins(monkeypatch: pytest.MonkeyPatch) -> None:
    """Several come with commas; what no browser sends as an origin, or every sandboxed page, is refused."""
    monkeypatch.setenv("SWATHPLAN_ALLOWED_ORIGINS", "https://Ops.example:8443, http://[::1]:9000")
    assert Settings().allowed_origins == ("https://ops.example:8443", "http://[::1]:9000")
    for wrong in ("ops.example", "https://ops.example/", "*", "null", "https://ops.example/map"):
        with pytest.raises(ValueError, match="is no origin"):
            Settings(allowed_origins=(wrong,))


def test_slips_in_variable_names_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """A variable that is no setting is named; settings and the tests' own are not."""
    for name in ("SWATHPLAN_PROT", "SWATHPLAN_PORT", "SWATHPLAN_TEST_SPEEDUP", "OTHER"):
        monkeypatch.setenv(name, "9000")
    assert "SWATHPLAN_PROT" in unknown_variables()
    assert not {"SWATHPLAN_PORT", "SWATHPLAN_TEST_SPEEDUP", "OTHER"} & set(unknown_variables())
