"""Vehicle routing on public files."""

from __future__ import annotations

from pathlib import Path

import pytest
from typer.testing import CliRunner

from app.cli.output import CommandError, Exit
from app.cli.root import cli
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


@pytest.mark.parametrize(
    ("seconds", "loading", "left"), [(60.0, 1.5, 57.5), (60.0, 40.0, 56.0), (2.0, 1.5, 1.0)]
)
def test_loading_counts_as_time_given(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seconds: float, loading: float, left: float
) -> None:
    """What the command took before is taken off the search, a compiler's time and more than half are not."""
    file = tmp_path / "square.vrp"
    file.write_text(FILE.format(window="0 900"))
    given: list[float] = []

    def solve(name: str, solver: str, seed: int, deadline: float) -> tuple[float, float, bool, int]:
        given.append(deadline)
        return 320.0, 320.0, True, 1

    monkeypatch.setattr("benchmarks.vrptw._solve", solve)
    monkeypatch.setattr("benchmarks.vrptw.time.process_time", lambda: loading)
    monkeypatch.setattr("benchmarks.vrptw.time.time", lambda: 100.0)
    list(run(file, seconds=seconds, seeds=1))
    assert given == [100.0 + left]


@pytest.mark.parametrize("name", ["vrptw", "orienteering"])
@pytest.mark.parametrize("text", [b"hello\n", b"\x00\xff\x01", b"", b"NAME: a\nDIMENSION: x\n"])
def test_a_file_of_something_else_is_bad_input(tmp_path: Path, name: str, text: bytes) -> None:
    """The command says which file and why, and exits with 2."""
    file = tmp_path / "odd.vrp"
    file.write_bytes(text)
    result = CliRunner().invoke(cli, ["bench", name, str(file), "--seconds", "1", "--json"])
    assert isinstance(result.exception, CommandError)
    assert result.exception.code == Exit.BAD_INPUT
    assert "odd.vrp" in str(result.exception)
