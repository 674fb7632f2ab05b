"""The table of cameras holds together, and names are found."""

from __future__ import annotations

import math

import pytest

from planner.sensors.cameras import CAMERAS, find_camera


def test_figures_are_possible() -> None:
    """Pixels of 1 to 20 µm, angles of view of 4° to 100°, each with a source."""
    assert len(CAMERAS) >= 40
    for camera in CAMERAS.values():
        assert 1e-6 < camera.optics.pixel_pitch_m < 2e-5, camera.name
        assert 4.0 < math.degrees(2.0 * camera.optics.half_width_rad) < 100.0, camera.name
        assert camera.source
        assert 0.0 <= camera.min_interval_s < 5.0
    assert {camera.kind for camera in CAMERAS.values()} == {
        *("mapping", "mirrorless", "multispectral", "thermal", "integrated", "compact")
    }


@pytest.mark.parametrize(
    ("name", "gsd_cm", "height_m"),
    [
        # As the makers state for their cameras.
        ("DJI Phantom 4 RTK", 2.74, 100.0),
        ("MicaSense RedEdge-MX", 8.0, 120.0),
        ("MicaSense Altum", 5.2, 120.0),
        ("DJI Zenmuse P1 35 mm", 1.26, 100.0),
        ("senseFly S.O.D.A.", 2.3, 105.0),
    ],
)
def test_a_pixel_covers_what_the_maker_says(name: str, gsd_cm: float, height_m: float) -> None:
    """Ground sampled distances that makers publish come out within 5 %."""
    assert 100.0 * CAMERAS[name].optics.gsd_m(height_m) == pytest.approx(gsd_cm, rel=0.05)


def test_names_are_found_whatever_their_case() -> None:
    """A near miss is answered with what comes near."""
    assert find_camera("sony A7R iv 35 MM") is CAMERAS["Sony a7R IV 35 mm"]
    with pytest.raises(KeyError, match="Sony a7R IV 35 mm"):
        find_camera("Sony a7R IV 36 mm")
