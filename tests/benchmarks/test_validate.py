"""What the benchmark of judging judges is what its rows say."""

from __future__ import annotations

from shapely.geometry import Polygon

from benchmarks.validate import run, scenarios


def test_regions_and_teeth_are_as_many_as_are_named() -> None:
    """Each outline is a valid ring, a comb's with two corners a tooth."""
    found = dict(scenarios(30, 40))
    assert len(found["30 regions"]["features"]) == 31
    combs = [document for name, document in found.items() if "teeth" in name]
    assert len(combs) == 4
    for document in combs:
        rings = [f["geometry"]["coordinates"][0] for f in document["features"] if f["id"] != "start"]
        assert all(Polygon(ring).is_valid for ring in rings)
        assert max(map(len, rings)) >= 2 * 40


def test_a_row_tells_time_memory_and_findings() -> None:
    """Of a process of its own, in which nothing is refused in place of being judged."""
    row = next(run(regions=4, teeth=20))
    assert row["scenario"] == "4 regions"
    assert row["cpu_s"] > 0.0
    assert row["peak_MB"] > 0
    assert row["findings"] == []
