"""``swathplan audit``: what a service ordered of its vehicles."""

from __future__ import annotations

import json
from typing import Annotated, Any

import typer

from app.cli.asking import DEFAULT_SERVICE, Service, asked
from app.cli.output import Json, Output, emit, emit_json


def audit(
    service: Service = DEFAULT_SERVICE,
    vehicle: Annotated[str | None, typer.Option(help="Of one vehicle: its id, or its name.")] = None,
    kind: Annotated[
        str | None, typer.Option(help="order, upload, clear, override, acknowledgement or signing.")
    ] = None,
    since: Annotated[str | None, typer.Option(help="At or after, e.g. 2026-05-04T08:00Z.")] = None,
    until: Annotated[str | None, typer.Option(help="Before.")] = None,
    limit: Annotated[int, typer.Option(min=1, max=1000, help="No more than so many, the newest.")] = 50,
    output: Output = "-",
    as_json: Json = False,
) -> None:
    """List what was ordered of vehicles, by whom, and what became of it, newest first."""
    filters = {"vehicle": vehicle, "kind": kind, "since": since, "until": until, "limit": limit}
    given = {name: value for name, value in filters.items() if value is not None}
    found = asked(service, "GET", "audit", given)
    if as_json:
        emit_json(found, output)
        return
    emit("\n".join(map(_line, found["entries"])) or "nothing was ordered", output)


def _line(entry: dict[str, Any]) -> str:
    what = " ".join(f"{name}={_word(value)}" for name, value in entry["what"].items() if value is not None)
    reason = f" ({entry['reason']})" if entry["reason"] else ""
    return (
        f"{entry['at'][:19]}Z {entry['actor']} {entry['vehicle_name']} {entry['kind']} {what}: "
        f"{entry['outcome']}{reason}"
    )


def _word(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(audit)
