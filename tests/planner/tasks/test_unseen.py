"""What a camera cannot see beside hard zones: a required region is refused, and what is said to work does."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
import shapely
from shapely.geometry import Polygon, box

from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.validate import findings
from tests.planner.scenarios import feature, small

#: Of a degree on the equator, about.
DEGREE_M = 111_195.0
#: Half the region's side.
HALF_M = 111.0
REGION = box(-HALF_M, -HALF_M, HALF_M, HALF_M)
EYE = {
    "name": "eye", "type": "camera", "focal_length_m": 0.02, "pixel_pitch_m": 23.5e-3 / 6000,
    "image_px": [6000, 4000],
}  # fmt: skip
WINGS = {"name": "a", "airspeed_m_s": 20.0, "min_turn_radius_m": 40.0}
ROTORS = {"name": "a", "type": "multirotor", "airspeed_m_s": 8.0}
ZONES = {
    "corner": [box(30, 30, 250, 250)],
    "edge": [box(-300, -60, -60, 60)],
    "side": [box(-250, 70, 250, 250)],
    "whole": [box(-200, -200, 200, 200)],
    "two": [box(50, 50, 250, 250), box(-250, -250, -40, -40)],
    "speck": [box(-2, -2, 2, 2)],
}


def degrees(shape: Polygon) -> list[list[list[float]]]:
    """Coordinates as of GeoJSON."""
    return [
        [[x / DEGREE_M, y / DEGREE_M] for x, y in ring.coords] for ring in (shape.exterior, *shape.interiors)
    ]


def asked(
    vehicle: dict[str, Any], zones: list[Polygon], role: str, region: Any = REGION, **wishes: Any
) -> dict[str, Any]:
    document = small(sensors=[EYE], vehicles=[vehicle], altitude_m=80.0)
    document["features"] = [each for each in document["features"] if each["id"] in ("area", "start")]
    at = [degrees(part) for part in getattr(region, "geoms", [region])]
    document["features"].append(feature("C", "roi", "MultiPolygon", at, **wishes))
    more = {"height_m": 150.0} if role == "obstacle" else {}
    for k, zone in enumerate(zones):
        document["features"].append(feature(f"Z{k}", role, "Polygon", degrees(zone), **more))
    return document


def planned(document: dict[str, Any]) -> Plan | InfeasibleError:
    try:
        return make_plan(read_scenario(document))
    except InfeasibleError as refused:
        return refused


@pytest.mark.parametrize(
    ("kind", "vehicle", "role"),
    [
        ("corner", ROTORS, "no_fly"),
        ("side", WINGS, "obstacle"),
        ("two", ROTORS, "no_fly"),
        ("edge", WINGS, "no_fly"),
        ("whole", WINGS, "obstacle"),
        ("speck", ROTORS, "no_fly"),
    ],
)
def test_no_plan_leaves_ground_of_a_required_region(kind: str, vehicle: dict[str, Any], role: str) -> None:
    """Refused with region and zones named, or seen whole; what is said to work does."""
    found = planned(asked(vehicle, ZONES[kind], role))
    if isinstance(found, Plan):
        assert kind != "whole"
        assert found.metrics.coverage["C"] == 1.0
        assert not [violation for violation in found.violations if violation.hard]
        return
    assert (found.constraint, found.feature) == ("hard-zone", "C")
    if (higher := re.search(r"altitude_m of (\d+)", found.relaxation)) is not None:
        over = planned(asked(vehicle, ZONES[kind], role) | {"altitude_m": float(higher[1])})
        assert isinstance(over, Plan)
        assert over.metrics.coverage["C"] == 1.0
    if (told := re.match(r"([0-9.]+) % of it \(", found.message)) is None:
        assert kind == "whole"
        return
    some = planned(asked(vehicle, ZONES[kind], role, required=False))
    assert isinstance(some, Plan)
    assert not [violation for violation in some.violations if violation.hard]
    assert 100.0 * (1.0 - some.metrics.coverage["C"]) == pytest.approx(float(told[1]), abs=0.2)
    cut = re.search(r"cut ([^,]*?)(?: with (\d+) m round \w+)? out of it", found.relaxation)
    assert cut is not None
    zones = shapely.union_all([ZONES[kind][int(name)] for name in re.findall(r"Z(\d)", cut[1])])
    left = REGION.difference(zones.buffer(float(cut[2] or 0.0)))
    rest = planned(asked(vehicle, ZONES[kind], role, left))
    assert isinstance(rest, Plan)
    assert not [violation for violation in rest.violations if violation.hard]


def test_a_ceiling_below_what_fills_a_region_is_told_to_be_raised() -> None:
    """To a value that works."""
    document = asked(ROTORS, [box(-250, -250, 250, 250)], "obstacle") | {"max_height_m": 100.0}
    refused = planned(document)
    assert isinstance(refused, InfeasibleError)
    told = re.search(r"altitude_m of (\d+), with max_height_m raised to (\d+)", refused.relaxation)
    assert told is not None
    over = planned(document | {"altitude_m": float(told[1]), "max_height_m": float(told[2])})
    assert isinstance(over, Plan)
    assert over.metrics.coverage["C"] == 1.0


@pytest.mark.parametrize("kind", ["corner", "two"])
def test_validation_tells_of_ground_that_no_photo_reaches(kind: str) -> None:
    """Region and zone named as planning does, and no more than planning finds unseen."""
    document = asked(ROTORS, ZONES[kind], "no_fly")
    (told,) = (each for each in findings(document) if each.severity == "error")
    assert (told.feature, told.rule) == ("C", "not-seen-hard-zone")
    share = re.match(r"at least ([0-9.]+) % of it \(", told.message)
    assert share is not None
    refused = planned(document)
    assert isinstance(refused, InfeasibleError)
    found = re.match(r"([0-9.]+) % of it \(", refused.message)
    assert found is not None
    assert 0.0 < float(share[1]) <= float(found[1]) + 0.05


@pytest.mark.parametrize("seed", range(4))
def test_validation_refuses_nothing_that_can_be_planned(seed: int) -> None:
    """Zones of any size and place: what is refused unseen, planning refuses, too."""
    rng = np.random.default_rng(seed)
    zones = []
    for _ in range(3):
        east, north = rng.uniform(-HALF_M, HALF_M, 2)
        zones.append(box(east, north, east + rng.uniform(20.0, 160.0), north + rng.uniform(20.0, 160.0)))
    document = asked(ROTORS, zones, "no_fly" if seed % 2 else "obstacle")
    if any(each.severity == "error" for each in findings(document)):
        assert isinstance(planned(document), InfeasibleError)
