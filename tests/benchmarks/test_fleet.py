"""Model and search of fleets side by side, at scale."""

from __future__ import annotations

from benchmarks.fleet import run


def test_model_and_auto_agree_wherever_the_model_closes() -> None:
    """On a sample of the random cases the costs are the same, and the model never has the better one."""
    (row,) = run(cases=3, seconds=5.0, scale=False)
    assert row["closed"] >= 1
    assert row["agreed"] == row["closed"]
    assert row["auto_beaten"] == 0
