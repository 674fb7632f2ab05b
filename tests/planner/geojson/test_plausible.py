"""What can be planned and is hardly meant is told."""

from __future__ import annotations

from typing import Any

import pytest
from pyproj import Geod

from planner.geojson import read_scenario
from tests.planner.scenarios import case, feature, small, square

GEOD = Geod(ellps="WGS84")


def told(document: dict[str, Any], rule: str) -> list[str]:
    """Messages of a rule, none of which refuses."""
    found = [finding for finding in read_scenario(document).warnings if finding.rule == rule]
    assert all(finding.severity == "warning" for finding in found)
    return [f"{finding.feature}: {finding.message}" for finding in found]


RULES = ("wind-near-airspeed", "start-far", "flight-long", "axes-maybe-swapped")


def open_(*more: dict[str, Any], **members: Any) -> dict[str, Any]:
    """The small scenario without its area."""
    document = small(*more, **members)
    document["features"] = [each for each in document["features"] if each["id"] != "area"]
    return document


def test_what_is_meant_is_not_told() -> None:
    """The small scenario, and the paper's cases."""
    for document in (small(), *(case(number) for number in (1, 2, 3, 4))):
        assert {finding.rule for finding in read_scenario(document).warnings}.isdisjoint(RULES)


@pytest.mark.parametrize(("speed_m_s", "is_told"), [(8.0, False), (11.9, False), (12.0, True), (19.5, True)])
def test_a_wind_near_the_airspeed_is_told(speed_m_s: float, is_told: bool) -> None:
    """From three fifths of it on, with what is left against it."""
    found = told(small(wind={"speed_m_s": speed_m_s, "from_deg": 250.0}), "wind-near-airspeed")
    assert bool(found) == is_told
    assert not found or f"{20.0 - speed_m_s:g} m/s are left" in found[0]


@pytest.mark.parametrize(("lon", "is_told"), [(-0.3, False), (-0.34, True), (-1.0, True)])
def test_a_start_half_an_hour_from_the_regions_is_told(lon: float, is_told: bool) -> None:
    """By the geodesic to the nearest region, at 20 m/s."""
    document = open_()
    document["features"][-1]["geometry"]["coordinates"] = [lon, 0.0015]
    away_m = GEOD.inv(lon, 0.0015, 0.0, 0.0015)[2]
    assert (away_m / 20.0 > 1800.0) == is_told
    found = told(document, "start-far")
    assert bool(found) == is_told
    assert not found or f"{away_m / 1000.0:.0f} km" in found[0]


def test_hours_of_flight_are_told() -> None:
    """A region of 55 km a side, 577 m at a time: 3,000 km² take 5,200 km."""
    wide = feature("A", "roi", "Polygon", square(0.0, 0.0, 0.5))
    document = open_()
    document["features"][0] = wide
    (found,) = told(document | {"altitude_m": 600.0}, "flight-long")
    hours = float(found.split(" h of flight")[0].split()[-1])
    swath_m = 600.0 * (3.0**0.5 - 1.0 / 3.0**0.5)
    assert hours == pytest.approx(55_000.0**2 / swath_m / 20.0 / 3600.0, rel=0.05)


def test_lanes_of_photos_are_counted_by_their_overlap() -> None:
    """A camera's lanes lie as far apart as its side overlap leaves of the strip: so many more hours."""
    wide = feature("A", "roi", "Polygon", square(0.0, 0.0, 0.05))
    camera = {"name": "eye", "type": "camera", "model": "Sony RX1R II", "side_overlap": 0.6}
    document = open_() | {"altitude_m": 120.0, "sensors": [camera]}
    document["features"][0] = wide
    (found,) = told(document, "flight-long")
    hours = float(found.split(" h of flight")[0].split()[-1])
    lane_m = 0.4 * 120.0 * 35.9 / 35.0
    assert hours == pytest.approx(5_560.0**2 / lane_m / 20.0 / 3600.0, rel=0.15)


def test_photos_from_a_height_nobody_means_are_told() -> None:
    """A pixel of 2.5 where 2.5 cm are meant: the height it asks for, and the unit."""
    camera = {"name": "eye", "type": "camera", "model": "Sony RX1R II"}
    for gsd_m, is_told in ((2.5, True), (0.025, False)):
        document = open_() | {"sensors": [camera], "max_height_m": 20_000.0}
        del document["altitude_m"]
        for each in document["features"][:2]:
            each["properties"]["gsd_m"] = gsd_m
        assert bool(told(document, "height-unlikely")) == is_told


def test_a_place_with_its_axes_exchanged_is_told() -> None:
    """Where latitude and longitude are so alike that nothing is out of range or too far."""
    document = open_()
    for each in document["features"]:
        moved = (
            [[[9.0 + x, 8.0 + y] for x, y in ring] for ring in each["geometry"]["coordinates"][:1]]
            if (each["geometry"]["type"] == "Polygon")
            else [9.0 + each["geometry"]["coordinates"][0], 8.0 + each["geometry"]["coordinates"][1]]
        )
        each["geometry"]["coordinates"] = moved
    assert told(document, "axes-maybe-swapped") == []
    start = document["features"][-1]["geometry"]
    start["coordinates"] = start["coordinates"][::-1]
    (found,) = told(document, "axes-maybe-swapped")
    assert found.startswith("start: lies ")


def test_a_camera_bolted_to_rotors_is_told() -> None:
    """Nobody has said how far it leans: not of one in a gimbal, with its margin stated, or under wings."""
    figures = {"focal_length_m": 0.035, "pixel_pitch_m": 4.5e-6, "image_px": [6000, 4000]}
    rotors = {"name": "r", "type": "multirotor", "airspeed_m_s": 8.0}
    wing = {"name": "w", "type": "fixed_wing", "airspeed_m_s": 20.0, "min_turn_radius_m": 100.0}
    for vehicle, camera, is_told in (
        (rotors, figures, True),
        (rotors, {"model": "Sony RX1R II"}, True),
        (rotors, {"model": "DJI Zenmuse P1 35 mm"}, False),
        (rotors, figures | {"pointing_margin_deg": 2.0}, False),
        (rotors, figures | {"stabilised": True}, False),
        (wing, figures, False),
    ):
        sensor = {"name": "eye", "type": "camera", "min_interval_s": 0.1, "trigger": "distance", **camera}
        said = told(open_() | {"sensors": [sensor], "vehicles": [vehicle]}, "leans")
        assert len(said) == is_told
        assert all(each.startswith("sensor eye: ") for each in said)
