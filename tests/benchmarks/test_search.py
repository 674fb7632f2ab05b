"""The benchmark of searches: its random ones come home, and its rows are there."""

from __future__ import annotations

from functools import partial

import pytest

from benchmarks import search
from benchmarks.search import run
from benchmarks.search_scenarios import random_search
from planner.geojson import read_scenario
from planner.search import refine


def test_random_searches_come_home() -> None:
    """A sample of them: none over its energy or in a zone, each judged; the last row counts them."""
    *rows, total = run(random=2, seed=1)
    assert [row["home"] for row in rows] == [True] * 2
    assert total["home"] == total["searches"] == 2
    for row in rows:
        assert row["energy_wh"] <= row["usable_wh"]
        assert 0.0 < row["seen"] <= 1.0


@pytest.mark.parametrize("seed", range(200))
def test_each_random_search_is_a_scenario(seed: int) -> None:
    """None is refused when it is read."""
    assert read_scenario(random_search(seed)).task == "search"


def test_the_paper_s_case_has_a_row_for_each_variant(monkeypatch: pytest.MonkeyPatch) -> None:
    """``auto`` first, here refined but a little, then each variant at each turn duration and in the mean."""
    monkeypatch.setattr(search, "auto", partial(refine.auto, rounds=((64, 20), (2, 200))))
    rows = search.run(turns_s=(8.0,))
    first = next(rows)
    assert first["method"] == "auto"
    assert first["exit_off_m"] < 5.0
    assert 0.0 <= first["energy_left"] <= 1.0
    assert [(row["method"].removeprefix("energy-horizon"), row["turn_s"]) for row in rows] == [
        (name, turn_s) for name in ("", "-discrete", "-no-decision", "-time") for turn_s in (8.0, "mean")
    ]
