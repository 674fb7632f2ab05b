"""``swathplan fill``: gaps of a flight's record, filled from an onboard log."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.asking import DEFAULT_SERVICE, Service, asked
from app.cli.output import Json, Output, emit, emit_json, read_bytes


def fill(
    flight: Annotated[str, typer.Argument(help="The flight's id.", metavar="FLIGHT")],
    log: Annotated[str, typer.Argument(help=".bin, .ulg or .tlog; - is standard input.", metavar="LOG")],
    service: Service = DEFAULT_SERVICE,
    output: Output = "-",
    as_json: Json = False,
) -> None:
    """Fill what was not recorded of a flight from a log that the vehicle kept, or another recording."""
    told = asked(
        service,
        "POST",
        f"flights/{flight}/log",
        {"name": Path(log).name},
        content=read_bytes(log),
        timeout_s=300.0,
    )
    if as_json:
        emit_json(told, output)
        return
    lines = [f"{len(told['filled'])} gaps filled with {told['points']} places, {told['photos']} photos"]
    lines += [f"left: {_span(span)}: {span['why']}" for span in told["left"]]
    emit("\n".join(lines), output)


def _span(span: dict[str, Any]) -> str:
    return (
        f"{span['start_s']:.1f} s to {'the end' if span['end_s'] is None else format(span['end_s'], '.1f')}"
    )


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(fill)
