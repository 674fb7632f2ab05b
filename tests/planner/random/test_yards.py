"""Fleets over little room: what is planned is sound, and what one of them can do alone is not refused."""

from __future__ import annotations

import pytest

from planner.errors import InfeasibleError
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


def test_one_among_obstacles_is_told_what_it_cannot_see() -> None:
    """Its sweeps leave some of a region, and nothing of others; that ended with an internal error."""
    document = yard(56)
    document["vehicles"] = document["vehicles"][:1]
    document["vehicles"][0].pop("end_bases", None)
    del document["separation"]
    with pytest.raises(InfeasibleError, match=r"R5.*is seen by no pass that keeps out of hard zone Z1"):
        make_plan(read_scenario(document))
