"""What of a line lies between heights, against a line cut finely."""

from __future__ import annotations

import math

import numpy as np
import pytest

from planner.check.heights import between

LINE = np.array([(0.0, 0.0), (100.0, 0.0), (200.0, 0.0), (300.0, 0.0)])
HEIGHTS = np.array([0.0, 60.0, 60.0, 20.0])


@pytest.mark.parametrize(
    "band", [(-math.inf, math.inf), (-10.0, 60.0), (30.0, 50.0), (60.0, 90.0), (61.0, 90.0), (-9.0, -1.0)]
)
def test_the_part_between_two_heights(band: tuple[float, float]) -> None:
    """As long as the places, a centimetre apart, whose height lies between them."""
    along = np.linspace(0.0, 300.0, 30001)
    inside = np.interp(along, LINE[:, 0], HEIGHTS)
    expected = ((inside >= band[0]) & (inside <= band[1])).mean() * 300.0
    found = between(LINE, HEIGHTS, *band)
    assert found.length == pytest.approx(expected, abs=0.03)
    assert found.is_empty == (expected == 0.0)
