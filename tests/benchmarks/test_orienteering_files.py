"""Files of orienteering problems are read as their formats say."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.files import FileError
from benchmarks.orienteering import run
from benchmarks.orienteering_files import OplibProblem, budget_name, read

#: TSPLIB's burma14 and the length of its best tour there, 3323.
BURMA = """16.47 96.10 16.47 94.44 20.09 92.54 22.39 93.37 25.23 97.24 22.00 96.05 20.47 97.02 17.20 96.29
16.30 97.38 14.05 98.12 16.53 97.38 21.52 95.59 19.41 97.13 20.09 94.55"""
BURMA_TOUR = (1, 2, 14, 3, 4, 5, 6, 12, 7, 13, 8, 11, 9, 10)


def _written(
    folder: Path, kind: str, points: list[list[float]], more: str = "", limit: float = 100.0
) -> Path:
    path = folder / "some.oplib"
    coordinates = "\n".join(f"{k + 1} {x} {y}" for k, (x, y) in enumerate(points))
    scores = "\n".join(f"{k + 1} {0 if k == 0 else k}" for k in range(len(points)))
    path.write_text(
        f"NAME : some\nCOMMENT : 3 places (of: nobody)\nTYPE : OP\nDIMENSION : {len(points)}\n"
        f"COST_LIMIT : {limit}\nEDGE_WEIGHT_TYPE: {kind}\n{more}NODE_COORD_SECTION\n{coordinates}\n"
        f"NODE_SCORE_SECTION\n{scores}\nDEPOT_SECTION\n1\n-1\nEOF\n"
    )
    return path


def _oplib(path: Path) -> OplibProblem:
    found = read(path)
    assert isinstance(found, OplibProblem)
    return found


@pytest.mark.parametrize(
    ("kind", "metres"),
    [("EUC_2D", 3), ("CEIL_2D", 3), ("MAN_2D", 4), ("MAX_2D", 2), ("ATT", 1)],
)
def test_distances_in_the_plane(tmp_path: Path, kind: str, metres: int) -> None:
    """√(2.1² + 1.6²) = 2.64 is rounded as each kind does; ATT divides the square by ten: 0.83."""
    assert _oplib(_written(tmp_path, kind, [[0.0, 0.0], [2.1, 1.6]])).distances[0, 1] == metres


def test_ceilings_are_no_roundings(tmp_path: Path) -> None:
    """√(2² + 1²) = 2.24 is 2 rounded, 3 as a ceiling; ATT's 0.71 is 1, its 5.6 of 17.7 is 6."""
    found = {
        kind: _oplib(_written(tmp_path, kind, [[0.0, 0.0], [2.0, 1.0], [17.0, 5.0]])).distances
        for kind in ("EUC_2D", "CEIL_2D", "ATT")
    }
    assert [found[kind][0, 1] for kind in ("EUC_2D", "CEIL_2D", "ATT")] == [2, 3, 1]
    assert found["ATT"][0, 2] == 6


def test_distances_on_the_globe(tmp_path: Path) -> None:
    """The best tour of burma14 is as long as TSPLIB says."""
    numbers = [float(word) for word in BURMA.split()]
    points = [list(pair) for pair in zip(numbers[::2], numbers[1::2], strict=True)]
    distances = _oplib(_written(tmp_path, "GEO", points)).distances
    tour = [place - 1 for place in BURMA_TOUR]
    assert sum(distances[a, b] for a, b in zip(tour, [*tour[1:], tour[0]], strict=True)) == 3323


@pytest.mark.parametrize(
    ("form", "numbers"),
    [
        ("FULL_MATRIX", "0 1 2\n1 0 3\n2 3 0"),
        ("UPPER_ROW", "1 2 3"),
        ("LOWER_ROW", "1 2\n3"),
        ("UPPER_DIAG_ROW", "0 1 2 0 3 0"),
        ("LOWER_DIAG_ROW", "0 1 0 2 3 0"),
        ("UPPER_COL", "1 2 3"),
        ("LOWER_COL", "1 2 3"),
        ("UPPER_DIAG_COL", "0 1 0 2 3 0"),
        ("LOWER_DIAG_COL", "0 1 2 0 3 0"),
    ],
)
def test_explicit_distances(tmp_path: Path, form: str, numbers: str) -> None:
    """Each way to write a matrix gives the same one."""
    path = _written(
        tmp_path,
        "EXPLICIT",
        [[0.0, 0.0]] * 3,
        f"EDGE_WEIGHT_FORMAT: {form}\nEDGE_WEIGHT_SECTION\n{numbers}\n",
    )
    assert _oplib(path).distances.tolist() == [[0, 1, 2], [1, 0, 3], [2, 3, 0]]


