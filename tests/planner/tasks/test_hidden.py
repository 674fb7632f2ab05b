"""Ground in shadow and layover: lanes answer for it, other passes are sought, what no direction sees is said.

The judge is the authority on what is seen: it measures the published lines.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from planner.check import judge
from planner.coverage.merge import split_region
from planner.coverage.strips.neighbourhood import options as every_way
from planner.frames import LocalFrame
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.progress import never
from planner.scenario import Scenario
from planner.tasks.hidden import hidden_findings
from tests.planner.scenarios import small, square
from tests.planner.stages import legs_of as legs_in
from tests.planner.stages import see_hidden, sensing, sight_of, surroundings
from tests.planner.terrains import raster

MIDDLE = LocalFrame(0.01, 0.01)


def hills(slope: float, apart_m: float, height_m: float) -> Callable[[Any, Any], Any]:
    """Cones in rows and columns: their far sides in shadow, their near sides in layover."""

    def surface(east: Any, north: Any) -> Any:
        from_top_m = np.hypot(
            (east + 1110.0) % apart_m - apart_m / 2.0, (north + 1110.0) % apart_m - apart_m / 2.0
        )
        return np.maximum(0.0, height_m - slope * from_top_m)

    return surface


def on(surface: Callable[[Any, Any], Any], size_deg: float, look: str, **members: Any) -> Scenario:
    """The small scenario on a surface, region A of another size."""
    document = small(terrain="t", clearance_m=10.0, **members)
    document["features"][0]["geometry"]["coordinates"] = square(0.0, 0.0, size_deg)
    document["sensors"][0]["look"] = look
    return read_scenario(document, {"t": raster(surface, MIDDLE, posts=1201)})


@lru_cache
def planned(size_deg: float, look: str, coverage: str) -> tuple[Scenario, Plan]:
    """Region A among steep hills."""
    scenario = on(hills(1.0, 200.0, 40.0), size_deg, look, method={"coverage": coverage})
    return scenario, make_plan(scenario)


@pytest.mark.parametrize(("size_deg", "look"), [(0.004, "right"), (0.007, "both")])
def test_what_no_single_direction_sees_is_seen_from_several(size_deg: float, look: str) -> None:
    """Among hills every region is seen whole, as the judge has it, by more passes than on flat ground."""
    scenario, plan = planned(size_deg, look, "auto")
    verdict = judge(scenario, plan)
    assert verdict.coverage == {"A": 1.0, "B": 1.0}
    assert verdict.violations == ()
    flat = make_plan(on(hills(0.0, 200.0, 0.0), size_deg, look))
    assert len(plan.collects) > len(flat.collects)


def test_the_paper_s_coverage_keeps_to_flat_ground_and_says_so() -> None:
    """Under li2018 no pass is added: uncovered ground has its reason, and the plan warns."""
    scenario, plan = planned(0.004, "right", "li2018")
    assert judge(scenario, plan).coverage["A"] < 1.0
    assert [len(plan.collects), plan.hard_violations[0].constraint] == [2, "coverage"]
    assert "shadow or layover" in {u.roi: u.reason for u in plan.uncovered}["A"]
    assert any("hidden-ground" in warning and "auto" in warning for warning in plan.warnings)


def test_every_pass_is_needed() -> None:
    """Without any one of the passes some region is seen less."""
    scenario, plan = planned(0.004, "right", "auto")
    for collect in plan.collects:
        others = tuple(c for c in plan.collects if c is not collect)
        without = judge(
            scenario, Plan(**{n: getattr(plan, n) for n in Plan.__slots__} | {"collects": others})
        )
        assert min(without.coverage.values()) < 1.0


def test_lanes_of_a_sweep_keep_clear_of_shadow() -> None:
    """Of a region four swaths wide between ridges the lanes see all by themselves: they look along."""
    ridges = on(lambda e, n: 60.0 * np.exp(-((((n + 1110.0) % 400.0 - 200.0) / 25.0) ** 2)), 0.018, "right")
    plan = make_plan(ridges)
    assert plan.violations == ()
    lanes = [c.heading_deg for c in plan.collects if "A" in c.regions]
    assert len(lanes) <= 4
    assert all(abs(math.remainder(heading_deg, 180.0)) < 20.0 for heading_deg in lanes)


@settings(deadline=None, max_examples=6)
@given(
    slope=st.floats(0.7, 1.6),
    apart_m=st.floats(150.0, 320.0),
    look=st.sampled_from(["right", "both"]),
)
def test_what_is_left_no_pass_sees_much_of(slope: float, apart_m: float, look: str) -> None:
    """Whatever the hills, ground left unseen is hidden from every way to see its region, tried one by one."""
    scenario = on(hills(slope, apart_m, 30.0), 0.003, look)
    plan = make_plan(scenario)
    verdict = judge(scenario, plan)
    assert {v.constraint for v in verdict.violations} <= {"coverage"}
    assert {u.roi for u in plan.uncovered} == set(verdict.unseen)
    assert scenario.terrain is not None
    sight = sight_of(scenario)
    assert sight is not None
    for name, rest in verdict.unseen.items():
        region = next(r for r in scenario.regions if r.name == name)
        (part,) = split_region(region)
        sensor, height_m = sensing(scenario, scenario.sensors[0], part.area)
        for (collect,) in every_way(
            part, sensor, height_m, (0.0, 0.5, 1.0), math.radians(30.0), scenario.area
        ):
            gained = shapely.intersection(rest, sight.seen(collect), grid_size=1e-6).area
            assert gained < 0.2 * rest.area


def test_passes_go_where_they_cost_least_and_needless_ones_go() -> None:
    """No place is cheaper for what is added for the first region; a pass that was there twice is so once."""
    scenario = on(hills(1.0, 200.0, 40.0), 0.004, "right")
    around, legs = surroundings(scenario), legs_in(scenario, never)
    first, last = (
        next(every_way(split_region(region)[0], *sensing(scenario, scenario.sensors[0], region.area)))[0]
        for region in scenario.regions[:2]
    )
    tour = see_hidden(scenario, around, (first, first, last), legs)
    assert tour.count(first) <= 1
    added = [at for at, collect in enumerate(tour) if collect not in (first, last) and "A" in collect.regions]
    assert added
    tour_m = legs.tour_m(tour)
    for at in added:
        rest = (*tour[:at], *tour[at + 1 :])
        for place in range(len(tour)):
            assert legs.tour_m((*rest[:place], tour[at], *rest[place:])) > tour_m - 1.0


def test_flat_ground_needs_nothing_more() -> None:
    """Without terrain, and on flat terrain, the tour stays as it is."""
    for scenario in (read_scenario(small()), on(hills(0.0, 200.0, 0.0), 0.004, "right")):
        around = surroundings(scenario)
        (part,) = split_region(scenario.regions[0])
        sensor, height_m = sensing(scenario, scenario.sensors[0], part.area)
        passes = next(every_way(part, sensor, height_m))
        assert see_hidden(scenario, around, passes, legs_in(scenario, never)) is passes


def test_ground_outside_every_beam_is_not_called_hidden() -> None:
    """A region no pass was laid for is unseen, yet nothing hides it: the warning is for shadow."""
    scenario = on(hills(0.0, 200.0, 0.0), 0.004, "right")
    region = scenario.regions[1]
    passes = next(every_way(split_region(region)[0], *sensing(scenario, scenario.sensors[0], region.area)))
    assert scenario.terrain is not None
    sight = sight_of(scenario)
    assert sight is not None
    assert set(sight.unseen(passes)) == {"A"}
    assert hidden_findings(sight, passes, by_paper=False) == ()
