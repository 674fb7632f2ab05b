"""The pinned maps are of the sizes, shapes and densities that they are said to be of."""

from __future__ import annotations

import pytest
from shapely.geometry import Point

from benchmarks.urban_maps import DENSITIES, NAMES, named, traversable


def test_there_are_twenty() -> None:
    """Twenty names, the paper's five sizes and five shapes among them."""
    assert len(set(NAMES)) == 20
    assert sum(name.startswith("table-") for name in NAMES) == 5
    assert sum(name.startswith("shape-") for name in NAMES) == 5


@pytest.mark.parametrize("name", ["table-1", "shape-rectangle", "boxes-high", "turned-low"])
def test_a_map_is_as_dense_as_it_says(name: str) -> None:
    """The last obstacle placed takes it just below its density; the start is free."""
    found = named(name)
    assert DENSITIES[found.density] - 0.03 < traversable(found.urban) <= DENSITIES[found.density]
    start = found.urban.start
    assert all(not b.outline.intersects(Point(start)) for b in found.urban.buildings)


def test_maps_are_pinned() -> None:
    """The same seed places the same obstacles, whatever else has been made before."""
    first, again = named("boxes-low").urban, named("boxes-low").urban
    assert first == again
    assert len(first.buildings) == 61
    assert sum(b.outline.area for b in first.buildings) == pytest.approx(284960.18, rel=1e-3)
