"""Vehicle routing on public files."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.vrptw import run

#: Four customers on the corners of a rectangle round one depot, two vehicles of capacity 2.
FILE = """NAME: square
TYPE: VRPTW
EDGE_WEIGHT_TYPE: EUC_2D
DIMENSION: 5
VEHICLES: 2
CAPACITY: 2
NODE_COORD_SECTION
1 0 0
2 30 40
3 -30 40
4 30 -40
5 -30 -40
DEMAND_SECTION
1 0
2 1
3 1
4 1
5 1
SERVICE_TIME_SECTION
1 0
2 10
3 10
4 10
5 10
TIME_WINDOW_SECTION
1 0 1000
2 0 900
3 0 900
4 {window}
5 0 900
DEPOT_SECTION
1
-1
EOF
"""


@pytest.mark.parametrize(
    ("window", "cost"),
    [
        # Two loops over the short sides, 50 + 60 + 50 each.
        ("0 900", 320.0),
        # The fourth must be first of its loop and cannot be reached with another after 55 s but directly.
        ("50 55", 320.0),
    ],
)
def test_a_square_costs_its_two_loops(tmp_path: Path, window: str, cost: float) -> None:
    """The cost is PyVRP's measure of our routes, the gap that to the file beside it."""
    file = tmp_path / "square.vrp"
    file.write_text(FILE.format(window=window))
    file.with_suffix(".sol").write_text("Route #1: 1 2\nRoute #2: 3 4\nCost 320\n")
    (row,) = run(file, seconds=1.5, seeds=1)
    assert row["rounding"] in ("round", "dimacs", "exact", "trunc", "none")
    assert row["feasible"]
    assert row["cost"] == pytest.approx(cost)
    assert row["published"] == 320.0
    assert row["gap_percent"] == pytest.approx(0.0)


def test_what_the_search_does_not_know_is_refused(tmp_path: Path) -> None:
    """A file with what the tables have no words for says which."""
    file = tmp_path / "back.vrp"
    file.write_text(
        FILE.format(window="0 900").replace(
            "SERVICE_TIME_SECTION", "BACKHAUL_SECTION\n1 0\n2 1\n3 0\n4 0\n5 0\nSERVICE_TIME_SECTION"
        )
    )
    with pytest.raises(ValueError, match="pickups"):
        list(run(file, seconds=1.5, seeds=1))
