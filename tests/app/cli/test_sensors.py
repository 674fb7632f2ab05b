"""``swathplan sensors`` lists cameras, and tells heights for a ground sampled distance."""

from __future__ import annotations

import json
import math
from xml.etree import ElementTree

import pytest
from typer.testing import CliRunner

from app.cli.output import CommandError, Exit
from app.cli.quality_picture import CELLS
from app.cli.root import cli
from planner.sensors.cameras import CAMERAS
from planner.sensors.quality import Giqe4
from planner.sensors.radars import RADARS


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


def test_radars_are_told_with_their_sources() -> None:
    """Below the cameras."""
    listed = told()
    assert all(radar.name in listed and radar.source in listed for radar in RADARS.values())


def test_a_picture_shows_quality_over_the_footprint() -> None:
    """Tilted, the far edge is worst: the legend has the values of both edges by equations 1, 4 and 5."""
    drawn = told("Sony a6000 20 mm", "--tilt", "30", "--height", "120", "--picture")
    root = ElementTree.fromstring(drawn)
    polygons = root.findall("{http://www.w3.org/2000/svg}polygon")
    assert len(polygons) == 2 * CELLS * CELLS
    texts = " ".join(each.text or "" for each in root.iter("{http://www.w3.org/2000/svg}text"))
    optics = CAMERAS["Sony a6000 20 mm"].optics
    for row in (0, CELLS - 1):
        up = math.tan(optics.half_height_rad) * (2.0 * (row + 0.5) / CELLS - 1.0)
        off = math.radians(30.0) + math.atan(up)
        across_m = optics.gsd_m(120.0) * math.cos(math.atan(up)) / math.cos(off)
        along_m = across_m * math.cos(math.atan(up)) / math.cos(off)
        assert f"{50.0 * (across_m + along_m):.2f} cm" in texts
        assert f"{Giqe4('visible', 0.9, 50.0).niirs((across_m + along_m) / 2.0):.2f}" in texts


@pytest.mark.parametrize("arguments", [["--picture"], ["Sony a6000 16 mm", "--tilt", "70", "--picture"]])
def test_a_picture_that_cannot_be_drawn_is_refused(arguments: list[str]) -> None:
    """Of no camera, or over the horizon."""
    result = CliRunner().invoke(cli, ["sensors", *arguments])
    assert isinstance(result.exception, CommandError)
    assert result.exception.code is Exit.BAD_INPUT
