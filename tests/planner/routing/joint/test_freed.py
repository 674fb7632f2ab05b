"""Tours of which each place is fitted to all that may lie round it, beside the best way through options."""

from __future__ import annotations

from collections.abc import Mapping

import pytest

from planner.coverage.ways import Options
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.routing.joint import route
from planner.routing.joint.chain import layers_of
from planner.routing.joint.freed import freed
from planner.routing.joint.tours import Choice, Tours
from tests.planner.moved import box, put_at
from tests.planner.scenarios import feature, small

PUT = put_at((8.55, 47.4))


def seen_often(number: int) -> dict[str, object]:
    """A wide region of several lanes, one seen twice and a place seen three times."""
    side_m = 900.0 + 150.0 * number
    return small() | {
        "features": [
            feature("R", "roi", "Polygon", box(PUT, 0, 0, side_m, 1400)),
            feature("S", "roi", "Polygon", box(PUT, 2500, 300, 2900, 600), revisits=2),
            feature("P", "roi", "Point", PUT(-900, 1500), revisits=3),
            feature("start", "start", "Point", PUT(-1500, -1000)),
        ]
    }


@pytest.mark.parametrize("number", range(3))
def test_a_freed_tour_is_no_dearer_than_any_of_the_options_given(
    number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It costs what its options cost in a row, no more than the best of those given, or than before."""
    told: list[tuple[float, float, float, float]] = []

    def watched(tours: Tours, choice: Choice, wide: Mapping[int, Options]) -> Choice:
        found = freed(tours, choice, wide)
        where = (tours.ends, tours.around)
        own_m, _ = layers_of(*where, list(found.picked), tours.around.discs).best()
        all_m, _ = layers_of(*where, [wide[n] for n in choice.order], tours.around.discs).best()
        assert found.order == choice.order
        told.append((found.cost_m, own_m, all_m, choice.cost_m))
        return found

    monkeypatch.setattr(route, "freed", watched)
    plan = make_plan(read_scenario(seen_often(number)))
    assert plan.hard_violations == ()
    assert told
    for cost_m, own_m, all_m, before_m in told:
        assert cost_m == pytest.approx(own_m, abs=1e-6)
        assert cost_m <= min(all_m, before_m) + 1e-6
