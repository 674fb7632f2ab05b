"""Cameras as scenarios write them: every property, and what is refused by name."""

from __future__ import annotations

import math
from typing import Any

import pytest

from planner.errors import ScenarioError
from planner.geojson import read_scenario
from planner.sensors.camera import CameraSensor
from planner.sensors.cameras import CAMERAS
from planner.sensors.quality import Giqe4
from tests.planner.scenarios import small

MODEL = {"name": "eye", "type": "camera", "model": "sony A6000 20 mm"}
FIGURES = {
    "name": "eye", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 4e-6, "image_px": [6000, 4000],
}  # fmt: skip


def scenario(sensor: dict[str, Any], **vehicle: Any) -> dict[str, Any]:
    """The small scenario seen by a camera, from 300 m."""
    document = small(altitude_m=300.0, sensors=[sensor])
    document["vehicles"][0] |= vehicle
    return document


def read(sensor: dict[str, Any], **vehicle: Any) -> CameraSensor:
    """That camera."""
    (found,) = read_scenario(scenario(sensor, **vehicle)).sensors
    assert isinstance(found, CameraSensor)
    return found


def refused(sensor: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """What is found wrong with it."""
    with pytest.raises(ScenarioError) as error:
        read_scenario(scenario(sensor))
    return [(f.feature, f.rule, f.message, f.fix) for f in error.value.findings if f.severity == "error"]


def test_a_model_brings_lens_chip_interval_and_spectrum() -> None:
    """From the database, case aside; overlaps and the rest by their defaults."""
    camera, known = read(MODEL), CAMERAS["Sony a6000 20 mm"]
    assert (camera.optics, camera.min_interval_s, camera.model) == (
        known.optics,
        known.min_interval_s,
        known.name,
    )
    assert (camera.forward_overlap, camera.side_overlap, camera.tilt_rad) == (0.75, 0.65, 0.0)
    assert (camera.trigger, camera.spectrum, camera.quality) == ("distance", "visible", None)
    assert read({**MODEL, "model": "DJI Mavic 3 Thermal"}).spectrum == "infrared"
    assert read({**MODEL, "min_interval_s": 2.5}).min_interval_s == 2.5


def test_figures_and_terms_of_quality_are_read() -> None:
    """All by themselves."""
    terms = {"rer": 0.92, "snr": 40.0, "noise_gain": 5.4, "overshoot": 0.1}
    camera = read({**FIGURES, **terms, "spectrum": "infrared", "tilt_deg": 20.0, "trigger": "time"})
    assert camera.quality == Giqe4("infrared", 0.92, 40.0, 5.4, 0.1)
    assert (camera.optics.columns, camera.optics.rows) == (6000, 4000)
    assert camera.tilt_rad == pytest.approx(math.radians(20.0))
    assert camera.trigger == "time"


def test_margins_come_with_the_autopilot_and_count_for_overlap_where_they_are_asked_for() -> None:
    """Overlap is that of the planned line unless margins are written down."""
    usual = read(MODEL, autopilot="px4")
    assert min(usual.position_margin_m, usual.pointing_margin_rad) > 0.0
    assert not usual.steady_overlap
    assert read({**MODEL, "position_margin_m": 3.0}, autopilot="px4").steady_overlap
    assert read(MODEL).position_margin_m == 0.0


@pytest.mark.parametrize(
    ("change", "rule", "said"),
    [
        ({"focal_length_m": None}, "missing-property", "focal_length_m"),
        ({"focal_length_m": 0.0}, "out-of-range", "focal_length_m"),
        ({"focal_length_m": 20.0}, "out-of-range", "focal_length_m"),
        ({"pixel_pitch_m": None}, "missing-property", "pixel_pitch_m"),
        ({"image_px": None}, "missing-property", "image_px"),
        ({"image_px": [6000]}, "bad-value", "image_px"),
        ({"image_px": [6000, 0]}, "bad-value", "image_px"),
        ({"image_px": [6000, 1e400]}, "bad-value", "image_px"),
        ({"image_px": [6000, 10**400]}, "bad-value", "image_px"),
        ({"image_px": [6000, True]}, "bad-value", "image_px"),
        ({"image_px": "6000x4000"}, "bad-value", "image_px"),
        ({"forward_overlap": 1.0}, "out-of-range", "forward_overlap"),
        ({"side_overlap": 1.0}, "out-of-range", "side_overlap"),
        ({"side_overlap": 75}, "out-of-range", "side_overlap"),
        ({"forward_overlap": -0.1}, "out-of-range", "forward_overlap"),
        ({"tilt_deg": 70.0}, "horizon", "tilt_deg"),
        ({"tilt_deg": -70.0}, "horizon", "tilt_deg"),
        ({"rer": 0.9}, "missing-property", "snr"),
        ({"snr": 30.0}, "missing-property", "rer"),
        ({"rer": 0.0, "snr": 30.0}, "out-of-range", "rer"),
        ({"min_interval_s": -1.0}, "out-of-range", "min_interval_s"),
        ({"trigger": "never"}, "unknown-value", "trigger"),
        ({"spectrum": "radio"}, "unknown-value", "spectrum"),
        ({"incidence_deg": 45.0}, "unknown-property", "incidence_deg"),
    ],
)
def test_what_is_wrong_is_refused_by_name(change: dict[str, Any], rule: str, said: str) -> None:
    """Sensor, rule, and the property in the words."""
    found = refused({k: v for k, v in {**FIGURES, **change}.items() if v is not None})
    assert [(feature, of) for feature, of, _, _ in found] == [("sensor eye", rule)]
    assert said in found[0][2] + found[0][3]


def test_a_model_unknown_or_with_figures_beside_it_is_refused() -> None:
    """With the names that come near, and which of the two to leave out."""
    assert "Sony a6000" in refused({**MODEL, "model": "Sony a600 20mm"})[0][2]
    assert refused({**MODEL, "focal_length_m": 0.03})[0][1] == "bad-value"


def test_terms_without_those_they_go_with_are_told() -> None:
    """A noise gain without edge response and noise is not used; nor is the interval of a video."""
    for more in ({"noise_gain": 5.0}, {"overshoot": 0.1}, {"trigger": "video", "min_interval_s": 1.0}):
        warnings = read_scenario(scenario({**FIGURES, **more})).warnings
        assert [w.rule for w in warnings if w.feature == "sensor eye"] == ["not-used"]


def test_the_largest_tilt_named_is_taken() -> None:
    """What the refusal says would work does."""
    (_, _, _, fix), *_ = refused({**FIGURES, "tilt_deg": 85.0})
    most_deg = float(fix.split()[1])
    assert math.degrees(read({**FIGURES, "tilt_deg": most_deg}).tilt_rad) == pytest.approx(most_deg)


def test_the_papers_methods_know_radars_alone() -> None:
    """A camera with them is refused by its region."""
    document = scenario(MODEL) | {"method": {"routing": "li2018"}}
    with pytest.raises(ScenarioError) as error:
        read_scenario(document)
    assert {(f.feature, f.rule) for f in error.value.findings} == {
        ("A", "not-supported"),
        ("B", "not-supported"),
    }
