"""What the benchmark of replanning tells is of a plan that sees what is left."""

from __future__ import annotations

from benchmarks.replan import run


def test_a_row_is_of_a_sound_plan() -> None:
    """Fewer regions than at first are left, all of them seen, nothing hard broken."""
    (row,) = run(regions=5, repeats=1)
    assert 1 <= row["left"] < 6
    assert row["hard_violations"] == 0
    assert row["least_coverage"] > 0.9999
    assert row["seconds"] > 0.0
