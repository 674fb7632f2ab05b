"""A region behind a hard zone: the zone is named, and what is said to help does, and no less of it."""

from __future__ import annotations

import functools
import math
import re
from dataclasses import replace
from typing import Any

import pytest

from planner.airspace.airspace import Airspace
from planner.airspace.shapes import hard_shapes
from planner.coverage.relaxation import moved, shrunk
from planner.errors import InfeasibleError
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.scenario import Scenario
from planner.validate import findings
from tests.planner.scenarios import feature, small, square
from tests.planner.stages import sides_of

#: Over region A, wider than any pass that sees it is away.
ZONES: dict[str, dict[str, Any]] = {
    "disc": feature("Z", "no_fly", "Point", [0.0035, 0.0015], radius_m=1500.0),
    "polygon": feature("Z", "no_fly", "Polygon", square(-0.0105, -0.0110, 0.026)),
    "under a ceiling": feature("Z", "no_fly", "Polygon", square(-0.0105, -0.0110, 0.026), ceiling_m=640.0),
    "obstacle": feature("Z", "obstacle", "Polygon", square(-0.0105, -0.0110, 0.026), height_m=560.0),
    "threat": feature(
        "Z", "threat", "Point", [0.0035, 0.0015], model="missile", radius_m=1500.0, hard=True, height_m=700.0
    ),
}


def behind(kind: str, *more: dict[str, Any], **members: Any) -> Scenario:
    """The small scenario with a zone over region A; home is at sea level."""
    document = small(ZONES[kind], *more, **{"clearance_m": 0.0} | members)
    for start in (f for f in document["features"] if f["properties"]["role"] == "start"):
        start["geometry"]["coordinates"].append(0.0)
    return read_scenario(document)


def refusal(scenario: Scenario) -> InfeasibleError:
    with pytest.raises(InfeasibleError) as caught:
        make_plan(scenario)
    return caught.value


@functools.cache
def refused(kind: str) -> tuple[Scenario, InfeasibleError]:
    """The small scenario with a zone, and why it is refused."""
    scenario = behind(kind)
    return scenario, refusal(scenario)


def can_be_seen(scenario: Scenario) -> bool:
    try:
        sides_of(scenario)
    except InfeasibleError:
        return False
    return True


def within(scenario: Scenario, airspace: Airspace) -> Scenario:
    """The scenario with an airspace's zones."""
    zones = {name: getattr(airspace, name) for name in ("threats", "no_fly", "obstacles")}
    return replace(scenario, **zones)


def by(scenario: Scenario, far_m: float, unit: tuple[float, float]) -> Scenario:
    """The scenario with the zone moved."""
    return within(scenario, moved(scenario.airspace, "Z", far_m * unit[0], far_m * unit[1]))


@pytest.mark.parametrize("kind", list(ZONES))
def test_the_zone_is_named_and_the_least_that_helps(kind: str) -> None:
    """Drawn in, or moved, by as much as said, the region is seen; by 3 m less it is not."""
    scenario, error = refused(kind)
    assert (error.constraint, error.feature) == ("hard-zone", "A")
    assert "Z" in error.message
    drawn = re.search(r"draw the edge of Z in by (\d+) m", error.relaxation)
    away = re.search(r"move Z (\d+) m ([a-z-]+)", error.relaxation)
    assert drawn is not None
    assert away is not None
    by_m = float(drawn[1])
    assert can_be_seen(within(scenario, shrunk(scenario.airspace, "Z", by_m)))
    assert not can_be_seen(within(scenario, shrunk(scenario.airspace, "Z", by_m - 3.0)))
    (zone,) = hard_shapes(scenario.airspace, scenario.level)
    (region,) = (r for r in scenario.regions if r.name == "A")
    here, there = region.area.centroid, zone.polygon().centroid
    apart_m = here.distance(there)
    unit = (there.x - here.x) / apart_m, (there.y - here.y) / apart_m
    assert ("east" in away[2]) == (unit[0] > math.sin(math.pi / 8.0))
    assert can_be_seen(by(scenario, float(away[1]), unit))
    nearer_m = float(away[1]) - 3.0
    assert not can_be_seen(by(scenario, nearer_m, unit))


@pytest.mark.parametrize(
    ("kind", "altitude_m"), [("under a ceiling", 641.0), ("obstacle", 561.0), ("threat", 701.0)]
)
def test_an_altitude_that_helps_is_told(kind: str, altitude_m: float) -> None:
    """Just over what has a top, the region is seen: said, and true; a zone without end has no such way."""
    scenario, error = refused(kind)
    assert f"fly at {altitude_m:.0f} m" in error.relaxation
    assert can_be_seen(replace(scenario, altitude_m=altitude_m))
    assert not can_be_seen(replace(scenario, altitude_m=altitude_m - 2.0))
    assert "fly at" not in refused("disc")[1].relaxation


def test_only_threats_can_be_made_soft() -> None:
    """``hard: false`` is proposed for a threat, and not for a no-fly zone."""
    assert "hard: false" in refused("threat")[1].relaxation
    assert "hard: false" not in refused("polygon")[1].relaxation


def test_zones_that_only_together_are_in_the_way_are_named_together() -> None:
    """Two zones one over the other: neither alone is to blame."""
    twin = feature("Y", "no_fly", "Point", [0.0035, 0.0015], radius_m=1500.0)
    error = refusal(behind("disc", twin))
    assert error.constraint == "hard-zone"
    assert "Y" in error.message
    assert "Z" in error.message


def test_a_zone_elsewhere_is_not_blamed() -> None:
    """Where the area is too small for any pass, zones or not, the area is what is named."""
    document = small(feature("Z", "no_fly", "Point", [0.03, 0.03], radius_m=200.0))
    document["features"][2]["geometry"]["coordinates"] = square(-0.001, -0.001, 0.036)
    document["features"][3]["geometry"]["coordinates"] = [0.01, 0.0]
    document["altitude_m"] = 8000.0
    assert refusal(read_scenario(document)).constraint == "area"


def test_validation_and_dropping_know_the_name() -> None:
    """The finding's rule is not-seen-hard-zone; a region that need not be seen is dropped with it."""
    document = small(ZONES["disc"])
    assert [f.rule for f in findings(document) if f.severity == "error"] == ["not-seen-hard-zone"]
    document["features"][0]["properties"]["required"] = False
    plan = make_plan(read_scenario(document))
    assert [u.roi for u in plan.uncovered] == ["A"]
    assert "hard zone Z" in plan.uncovered[0].reason
    assert any("not-seen-hard-zone" in warning for warning in plan.warnings)


@pytest.mark.parametrize("routing", ["li2018", "li2018-threat-aware"])
def test_the_paper_s_methods_blame_zones_only_where_they_are_to_blame(routing: str) -> None:
    """By name, too: the zone over the region gives hard-zone."""
    assert refusal(behind("disc", method={"routing": routing})).constraint == "hard-zone"
