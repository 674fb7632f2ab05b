"""``auto`` among obstacles: complete, clear, and shorter than the methods by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate, scale, translate
from shapely.geometry import LineString, Point, box

from planner.coverage.urban.area import Building, UrbanArea
from planner.coverage.urban.auto import Auto
from planner.coverage.urban.free import free_space
from planner.coverage.urban.majeed import Majeed2019
from planner.coverage.urban.measures import line_m, measure
from planner.errors import InfeasibleError

BUILDINGS = tuple(
    Building(box(x, y, x + wide, y + deep), high)
    for x, y, wide, deep, high in (
        (60, 50, 70, 90, 200), (190, 40, 60, 50, 40), (180, 150, 110, 60, 300), (60, 220, 60, 60, 12),
        (300, 60, 50, 40, 30), (20, 170, 30, 40, 90),
    )
)  # fmt: skip
TOWN = UrbanArea(box(0, 0, 400, 300), BUILDINGS, 20.0, 30.0, 25.0, 150.0, 10.0, (5.0, 5.0), (5.0, 5.0))


def moved(urban: UrbanArea, how: object) -> UrbanArea:
    """The same town elsewhere."""
    place = how(Point(urban.start))  # type: ignore[operator]
    return replace(
        urban,
        area=how(urban.area),  # type: ignore[operator]
        buildings=tuple(replace(b, outline=how(b.outline)) for b in urban.buildings),  # type: ignore[operator]
        start=(place.x, place.y),
        end=(place.x, place.y),
    )


def test_all_that_can_be_reached_is_seen_and_nothing_is_hit() -> None:
    """Seen whole, inside the area, and clear of each building that the flight is not above."""
    flown = Auto()(TOWN)
    free = free_space(TOWN)
    seen = shapely.union_all([sweep.seen(20.0, 15.0) for sweep in flown.sweeps])
    assert free.ground.difference(seen).area < 1e-2
    assert TOWN.area.covers(LineString(flown.line[:, :2]))
    for before, after in zip(flown.line, flown.line[1:], strict=False):
        low_m = min(before[2], after[2])
        for building in TOWN.buildings:
            if building.height_m + 10.0 > low_m + 1e-6:
                assert building.outline.distance(LineString([before[:2], after[:2]])) > 10.0 - 0.01
    assert flown.line[0, :2].tolist() == [5.0, 5.0]
    assert flown.line[-1, :2].tolist() == [5.0, 5.0]


def test_it_is_shorter_than_the_papers_with_fewer_turns_and_less_overlap() -> None:
    """By a tenth at least."""
    free = free_space(TOWN)
    ours, theirs = (measure(TOWN, free, method(TOWN)) for method in (Auto(), Majeed2019()))
    assert ours.length_m < 0.9 * theirs.length_m
    assert ours.turns < theirs.turns
    assert ours.overlap_m <= theirs.overlap_m
    assert ours.coverage == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    "how",
    [
        lambda shape: translate(shape, 4000.0, -900.0),
        lambda shape: rotate(shape, 33.0, origin=(0, 0)),
        lambda shape: scale(shape, -1.0, 1.0, origin=(0, 0)),
    ],
    ids=["moved", "turned", "mirrored"],
)
def test_where_a_town_lies_changes_nothing(how: object) -> None:
    """About as long wherever the same town is."""
    assert line_m(Auto()(moved(TOWN, how)).line) == pytest.approx(line_m(Auto()(TOWN).line), rel=0.005)


def test_the_same_again() -> None:
    """Byte for byte."""
    assert np.array_equal(Auto()(TOWN).line, Auto()(TOWN).line)


def test_an_area_filled_by_a_building_is_refused() -> None:
    """With the height that would pass over it."""
    full = replace(TOWN, buildings=(Building(box(-10, -10, 410, 310), 60.0),))
    with pytest.raises(InfeasibleError, match="70 m"):
        Auto()(full)
