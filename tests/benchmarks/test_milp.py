"""The benchmark of programs and the pictures of turns hold what they claim."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from benchmarks import milp, milp_picture, smoothing
from planner.dubins.path import Path as Line
from planner.dubins.path import Segment
from planner.route import Pose


def test_threats_are_those_of_their_seed() -> None:
    """23 discs, the same for a seed, that do not touch and leave the destination among them free."""
    discs = milp.threats(1)
    assert discs.shape == (23, 3)
    assert np.array_equal(discs, milp.threats(1))
    assert not np.array_equal(discs, milp.threats(2))
    for k, (east_m, north_m, radius_m) in enumerate(discs):
        others = np.delete(discs, k, axis=0)
        assert (np.hypot(others[:, 0] - east_m, others[:, 1] - north_m) > others[:, 2] + radius_m).all()
        assert math.hypot(east_m, north_m) > radius_m + milp.CLEARING_M


def test_effort_of_a_half_turn() -> None:
    """By hand: a half turn changes one coordinate of the velocity by 2 V, the other by V there and back."""
    turn = Line((Segment("left", Pose(0.0, 0.0, 0.0), math.pi * 100.0, 100.0),))
    assert milp.effort_m_s(turn) == pytest.approx(4.0 * milp.SPEED_M_S, rel=1e-3)


def test_pictures_are_drawn(tmp_path: Path) -> None:
    """Both are SVG with a line for each that was given."""
    line = Line((Segment("straight", Pose(0.0, 0.0, 0.0), 100.0),))
    drawn = ElementTree.fromstring(milp_picture.picture(milp.threats(1), [("tangent", "t", line)], 3000.0))
    assert len(drawn.findall("{*}circle")) == 23
    assert len(drawn.findall("{*}polyline")) == 1
    file = tmp_path / "turns.svg"
    assert list(smoothing.run(picture=str(file))) == [{"bench": "smoothing", "picture": str(file)}]
    assert len(list(ElementTree.parse(file).iter("{http://www.w3.org/2000/svg}polyline"))) == 3 * 4 + 3


def test_turns_by_name_are_compared() -> None:
    """A row for each turn and name; what passes through the waypoint misses it by nothing."""
    rows = list(smoothing.run(degrees=(90,)))
    assert [row["smoothing"] for row in rows] == ["three-arc", "past-target", "short-turn"]
    assert [row["missed_r"] for row in rows] == [0.0, 0.0, 0.41]
    assert rows[0]["room_r"] == pytest.approx(1.749, abs=1e-3)