@pytest.mark.parametrize("text", ["", "{}", "NAME : x\nDIMENSION : 2\n", "1 2 3", "[]"])
def test_no_problem(tmp_path: Path, text: str) -> None:
    """What is no such file is refused by name."""
    path = tmp_path / "odd.oplib"
    path.write_text(text)
    with pytest.raises(FileError, match=r"odd\.oplib"):
        read(path)


def test_row_of_an_oplib_file(tmp_path: Path) -> None:
    """The row's route is closed, within the limit, and of the reward it says; the path is dense."""
    points = [[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [60.0, 60.0]]
    path = _written(tmp_path, "EUC_2D", points, limit=12.0)
    path.with_suffix(".sol").write_text("ROUTE_SCORE : 3\n")
    (row,) = run(path, seconds=1.0, paths=tmp_path / "out")
    assert row["reward"] == row["published_best"] == 3.0
    assert row["length"] == 12.0
    assert sorted(row["route"][1:-1]) == [2, 3]
    assert row["route"][0] == row["route"][-1] == 1
    line = np.array(json.loads((tmp_path / "out" / "some-12.json").read_text()))
    assert np.hypot(*np.diff(line, axis=0).T).max() <= 1.0 + 1e-9
    assert line[0].tolist() == line[-1].tolist() == [0.0, 0.0]
    (row,) = run(path, budget=6.0, seconds=1.0)
    assert row["reward"] == 1.0
    assert row["published_best"] is None


def test_rows_of_polygons(tmp_path: Path) -> None:
    """A row for each budget that is published for the turn radius; paths go from start to end."""
    sheet = {
        "border": [[-500, -500], [1500, -500], [1500, 500], [-500, 500]],
        "obstacles": [[[400, -100], [600, -100], [600, 100], [400, 100]]],
        "start": [0, 0],
        "end": [1000, 0],
        "targets": [{"at": [500, 150], "reward": 3}, {"at": [500, -400], "reward": 4}],
        "published": [
            {"model": model, "turn_radius": radius, "budget": budget, "reward_best": 3, "reward_mean": 2.5}
            for model, radius in (("dubins", 60), ("straight", 0))
            for budget in (1100.0, 1300.0)
        ],
    }
    path = tmp_path / "toy.json"
    path.write_text(json.dumps(sheet))
    rows = list(run(path, seconds=0.5, paths=tmp_path, threads=1))
    assert [(row["model"], row["budget"], row["reward"]) for row in rows] == [
        ("dubins", 1100.0, 3.0),
        ("dubins", 1300.0, 4.0),
    ]
    assert all((row["published_best"], row["published_mean"]) == (3.0, 2.5) for row in rows)
    for row in rows:
        line = np.array(json.loads((tmp_path / f"toy-{int(row['budget'])}.json").read_text()))
        assert np.hypot(*np.diff(line, axis=0).T).sum() <= row["length"] <= row["budget"]
        assert (line[0].tolist(), line[-1].tolist()) == ([0.0, 0.0], [1000.0, 0.0])
    (straight,) = run(path, budget=1100.0, seconds=0.5, turn_radius=0.0, threads=1)
    assert straight["model"] == "straight"
    assert straight["length"] < rows[0]["length"]
    (none,) = run(path, budget=900.0, seconds=0.5, threads=1)
    assert (none["reward"], none["length"]) == (0.0, None)


def test_names_of_budgets() -> None:
    """Whole budgets are named without a fraction."""
    assert (budget_name(1500.0), budget_name(0.5), budget_name(math.pi)) == ("1500", "0.5", repr(math.pi))
