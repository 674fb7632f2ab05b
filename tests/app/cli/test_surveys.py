"""What ``plan`` says of camera surveys."""

from __future__ import annotations

import re
from typing import Any

import pytest

from app.cli.surveys import tell_surveys
from planner.geojson import read_scenario, write_plan
from planner.pipeline import make_plan
from tests.planner.coverage.survey.test_asked import field


def test_a_survey_is_told_in_a_line(capsys: pytest.CaptureFixture[str]) -> None:
    """Passes and photos as there are in the plan, its height, pixels of 2 cm, and the overlaps asked for."""
    asked = field(None, type="multirotor", autopilot="px4", airspeed_m_s=8.0)
    document: dict[str, Any] = write_plan(make_plan(read_scenario(asked)))
    tell_surveys(document)
    said = capsys.readouterr().err
    roles = [feature["properties"]["role"] for feature in document["features"]]
    taken = sum(
        len(feature["geometry"]["coordinates"])
        for feature in document["features"]
        if feature["properties"]["role"] == "photos"
    )
    assert said.startswith(f"a: {roles.count('collect')} passes, {taken} photos from 100 m over home, 2 cm")
    forward, side = (int(each) for each in re.findall(r"(\d+)%", said))
    assert forward >= 75
    assert side >= 65


def test_a_video_is_told_as_one(capsys: pytest.CaptureFixture[str]) -> None:
    """It has no photos, and none that overlap forward."""
    asked = field(None, {"trigger": "video"}, type="multirotor", autopilot="px4", airspeed_m_s=8.0)
    tell_surveys(write_plan(make_plan(read_scenario(asked))))
    said = capsys.readouterr().err
    assert "passes, a video from 100 m" in said
    assert "forward" not in said
    assert "photos" not in said
