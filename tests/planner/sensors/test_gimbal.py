"""Angles of a mount and lines of sight, against scipy's rotations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from planner.sensors.gimbal import Order, angles, line_of_sight

tilts = st.floats(-math.pi / 2.0 + 0.01, math.pi / 2.0 - 0.01)
turns = st.floats(-math.pi / 2.0 + 0.01, math.pi / 2.0 - 0.01)
orders: st.SearchStrategy[Order] = st.sampled_from(["radar", "camera"])


@given(alpha_rad=tilts, theta_rad=turns, order=orders)
def test_the_line_of_sight_is_scipys(alpha_rad: float, theta_rad: float, order: Order) -> None:
    """A radar's outer axis is x, a camera's z; both begin at y."""
    axes, by = ("XZ", (alpha_rad, theta_rad)) if order == "radar" else ("ZX", (theta_rad, alpha_rad))
    expected = Rotation.from_euler(axes, by).apply([0.0, 1.0, 0.0])
    np.testing.assert_allclose(line_of_sight(alpha_rad, theta_rad, order), expected, atol=1e-12)


@given(alpha_rad=tilts, theta_rad=turns, order=orders, length=st.floats(0.1, 1e4))
def test_the_angles_come_back(alpha_rad: float, theta_rad: float, order: Order, length: float) -> None:
    """From any vector along the line of sight, to 1e-9."""
    sight = length * line_of_sight(alpha_rad, theta_rad, order)
    assert angles(sight, order) == pytest.approx((alpha_rad, theta_rad), abs=1e-9)


@pytest.mark.parametrize("order", ["radar", "camera"])
def test_straight_down_has_angles_and_nowhere_has_none(order: Order) -> None:
    """Straight down is −90° of tilt; a vector of no length is refused."""
    assert angles((0.0, 0.0, -2.0), order) == pytest.approx((-math.pi / 2.0, 0.0), abs=1e-12)
    with pytest.raises(ValueError, match="direction"):
        angles((0.0, 0.0, 0.0), order)
