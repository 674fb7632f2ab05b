"""Swath geometry against Table 1 of Li, Chen, Wang, Li (2018)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.sensors.sar import SarSensor

PAPER = SarSensor("sar", math.radians(45.0), math.radians(30.0), math.radians(10.0))


def test_table_1() -> None:
    """Aperture and swath are the printed ones; the near-end distance is the formula's, 288.68 m."""
    assert PAPER.aperture_m(500.0) == pytest.approx(123.41, abs=0.005)
    assert PAPER.swath_m(500.0) == pytest.approx(577.35, abs=0.005)
    assert PAPER.near_m(500.0) == pytest.approx(288.68, abs=0.005)


def test_collection_length_is_span_and_one_aperture() -> None:
    """Eq 6: half an aperture before the region and half after it."""
    assert PAPER.collection_m(500.0, 1000.0) == pytest.approx(1123.41, abs=0.005)


@given(st.floats(10.0, 3000.0), st.floats(10.0, 70.0), st.floats(1.0, 18.0))
def test_swath_seen_from_the_aircraft(height_m: float, incidence_deg: float, beam_deg: float) -> None:
    """Seen from the aircraft, the swath's edges lie half a beam to each side of the beam's centre."""
    sensor = SarSensor("s", math.radians(incidence_deg), math.radians(beam_deg), 0.1)
    near_rad = math.atan2(sensor.near_m(height_m), height_m)
    far_rad = math.atan2(sensor.far_m(height_m), height_m)
    assert math.degrees(far_rad - near_rad) == pytest.approx(beam_deg)
    assert math.degrees(far_rad + near_rad) / 2.0 == pytest.approx(incidence_deg)
    assert sensor.near_m(height_m) + sensor.swath_m(height_m) == pytest.approx(sensor.far_m(height_m))


@given(st.floats(10.0, 3000.0), st.floats(1.1, 5.0))
def test_everything_scales_with_height(height_m: float, times: float) -> None:
    """Over flat ground twice the height is twice every length."""
    for length in (PAPER.near_m, PAPER.far_m, PAPER.swath_m, PAPER.aperture_m):
        assert length(height_m * times) == pytest.approx(length(height_m) * times)
