"""``swathplan fill``: gaps of a flight's record, filled from an onboard log."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, Output, emit, emit_json, read_bytes


def fill(
    flight: Annotated[str, typer.Argument(help="The flight's id.", metavar="FLIGHT")],
    log: Annotated[str, typer.Argument(help=".bin, .ulg or .tlog; - is standard input.", metavar="LOG")],
    service: Annotated[
        str, typer.Option(help="Address of the service.", metavar="URL")
    ] = "http://127.0.0.1:8000",
    output: Output = "-",
    as_json: Json = False,
) -> None:
    """Fill what was not recorded of a flight from a log that the vehicle kept, or another recording."""
    told = _sent(service, flight, Path(log).name, read_bytes(log))
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


def _sent(service: str, flight: str, name: str, data: bytes) -> dict[str, Any]:
    """The service's answer."""
    import httpx

    try:
        url = f"{service.rstrip('/')}/api/v1/flights/{flight}/log"
        answer = httpx.post(url, params={"name": name}, content=data, timeout=300.0)
        body: dict[str, Any] = answer.json()
    except (httpx.HTTPError, httpx.InvalidURL, json.JSONDecodeError) as error:
        raise CommandError(
            f"no service answers at {service}: {error or type(error).__name__}; start it, or give --service"
        ) from error
    if answer.status_code == 422:
        raise CommandError(str(body["detail"]), Exit.BAD_INPUT)
    if answer.status_code != 200:
        raise CommandError(str(body.get("detail", answer.status_code)))
    return body


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(fill)
