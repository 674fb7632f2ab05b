"""Stacks of short sweeps laid anew across."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import box

from planner.coverage.urban.frontier import Laid
from planner.coverage.urban.layout import Layout, cheapest, each_m
from planner.coverage.urban.mend import mended
from planner.coverage.urban.relay import relaid
from planner.coverage.urban.visibility import edges_of
from tests.planner.coverage.urban.shapes import random_area
from tests.planner.coverage.urban.test_auto import TOWN

#: A field, and a street of 40 m that runs away from it.
FIELD = shapely.union_all([box(0, 0, 400, 200), box(0, 200, 40, 500)])


def test_a_street_is_swept_along() -> None:
    """Ten lanes over the field stay, fifteen short ones across the street become two along it."""
    urban = replace(TOWN, area=FIELD, buildings=())
    rows = [(15.0, 385.0, 10.0 + 20.0 * k) for k in range(10)] + [
        (15.0, 25.0, 210.0 + 20.0 * k) for k in range(15)
    ]
    base = Laid(0.0, np.array(rows))
    cost_m = float(base.lengths_m.sum()) + each_m(urban) * len(rows)
    found = relaid(Layout((base,), cost_m), urban, FIELD, edges_of(FIELD))
    assert [len(each.rows) for each in found.laid] == [10, 2]
    told_m = sum(float(each.lengths_m.sum()) + each_m(urban) * len(each.rows) for each in found.laid)
    assert found.cost_m == pytest.approx(told_m)
    assert told_m < cost_m - 900.0


@pytest.mark.parametrize("shape", ["square", "irregular"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_all_is_seen_at_no_more_cost(shape: str, seed: int) -> None:
    """Random buildings: as strips of shapely's, all ground is still seen, and no layout got dearer."""
    urban = random_area(shape, seed)
    ground = max(
        shapely.get_parts(
            urban.area.difference(
                shapely.union_all([b.outline.buffer(10.0, join_style="mitre") for b in urban.buildings])
            )
        ),
        key=lambda part: part.area,
    )
    edges = edges_of(ground)
    first = cheapest(urban, edges)
    again = relaid(first, urban, ground, edges)
    assert again.cost_m <= first.cost_m
    seen = shapely.union_all(
        np.concatenate([each.strips(20.0, 30.0) for each in mended(again, urban, ground, edges).laid]),
        grid_size=1e-6,
    )
    assert ground.difference(seen).area < 1e-2
