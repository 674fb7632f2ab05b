"""``bench urban`` compares methods by name on the maps asked for."""

from __future__ import annotations

from benchmarks.urban import COMPARED, run
from benchmarks.urban_table import tables
from planner.coverage.urban.methods import METHODS


def test_rows_tell_what_each_method_comes_to() -> None:
    """One map, all compared: everything is seen, the free ground over the width is the least length.

    A frame sees half its 30 m beyond both ends of a sweep. ``auto`` is the shortest.
    """
    rows = list(run("shape-rectangle", COMPARED))
    assert [row["method"] for row in rows] == list(COMPARED)
    assert f"| shape-rectangle | 600 x 500 | {rows[0]['free']:.2f} | {rows[0]['length_m']:,.0f} |" in tables(
        rows
    )
    for row in rows:
        assert row["coverage"] == 1.0
        assert row["length_m"] > row["sweep_m"]
        assert row["sweep_m"] + 30.0 * row["sweeps"] > row["free"] * 600.0 * 500.0 / 20.0
        assert row["turns"] > row["sweeps"] > 0
        assert row["overlap_m"] > 0.0
        assert row["duration_s"] > row["length_m"] / 10.0
    (ours,) = (row for row in rows if row["method"] == "auto")
    assert ours["length_m"] == min(row["length_m"] for row in rows)


def test_the_paper_and_both_its_baselines_are_there() -> None:
    """By the names that they are asked for."""
    assert {"majeed2019", "majeed2019-highs", "boustrophedon-cells", "coverage-alternatives"} <= set(METHODS)
