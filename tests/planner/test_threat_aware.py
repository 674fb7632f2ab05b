"""Choices that mind threats are no riskier than blind ones, whatever connects them and at any height."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pyproj import Geod

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from tests.planner.scenarios import case, feature, small

GEOD = Geod(ellps="WGS84")


def planned(document: dict[str, Any], routing: str, transit: str = "ssas") -> Plan:
    """The plan by named methods."""
    return make_plan(read_scenario(document | {"method": {"routing": routing, "transit": transit}}))


def inside_m(plan: Plan, document: dict[str, Any]) -> float:
    """Metres within soft threats, by geodesics from points along the line to the threats."""
    lons, lats, _ = np.array(plan.paths[0].line).T
    _, _, steps_m = GEOD.inv(lons[:-1], lats[:-1], lons[1:], lats[1:])
    along_m = np.concatenate([[0.0], np.cumsum(steps_m)])
    at_m = np.arange(0.0, along_m[-1], 5.0)
    lon, lat = np.interp(at_m, along_m, lons), np.interp(at_m, along_m, lats)
    inside = np.zeros(len(at_m), dtype=np.bool_)
    for threat in document["features"]:
        properties = threat["properties"]
        if properties["role"] != "threat" or properties.get("hard"):
            continue
        centre = threat["geometry"]["coordinates"]
        away_m = GEOD.inv(lon, lat, np.full(len(lon), centre[0]), np.full(len(lat), centre[1]))[2]
        inside |= away_m < properties["radius_m"] - 0.5
    return 5.0 * float(inside.sum())


@pytest.mark.parametrize("number", [1, 4])
def test_minding_threats_is_no_riskier_on_the_shared_cases(number: int) -> None:
    """With SSAS the choices that mind threats fly through none of those cases' threats."""
    aware = planned(case(number), "li2018-threat-aware")
    assert inside_m(aware, case(number)) == 0.0
    assert aware.metrics.risk_missile + aware.metrics.risk_radar == 0.0
    assert {transit.method for transit in aware.transits} == {"ssas"}


def threatened(seed: int, **properties: float) -> dict[str, Any]:
    """Two regions, start and end, and threats between them, close to each other."""
    rng = np.random.default_rng(seed)
    threats = []
    for index in range(5):
        place = [float(rng.uniform(-0.02, 0.04)), float(rng.uniform(-0.02, 0.03))]
        threats.append(
            feature(
                f"T{index}",
                "threat",
                "Point",
                place,
                model="missile",
                radius_m=float(rng.uniform(250.0, 700.0)),
                **properties,
            )
        )
    return small(*threats)


@pytest.mark.parametrize("seed", range(5))
def test_ssas_flies_through_no_threat_that_tangents_keep_out_of(seed: int) -> None:
    """Among random threats SSAS is inside them no longer than the tangent connector on the same passes."""
    document = threatened(seed)
    by_ssas, by_tangent = (planned(document, "li2018-threat-aware", name) for name in ("ssas", "tangent"))
    assert [c.line for c in by_ssas.collects] == [c.line for c in by_tangent.collects]
    if inside_m(by_tangent, document) == 0.0:
        assert inside_m(by_ssas, document) == 0.0


def test_capped_threats_count_by_the_height_over_their_ground() -> None:
    """Flown over, capped threats change nothing for SSAS; the same flight said in amsl is the same plan."""
    over, under = threatened(3, height_m=400.0), threatened(3, height_m=600.0)
    free = small()
    lines = {}
    for name, document in (("over", over), ("under", under), ("free", free)):
        for reference, altitude_m in (("home", 500.0), ("amsl", 1700.0)):
            start = document["features"][3]["geometry"]["coordinates"]
            document["features"][3]["geometry"]["coordinates"] = [*start[:2], 1200.0]
            said = document | {"altitude_reference": reference, "altitude_m": altitude_m}
            # What is flown at the route's level: below it, on the way up and down, they do count.
            lines[name, reference] = [
                (round(lon, 9), round(lat, 9))
                for transit in planned(said, "li2018").transits[1:-1]
                for lon, lat, _ in transit.line
            ]
    for name in ("over", "under", "free"):
        assert lines[name, "home"] == lines[name, "amsl"]
    assert lines["over", "amsl"] == lines["free", "amsl"]
    assert lines["under", "amsl"] != lines["free", "amsl"]
