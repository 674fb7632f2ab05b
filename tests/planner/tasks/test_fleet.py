"""Several aircraft end to end: the examples, what windows and batteries ask, what cannot be done and why."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from typing import Any

import pytest
from shapely.geometry import Polygon

from benchmarks.separation import row_of
from mavlink.encoding.encode import EncodeError, EncodeOptions, encode
from planner.errors import InfeasibleError
from planner.geojson import read_plan, read_scenario, write_plan
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from planner.tasks.fleet.jobs import cut
from planner.wishes import Region
from tests.planner.scenarios import EXAMPLES, of_two, small

Made = tuple[Scenario, Plan]


def example(name: str) -> Made:
    document: dict[str, Any] = json.loads((EXAMPLES / f"{name}.geojson").read_text())
    scenario = read_scenario(document)
    return scenario, make_plan(scenario)


@pytest.fixture(scope="module")
def port() -> Made:
    """Three aircraft of three kinds, from two bases, for SAR and camera targets with windows and visits."""
    return example("port-windows")


@pytest.fixture(scope="module")
def survey() -> Made:
    """One multirotor that changes its battery."""
    return example("four-sorties")


@pytest.fixture(scope="module")
def sweep() -> Made:
    """One region swept by five."""
    return example("five-aircraft-sweep")


@pytest.mark.parametrize("name", ["port", "survey", "sweep"])
def test_examples_are_planned_without_violations(name: str, request: pytest.FixtureRequest) -> None:
    """All is seen, what is written is read back, and every flight can be told to its autopilot by itself."""
    _, plan = request.getfixturevalue(name)
    assert plan.violations == ()
    assert set(plan.metrics.coverage.values()) == {1.0}
    assert write_plan(read_plan(write_plan(plan))) == write_plan(plan)
    for path in plan.paths:
        mission = encode(plan, path.vehicle, options=EncodeOptions(sortie=path.sortie))
        assert mission.vehicle == path.vehicle
        assert math.dist(mission.home, path.line[0][:2]) < 1e-9
        assert not mission.dialect.check(mission.mission)
    with pytest.raises(EncodeError, match="sortie 9"):
        encode(plan, plan.paths[0].vehicle, options=EncodeOptions(sortie=9))


def test_windows_and_visits_are_kept_by_the_sensors_on_board(port: Made) -> None:
    """Each region is seen with a sensor its aircraft has, within its window; the visits lie apart."""
    scenario, plan = port
    carried = {aircraft.name: aircraft.sensors or () for aircraft in scenario.aircraft}
    regions = {region.name: region for region in scenario.regions}
    for collect in plan.collects:
        assert collect.sensor in carried[collect.vehicle]
        first_s, last_s = regions[collect.roi].time_window_s or (0.0, math.inf)
        assert first_s <= collect.start_s < collect.end_s <= last_s
    visits = sorted((c.start_s, c.end_s) for c in plan.collects if c.roi == "anchorage")
    assert len(visits) == 2
    assert visits[1][0] - visits[0][1] >= regions["anchorage"].revisit_after_s
    homes = {vehicle.name: vehicle.home for vehicle in plan.vehicles}
    assert homes["camera wing"] == homes["copter"] != homes["radar wing"]


def test_work_beyond_one_battery_is_flown_in_sorties(survey: Made) -> None:
    """Each uses no more than one battery has, begins a turnaround behind the last, and goes on numbering."""
    scenario, plan = survey
    (aircraft,) = scenario.aircraft
    assert plan.sorties_of("hexa") == (1, 2, 3, 4)
    paths = [plan.path_of("hexa", sortie) for sortie in plan.sorties_of("hexa")]
    for path in paths:
        assert path.energy_wh is not None
        assert aircraft.usable_wh is not None
        assert path.energy_wh <= aircraft.usable_wh
    gaps = [b.start_s - a.end_s for a, b in pairwise(paths)]
    assert min(gaps) >= aircraft.turnaround_s - 1e-6
    assert [c.seq for c in plan.collects_of("hexa")] == list(range(1, len(plan.collects) + 1))
    own = plan.of("hexa", 3)
    assert own.paths[0].start_s == 0.0
    assert 0.0 < min(c.start_s for c in own.collects) < own.paths[0].duration_s
    assert {c.seq for c in own.collects} == {p.seq for p in own.photos}


def test_a_large_region_is_shared_out(sweep: Made) -> None:
    """Every aircraft flies about as long as the others, and together for less than a third of one alone."""
    _, plan = sweep
    own = plan.metrics.vehicles
    assert len(own) == 5
    times_s = [each.duration_s for each in own.values()]
    assert max(times_s) < 1.3 * min(times_s)
    assert plan.metrics.last_landing_s is not None
    assert plan.metrics.last_landing_s < math.fsum(times_s) / 3.0
    assert math.fsum(each.priority for each in own.values()) == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("count", [2, 3, 7])
def test_parts_of_a_region_are_equal_and_make_it_up(count: int) -> None:
    """No ground is lost or given twice."""
    area = Polygon([(0, 0), (900, 100), (1000, 500), (300, 700), (-100, 300)])
    parts = cut(Region("field", area), count)
    assert len(parts) == count
    assert [part.area for part in parts] == pytest.approx([area.area / count] * count, rel=1e-6)
    whole = parts[0]
    for part in parts[1:]:
        assert whole.intersection(part).area < 1e-3
        whole = whole.union(part)
    assert whole.symmetric_difference(area).area < 1e-3


def test_a_window_that_nobody_can_keep_is_named_with_its_margin() -> None:
    """The region, what binds, by how much it would have to give; one that need not be seen is left out."""
    document = of_two()
    wishes = document["features"][0]["properties"]
    wishes["time_window_s"] = [0.0, 60.0]
    with pytest.raises(InfeasibleError) as caught:
        make_plan(read_scenario(document))
    assert (caught.value.constraint, caught.value.feature) == ("window", "A")
    assert caught.value.relaxation
    wishes["required"] = False
    plan = make_plan(read_scenario(document))
    (left,) = plan.metrics.left_out
    assert (left.roi, left.reason) == ("A", "window")
    assert left.margin is not None
    assert left.margin > 0.0
    assert plan.metrics.coverage["B"] == 1.0
    assert plan.hard_violations == ()


def test_an_aircraft_that_its_energy_does_not_bring_home_is_named() -> None:
    """The limit and the region."""
    document = small()
    document["vehicles"][0] |= {"batteries": 2, "max_flight_time_s": 120.0}
    with pytest.raises(InfeasibleError) as caught:
        make_plan(read_scenario(document))
    assert caught.value.constraint == "flight-time"
    assert caught.value.feature in ("A", "B")


def test_where_no_optional_region_fits_that_is_said() -> None:
    """Nothing is flown; the nearest region and its limit are named."""
    document = of_two()
    for vehicle, feature in zip(document["vehicles"], document["features"], strict=False):
        vehicle["max_flight_time_s"] = 100.0
        feature["properties"]["required"] = False
    with pytest.raises(InfeasibleError) as caught:
        make_plan(read_scenario(document))
    assert caught.value.constraint == "flight-time"
    assert caught.value.feature in ("A", "B")


@pytest.mark.parametrize("seed", [1, 7])
def test_random_fleets_are_kept_apart(seed: int) -> None:
    """A sample of ``bench separation``."""
    row = row_of(seed)
    assert row["flights"] > 1
    assert row["violations"] == []
    assert row["least_m"] >= row["kept_m"]
