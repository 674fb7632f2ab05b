"""Image quality equations against values worked by hand with forty digits."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner.sensors.quality import Giqe4, noise_gain, signal_to_noise
from planner.sensors.sar_quality import (
    aperture_length_m,
    mosaic_length_m,
    mosaic_overlaps,
    niirs_by_range,
    niirs_by_resolution,
)

#: Of equation 1 at 5 cm, and of equation 10 at 30 cm.
SHARP, SOFT, RADAR = 9.21013274761433, 8.48505809219598, 6.32751552041189
SHARPENING = [[0, -1, 0], [-1, 5, -1], [0, -1, 0]]


def test_giqe_by_hand() -> None:
    """Both branches of the edge response, visible and infrared, sharpened and not."""
    assert Giqe4("visible", 0.92, 50.0).niirs(0.05) == pytest.approx(SHARP, abs=1e-9)
    gain = noise_gain(SHARPENING)
    assert gain == pytest.approx(math.sqrt(29.0), abs=1e-12)
    assert Giqe4("infrared", 0.7, 40.0, gain, 1.3).niirs(0.05) == pytest.approx(SOFT, abs=1e-9)
    assert signal_to_noise(120.0, 4.0) == 30.0


@given(
    spectrum=st.sampled_from(["visible", "infrared"]),
    rer=st.floats(0.2, 1.2),
    snr=st.floats(2.0, 200.0),
    niirs=st.floats(0.0, 9.0),
)
def test_the_largest_gsd_keeps_just_that_niirs(spectrum: str, rer: float, snr: float, niirs: float) -> None:
    """Algorithm 1 is the inverse of equation 1, and a finer pixel is never worse."""
    camera = Giqe4("visible" if spectrum == "visible" else "infrared", rer, snr)
    gsd_m = camera.largest_gsd_m(niirs)
    assert camera.niirs(gsd_m) == pytest.approx(niirs, abs=1e-9)
    assert camera.niirs(gsd_m / 2.0) > niirs


def test_radar_by_hand() -> None:
    """Equations 9, 10, 17 and 18 at round numbers."""
    assert niirs_by_range(5.0, 0.5) == pytest.approx(2.764, abs=1e-9)
    assert niirs_by_resolution(0.3, 20.0, 15.0) == pytest.approx(RADAR, abs=1e-9)
    assert niirs_by_resolution(0.3, 20.0, 15.0) > niirs_by_resolution(1.0, 20.0, 15.0)
    assert aperture_length_m(5000.0, 0.03, 0.3, 1.2) == pytest.approx(300.0, abs=1e-9)
    assert mosaic_length_m(300.0, 4) == 1200.0
    assert mosaic_overlaps(301.0, 300.0)
    assert not mosaic_overlaps(299.0, 300.0)


def test_coefficients_come_from_a_table_that_grows() -> None:
    """Between rows they are interpolated; beyond them nothing is made up."""
    table = {15.0: (5.0, 2.0, 0.3), 25.0: (6.0, 2.4, 0.5)}
    by_hand = 5.5 - 2.2 * math.log10(0.3) + 0.4 * math.log10(math.log10(21.0))
    assert niirs_by_resolution(0.3, 20.0, 20.0, table) == pytest.approx(by_hand, abs=1e-9)
    with pytest.raises(ValueError, match="15° to 25°"):
        niirs_by_resolution(0.3, 20.0, 40.0, table)
