"""The documents say what is so: figures name their command, commands are there, and print what is written."""

from __future__ import annotations

import importlib.util
import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.main import get_command

from app.cli.bench import Benchmark
from app.cli.root import cli
from benchmarks import coverage, sar, scale, table, transit

ROOT = Path(__file__).parents[2]
PAGES = (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")))
NAMES = [page.name for page in PAGES]

#: What is run to print something: as code in a line, or in a block.
COMMAND = re.compile(r"(?:swathplan|pytest|python -m) [^`\n]+|make [a-z][a-z0-9-]*")
#: A cell that is a quantity: a number with or without a unit, or several.
FIGURE = re.compile(
    r"[≤≥<>~−-]?\d[\d.,]*(?: ?(?:%|m|s|ms|km|MB|m/s|of|and|·|/|–)(?: .*)?)?$|[\d.,]+–[\d.,]+ m$"
)
#: Lengths follow small changes of the planner; a table older than this is out of date.
OLD = 0.01


def sections(text: str) -> Iterator[tuple[str, str]]:
    """Each section's heading, and its own text with that of the sections it lies in, before their parts."""
    above: list[tuple[int, str]] = []
    for part in re.split(r"^(?=#{1,6} )", text, flags=re.MULTILINE):
        level = len(part) - len(part.lstrip("#"))
        above = [(depth, own) for depth, own in above if depth < level]
        above.append((level, part))
        yield part.split("\n")[0], "\n".join(own for _, own in above)


def rows(text: str) -> list[list[str]]:
    """Cells of all table rows, rulers left out."""
    lines = [line for line in text.split("\n") if line.startswith("|")]
    found = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
    return [cells for cells in found if not all(set(cell) <= set("-: ") and cell for cell in cells)]


def is_of_figures(text: str) -> bool:
    """Whether a section has a table of figures: two rows or more with a quantity in them."""
    return sum(any(FIGURE.match(cell) for cell in cells) for cells in rows(text)) >= 2


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_tables_of_figures_name_the_command_that_prints_them(page: Path) -> None:
    """A section with a table of figures, or one that it lies in, says what to run."""
    for (heading, whole), own in zip(
        sections(page.read_text()),
        re.split(r"^(?=#{1,6} )", page.read_text(), flags=re.MULTILINE),
        strict=True,
    ):
        assert not is_of_figures(own) or COMMAND.search(whole), f"{page.name}: {heading}"


def test_there_are_tables_of_figures() -> None:
    """The rule above has something to hold: the pages of figures are found by it."""
    found = {
        page.name
        for page in PAGES
        for own in re.split(r"^(?=#{1,6} )", page.read_text(), flags=re.MULTILINE)
        if is_of_figures(own)
    }
    assert found >= {"benchmarks.md", "ardupilot.md", "px4.md", "multirotor.md"}


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_commands_named_are_there(page: Path) -> None:
    """Every command, benchmark, test file, module and make target that a page names exists."""
    commands = get_command(cli).commands  # type: ignore[attr-defined]
    targets = set(re.findall(r"^([a-z][a-z0-9-]*):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE))
    for found in COMMAND.findall(page.read_text()):
        words = found.split()
        if words[0] == "swathplan" and re.fullmatch(r"[a-z]+", words[1]):
            assert words[1] in commands, found
            if words[1] == "bench":
                named = [word for word in words[2].split("|") if re.fullmatch(r"[a-z]+", word)]
                assert set(named) <= {each.value for each in Benchmark}, found
        elif words[0] == "pytest":
            for word in words[1:]:
                assert not word.startswith("tests/") or (ROOT / word.rstrip(".,:;)")).exists(), found
        elif words[0] == "python":
            name = words[2].rstrip(".,:;)")
            assert importlib.util.find_spec(name) is not None, found
        elif (
            words[0] == "make" and "make " + words[1] in page.read_text() and f"`{found}" in page.read_text()
        ):
            assert words[1] in targets, found


def benchmark_rows(heading: str) -> list[list[str]]:
    """Rows of a section of the page of benchmarks."""
    text = (ROOT / "docs" / "benchmarks.md").read_text()
    (part,) = re.findall(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, flags=re.DOTALL | re.MULTILINE)
    return rows(part)


def number(cell: str) -> float:
    return float(cell.replace(",", ""))


def test_the_paper_s_first_case_is_as_its_command_prints() -> None:
    """Lengths, coverage, turns and risks of case 1, and the nodes searched, are those of ``bench sar``."""
    printed = rows(table.tables(list(sar.run(cases=(1,), repeats=1))))
    written = {tuple(cells[:2]): cells for cells in benchmark_rows("The SAR paper's four cases")}
    plans = [cells for cells in printed if cells[0] == "1"]
    assert len(plans) == 4
    for cells in plans:
        told = written[tuple(cells[:2])]
        assert cells[5:8] == told[5:8]
        for column in (2, 3, 4, 8, 9, 10):
            if cells[column]:
                assert number(told[column]) == pytest.approx(number(cells[column]), rel=OLD, abs=1.0), told
    nodes = [cells for cells in printed if re.fullmatch(r"s\d", cells[0])]
    assert nodes
    for cells in nodes:
        told = next(row for row in benchmark_rows("The SAR paper's four cases") if row[0] == cells[0])
        assert number(told[1]) == pytest.approx(number(cells[1]), rel=OLD)


def test_the_first_of_many_regions_is_as_its_command_prints() -> None:
    """Length, gap and violations of the smallest are those of ``bench scale``."""
    row = scale._row(12, 12, 0, 1)
    head, told = benchmark_rows("Many regions")[:2]
    cells = dict(zip(head, told, strict=True))
    assert cells["regions / threats"] == "12 / 12"
    assert number(cells["length, km"]) == pytest.approx(row["length_m"] / 1000.0, rel=OLD)
    assert number(cells["gap to the bound, %"]) == pytest.approx(100.0 * row["gap"], abs=1.0)
    assert number(cells["violations"]) == row["violations"]


def test_ways_to_see_are_as_their_command_prints(capsys: pytest.CaptureFixture[str]) -> None:
    """What the page on coverage quotes of ``python -m benchmarks.coverage`` is what that prints."""
    coverage.main()
    printed = capsys.readouterr().out
    page = (ROOT / "docs" / "coverage.md").read_text()
    quoted = page.split("`python -m benchmarks.coverage` prints")[1].split("\n\n")[1]
    lines = [line.strip() for line in quoted.split("\n")]
    assert len(lines) == len(printed.splitlines()) > 2
    for told, line in zip(lines, printed.splitlines(), strict=True):
        assert re.sub(r"[\d.]+", "#", told) == re.sub(r"[\d.]+", "#", line)
        for one, other in zip(re.findall(r"\d[\d.]*", told), re.findall(r"\d[\d.]*", line), strict=True):
            assert float(one) == pytest.approx(float(other), rel=OLD)


def test_transits_solved_are_as_their_command_prints() -> None:
    """How many problems are solved is that of ``bench transit``."""
    written = {cells[0]: cells for cells in benchmark_rows("Transits")}
    for row in transit.run(seconds=0.0, repeats=1):
        if row["planner"] == "tangent":
            assert written[row["set"]][2] == f"{row['solved']} of {row['problems']}"


def test_examples_of_json_in_the_documents_are_json() -> None:
    """Blocks marked as JSON parse."""
    for page in PAGES:
        for block in re.findall(r"```json\n(.*?)```", page.read_text(), flags=re.DOTALL):
            json.loads(block)
