"""A new kind of sensor and a new task take a file each, and a registration; nothing else is touched."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon

from planner.check.footprints import FOOTPRINTS
from planner.coverage.registry import FAMILIES
from planner.errors import ScenarioError
from planner.geojson import read_scenario
from planner.pipeline import make_plan, with_bound
from planner.registry import register_sensor, register_task
from planner.sensors.registry import KINDS, Kind
from planner.tasks.registry import TASKS
from planner.validate import findings, read_valid
from tests.planner.scenarios import feature, small, square
from tests.planner.toys import scanner
from tests.planner.toys.tour import TOUR

SCANNER = {"name": "eye", "type": "scanner", "swath_m": 900.0}


@pytest.fixture
def toys() -> Iterator[None]:
    """Both toys, registered, and forgotten after."""
    kind = Kind(scanner.read, scanner.seen_on_terrain)
    register_sensor("scanner", kind, scanner.Scanners(), scanner.footprint)
    register_task("tour", TOUR)
    yield
    for known in (KINDS, FAMILIES, FOOTPRINTS):
        del known["scanner"]
    del TASKS["tour"]


def local(scenario: object, collect: object) -> LineString:
    return LineString(scenario.frame.to_local([place[:2] for place in collect.line]))  # type: ignore[attr-defined]


@pytest.mark.usefixtures("toys")
def test_a_sensor_is_read_planned_with_and_judged() -> None:
    """Scanner and SAR in one scenario: every region is seen with its own, the scanner's from over it."""
    document = small(feature("S", "roi", "Polygon", square(0.02, 0.03, 0.004), sensor="eye"))
    document["sensors"].append(SCANNER)
    scenario = read_valid(document)
    plan = with_bound(scenario, make_plan(scenario))
    assert plan.metrics.lower_bound_m == 0.0
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == dict.fromkeys([region.name for region in scenario.regions], 1.0)
    (over,) = (collect for collect in plan.collects if collect.sensor == "eye")
    assert (over.roi, over.look) == ("S", "down")
    region = next(region for region in scenario.regions if region.name == "S")
    line = local(scenario, over)
    assert line.distance(region.area.centroid) < 100.0
    assert region.area.difference(line.buffer(450.0, cap_style="flat")).area < 1.0
    (seen,) = (print_ for print_ in plan.footprints if print_.sensor == "eye")
    assert Polygon(scenario.frame.to_local(seen.ring)).area == pytest.approx(900.0 * line.length, rel=1e-3)
    assert len({collect.sensor for collect in plan.collects}) == 2


@pytest.mark.usefixtures("toys")
def test_what_a_sensor_cannot_see_is_refused_by_its_family() -> None:
    """A region wider than the strip: named, with what would help, before any planning."""
    document = small(feature("S", "roi", "Polygon", square(0.02, 0.03, 0.02), sensor="eye"))
    document["sensors"].append(SCANNER)
    found = findings(document)
    assert [(f.feature, f.rule, f.severity) for f in found] == [("S", "not-seen-swath", "error")]


@pytest.mark.usefixtures("toys")
def test_a_task_is_answered_published_and_judged() -> None:
    """A tour comes by every region's middle and, sensors off, is told to have seen nothing."""
    scenario = read_scenario(small(feature("end", "end", "Point", [0.03, 0.0]), task="tour"))
    plan = with_bound(scenario, make_plan(scenario))
    assert 0.0 < plan.metrics.lower_bound_m < plan.metrics.length_m
    line = LineString(scenario.frame.to_local([place[:2] for place in plan.paths[0].line]))
    for region in scenario.regions:
        assert line.distance(Point(region.area.centroid)) < 0.05
    assert {v.constraint for v in plan.violations} == {"coverage"}
    assert max(plan.metrics.coverage.values()) < 1e-6
    altitudes_m = np.array([place[2] for place in plan.paths[0].line])
    lengths_m = np.hypot(np.hypot(*np.diff(np.array(line.coords), axis=0).T), np.diff(altitudes_m))
    assert plan.metrics.flight_length_m == pytest.approx(float(lengths_m.sum()), rel=1e-3)


@pytest.mark.parametrize(
    ("more", "rule"), [({"task": "tour"}, "unknown-value"), ({"sensors": [SCANNER]}, "unknown-value")]
)
def test_what_is_not_registered_is_refused(more: dict[str, object], rule: str) -> None:
    """Neither toy is known without its registration."""
    with pytest.raises(ScenarioError) as caught:
        read_scenario(small(**more))
    assert rule in {finding.rule for finding in caught.value.findings}
