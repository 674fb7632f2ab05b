"""``swathplan sensors`` lists cameras, and tells heights for a ground sampled distance."""

from __future__ import annotations

import json

import pytest
from typer.testing import CliRunner

from app.cli.output import CommandError, Exit
from app.cli.root import cli
from planner.sensors.cameras import CAMERAS


def told(*arguments: str) -> str:
    result = CliRunner().invoke(cli, ["sensors", *arguments], catch_exceptions=False)
    assert result.exit_code == 0
    return result.stdout


def test_it_lists_every_camera() -> None:
    """In words and as JSON, with what a pixel covers from the height asked."""
    assert all(name in told() for name in CAMERAS)
    rows = json.loads(told("--height", "250", "--json"))
    assert [row["name"] for row in rows] == list(CAMERAS)
    for row in rows:
        assert row["gsd_m"] == pytest.approx(row["pixel_pitch_m"] / row["focal_length_m"] * 250.0)


def test_it_tells_the_height_for_a_pixel() -> None:
    """One camera by name: from that height its pixel covers just that."""
    row = json.loads(told("ricoh gr iii", "--gsd", "0.02", "--json"))
    assert row["gsd_m"] == pytest.approx(0.02)
    assert row["height_m"] == pytest.approx(0.02 * row["focal_length_m"] / row["pixel_pitch_m"])


def test_a_name_nobody_has_is_bad_input() -> None:
    """Exit 2, with what comes near."""
    result = CliRunner().invoke(cli, ["sensors", "Ricoh GR 3"])
    assert isinstance(result.exception, CommandError)
    assert result.exception.code is Exit.BAD_INPUT
    assert "Ricoh GR III" in str(result.exception)
