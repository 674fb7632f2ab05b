"""What a pixel covers: the paper's three forms against values worked by hand, and against rays."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.sensors.optics import Optics, gsd_across_m, gsd_along_m, gsd_ground_plane_m, gsd_mean_m

P1 = Optics(0.035, 4.39e-6, 8192, 5460)


def test_values_worked_by_hand() -> None:
    """Equations 2, 3 and 5 at round numbers, to 1e-9."""
    assert P1.gsd_m(100.0) == pytest.approx(0.012542857142857143, abs=1e-9)
    assert P1.height_for_m(0.012542857142857143) == pytest.approx(100.0, abs=1e-9)
    assert gsd_ground_plane_m(0.01, math.radians(30.0)) == pytest.approx(0.02, abs=1e-9)
    # sin(60° + 60° − 90°) is a half.
    assert gsd_across_m(0.01, math.radians(60.0), math.radians(60.0)) == pytest.approx(0.02, abs=1e-9)
    # The slant range at 30° down is twice the height; sin(90° + 30° − 90°) is a half.
    along_m = gsd_along_m(1e-4, 100.0, math.radians(90.0), math.radians(30.0))
    assert along_m == pytest.approx(0.04, abs=1e-9)


@given(
    focal_m=st.floats(0.003, 0.3),
    pitch_m=st.floats(1e-6, 2e-5),
    columns=st.integers(2, 12_000),
    height_m=st.floats(10.0, 5000.0),
)
def test_the_image_on_the_ground_is_the_angle_of_view(
    focal_m: float, pitch_m: float, columns: int, height_m: float
) -> None:
    """Straight down, all forms agree, and the footprint is what the half angles see."""
    optics = Optics(focal_m, pitch_m, columns, 2)
    right_rad = math.pi / 2.0
    gsd_m = optics.gsd_m(height_m)
    assert gsd_ground_plane_m(gsd_m, right_rad) == pytest.approx(gsd_m)
    assert gsd_mean_m(pitch_m / focal_m, height_m, right_rad, right_rad) == pytest.approx(gsd_m)
    across_m, _ = optics.footprint_m(height_m)
    assert across_m == pytest.approx(2.0 * height_m * math.tan(optics.half_width_rad))


@pytest.mark.parametrize("look_deg", [0.0, -5.0])
def test_no_ground_is_seen_at_the_horizon(look_deg: float) -> None:
    """Angles that meet no ground are refused, not answered with a number."""
    with pytest.raises(ValueError, match="no ground"):
        gsd_ground_plane_m(0.01, math.radians(look_deg))


@pytest.mark.parametrize("wrong", [(0.0, 1e-6, 10, 10), (0.01, math.nan, 10, 10), (0.01, 1e-6, 0, 10)])
def test_a_lens_has_a_length(wrong: tuple[float, float, int, int]) -> None:
    """Nothing, not-a-number and no pixels are refused."""
    with pytest.raises(ValueError, match=r"positive|pixel"):
        Optics(*wrong)
