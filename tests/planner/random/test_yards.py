"""Fleets over little room: what is planned is sound, and what one of them can do alone is not refused."""

from __future__ import annotations

import pytest

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from tests.planner.random.yards import yard

#: Close to an edge, with a window and without; a region cut beside an obstacle; one that sweeps round it see.
REFUSED_ONCE = (17, 26, 101, 86)


@pytest.mark.parametrize("seed", [*REFUSED_ONCE, 2, 33, 61])
def test_a_fleet_is_planned_without_a_hard_violation(seed: int) -> None:
    """Some of these were refused, though each of their aircraft could do all of it."""
    plan = make_plan(read_scenario(yard(seed)))
    assert plan.hard_violations == ()
    missed = {each.roi for each in plan.metrics.left_out}
    assert all(part > 0.9999 for name, part in plan.metrics.coverage.items() if name not in missed)


def test_one_among_obstacles_sees_what_its_sweeps_leave() -> None:
    """They leave some of one region, and all of others; that was an internal error, then refused."""
    document = yard(56)
    document["vehicles"] = document["vehicles"][:1]
    document["vehicles"][0].pop("end_bases", None)
    del document["separation"]
    plan = make_plan(read_scenario(document))
    assert plan.hard_violations == ()
    assert plan.metrics.coverage == {f"R{k}": 1.0 for k in range(6)}
