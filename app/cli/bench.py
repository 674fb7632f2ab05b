"""``swathplan bench``."""

from __future__ import annotations

import importlib
import inspect
import json
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, emit, say


class Benchmark(StrEnum):
    """Benchmarks by name."""

    SAR = "sar"
    SAR_SEARCH = "sar-search"
    SCALE = "scale"
    BOUND = "bound"
    LINK = "link"
    TRANSIT = "transit"
    SURVEY = "survey"
    QUALITY = "quality"
    KERNELS = "kernels"
    START = "start"
    ISOLATION = "isolation"
    READS = "reads"
    URBAN = "urban"
    VALIDATE = "validate"
    SEARCH = "search"
    ORIENTEERING = "orienteering"
    SMOOTHING = "smoothing"
    MILP = "milp"
    IMPORTANCE = "importance"
    VRPTW = "vrptw"
    SEPARATION = "separation"
    FLEET = "fleet"
    REPLAN = "replan"
    THREE = "three"


#: What each of them shows.
ABOUT = {
    Benchmark.SAR: "The SAR paper's four cases: ours, the paper's stages, zigzags",
    Benchmark.SAR_SEARCH: "How likely somebody at sea is found, beside manuals' patterns",
    Benchmark.SCALE: "Many regions and wide ones: seconds, memory, length, gap",
    Benchmark.BOUND: "Random scenarios: the gap of plans to their bound",
    Benchmark.LINK: "Uploads over loopback beside MAVSDK's client",
    Benchmark.TRANSIT: "Transits among 30 circles beside OMPL",
    Benchmark.SURVEY: "Camera surveys beside other programs', every photo looked at",
    Benchmark.QUALITY: "Image quality beside figures of other geometry",
    Benchmark.KERNELS: "Dubins lengths a second: compiled, numpy, OMPL",
    Benchmark.START: "The first plan of a service just started, beside a later one",
    Benchmark.ISOLATION: "Heartbeats and orders while every endpoint is kept busy",
    Benchmark.READS: "How long reads of a running service take",
    Benchmark.URBAN: "Coverage among obstacles: methods on twenty pinned maps",
    Benchmark.VALIDATE: "What judging large scenarios takes: time and memory",
    Benchmark.SEARCH: "Search on stored energy: ours beside the published horizon",
    Benchmark.ORIENTEERING: "The most reward within a budget, on a file of others",
    Benchmark.SMOOTHING: "Turns at a waypoint: how far each strays, how long it is",
    Benchmark.MILP: "Trajectories among threats by the printed program, beside ours",
    Benchmark.IMPORTANCE: "Importance on grids beside the published algorithm, and a bound",
    Benchmark.VRPTW: "Routing with time windows, on a file with its published cost",
    Benchmark.SEPARATION: "Whether aircraft of one plan come nearer than is to be kept",
    Benchmark.FLEET: "Who does what: the printed model and ours, small cases and large",
    Benchmark.REPLAN: "How soon a flight has a new plan",
    Benchmark.THREE: "Three simulated aircraft in the air, planned anew in the middle",
}


def _options(pairs: list[str]) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for pair in pairs:
        name, equals, text = pair.partition("=")
        if not equals:
            raise typer.BadParameter(f"{pair}: write it as name=value")
        try:
            value = json.loads(text)
        except json.JSONDecodeError:
            value = text
        options[name] = tuple(value) if isinstance(value, list) else value
    return options


def _accepted(name: str, run: Callable[..., Any], options: dict[str, Any]) -> None:
    """Refuse what a benchmark does not take, and the lack of what it needs."""
    taken = inspect.signature(run).parameters
    for option in options:
        if option not in taken:
            raise typer.BadParameter(f"{name} takes no {option}; it takes {', '.join(taken) or 'nothing'}")
    if "file" in taken and "file" not in options:
        raise typer.BadParameter(f"{name} needs a file: swathplan bench {name} FILE")


def _cell(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else "" if value is None else str(value)


def _table(rows: list[dict[str, Any]]) -> str:
    """Rows with the same columns under one head."""
    parts: list[str] = []
    columns: list[str] = []
    block: list[list[str]] = []

    def flush() -> None:
        if block:
            widths = [max(map(len, column)) for column in zip(columns, *block, strict=True)]
            for line in (columns, *block):
                parts.append("  ".join(c.ljust(w) for c, w in zip(line, widths, strict=True)).rstrip())
            parts.append("")
            block.clear()

    for row in rows:
        if list(row) != columns:
            flush()
            columns = list(row)
        block.append([_cell(value) for value in row.values()])
    flush()
    return "\n".join(parts)


def bench(
    name: Annotated[Benchmark, typer.Argument(help="Which benchmark.")],
    file: Annotated[
        Path | None,
        typer.Argument(help="Problem to solve, of benchmarks that take one.", exists=True, dir_okay=False),
    ] = None,
    budget: Annotated[float | None, typer.Option(help="Only this budget of the file.", min=0.0)] = None,
    seconds: Annotated[float | None, typer.Option(help="Time for each problem.", min=0.0)] = None,
    paths: Annotated[
        Path | None, typer.Option(help="Folder for the paths found.", file_okay=False, metavar="DIR")
    ] = None,
    option: Annotated[
        list[str] | None, typer.Option(help="Option of the benchmark, e.g. repeats=1.", metavar="NAME=VALUE")
    ] = None,
    as_json: Json = False,
) -> None:
    """Run a benchmark: a table, or JSON lines as they come with --json."""
    given = {"file": file, "budget": budget, "seconds": seconds, "paths": paths}
    options = _options(option or []) | {key: value for key, value in given.items() if value is not None}
    try:
        module = importlib.import_module(f"benchmarks.{name.value.replace('-', '_')}")
        no_problem: type[ValueError] = importlib.import_module("benchmarks.files").FileError
    except ModuleNotFoundError as error:
        raise CommandError(f"{error}; benchmarks run from the source tree with its dev extra") from error
    _accepted(name.value, module.run, options)
    rows: list[dict[str, Any]] = []
    try:
        for row in module.run(**options):
            if as_json:
                emit(json.dumps(row, ensure_ascii=False, default=str))
            else:
                say(f"{len(rows) + 1} rows …")
                rows.append(row)
    except no_problem as error:
        raise CommandError(str(error), Exit.BAD_INPUT) from error
    if not as_json:
        emit(_table(rows))


def register(cli: typer.Typer) -> None:
    """Add the command."""
    # After the mark lines are set as they stand.
    told = "\b\n" + "\n".join(f"{name.value:13}{ABOUT[name]}" for name in Benchmark)
    cli.command(epilog=told)(bench)
