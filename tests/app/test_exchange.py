"""The command line and files of other programs: ``convert`` and ``import``."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from mavlink.encode import encode
from mavlink.formats import read_plan, read_waypoints, write_plan, write_waypoints
from tests.app.test_cli import Command, swathplan
from tests.mavlink.formats.test_qgc_complex import LANDING, SURVEY, plan_of, simple
from tests.mavlink.plans import make_plan
from tests.mavlink.strategies import same

__all__ = ["swathplan"]

MISSION = encode(make_plan())


def test_a_mission_survives_both_conversions(swathplan: Command, tmp_path: Path) -> None:
    """.plan to .waypoints and back gives the same items; the loss of the fence is said."""
    plan, rows = tmp_path / "a.plan", tmp_path / "a.waypoints"
    plan.write_text(write_plan(MISSION))
    ended = swathplan("convert", str(plan), "-o", str(rows), "--json")
    assert ended.code == 0
    assert json.loads(ended.out)["items"] == len(MISSION.mission)
    assert "the fence has no place" in ended.err
    assert same(read_waypoints(rows.read_text()).mission, MISSION.mission)
    again = swathplan("convert", str(rows))
    assert same(read_plan(again.out).mission, MISSION.mission)


def test_complex_items_are_laid_out(swathplan: Command) -> None:
    """A survey and a landing pattern become rows, and what was made is told."""
    plan = json.dumps(plan_of(simple(22, 47.3977, 8.5456, 50, 1), SURVEY, LANDING))
    ended = swathplan("convert", "-", stdin=plan)
    assert len(ended.out.splitlines()) == 1 + 1 + 1 + 8 + 6
    assert "fwLandingPattern" in ended.err


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("QGC WPL 100\n", "line 1: the version is '100'"),
        ('{\n"fileType": 1,}', "line 2: no JSON"),
        (write_waypoints(MISSION).replace("33.49", "133.49"), "latitude"),
    ],
)
def test_bad_mission_files_exit_2(swathplan: Command, text: str, says: str) -> None:
    """Line, column and fault stand on standard error, nothing on standard output."""
    ended = swathplan("convert", "-", stdin=text)
    assert (ended.code, ended.out) == (2, "")
    assert says in ended.err
