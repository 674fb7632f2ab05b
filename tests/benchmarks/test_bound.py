"""What random scenarios say together is what each of them says."""

from __future__ import annotations

import itertools
from typing import Any

import pytest

from benchmarks import bound
from benchmarks.bound import summaries


def row(kind: str, gap: float, in_a_third: float, *, below: bool = False) -> dict[str, Any]:
    """A row of a scenario that took three seconds to plan and one for its share of the bound."""
    return {
        "kind": kind,
        "gap": gap,
        "gap_in_a_third": in_a_third,
        "below_collection": below,
        "is_a_bound": True,
        "planned_s": 3.0,
        "share_s": 1.0,
    }


def test_kinds_and_all_are_summed_up_from_their_rows() -> None:
    """Medians, most and counts are those of the rows, kind by kind and of all."""
    rows = [
        row("points", 0.1, 0.2),
        row("wide", 0.4, 0.6, below=True),
        row("points", 0.3, 0.3),
        row("wide", 0.55, 0.7),
    ]
    points, wide, everything = summaries(rows)
    assert [found["kind"] for found in (points, wide, everything)] == ["points", "wide", "all"]
    assert (points["gap"], points["most_gap"], points["most_in_a_third"]) == (0.2, 0.3, 0.3)
    assert (wide["over_half"], wide["over_half_in_a_third"], wide["below_collection"]) == (1, 2, 1)
    assert (everything["scenarios"], everything["over_half"], everything["most_in_a_third"]) == (4, 1, 0.7)
    assert everything["are_bounds"]
    assert (everything["part_of_time"], everything["most_of_time"]) == (0.25, 0.25)
    assert not list(summaries([*rows, row("bent", 0.1, 0.1) | {"is_a_bound": False}]))[-1]["are_bounds"]


def test_time_ends_a_run_between_scenarios_and_all_kinds_have_their_turn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """With a second of processor time for each scenario, five of them are told of, the kinds in turn."""
    now = itertools.count()
    monkeypatch.setattr(bound, "warm_up", lambda: None)
    monkeypatch.setattr(bound, "_row", lambda kind, seed, _: row(kind, 0.1, 0.1) | {"seed": seed})
    monkeypatch.setattr(bound.time, "process_time", lambda: float(next(now)))
    rows = list(bound.run(seeds=7, kinds=("points", "wide", "bent"), seconds=5.0))
    told = [(each["kind"], each["seed"]) for each in rows if "seed" in each]
    assert told == [("points", 0), ("wide", 0), ("bent", 0), ("points", 1), ("wide", 1), ("bent", 1)]
    assert rows[-1]["scenarios"] == len(told)
