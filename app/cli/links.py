"""``swathplan links``."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Json, emit, emit_json


def links(
    database: Annotated[
        str | None, typer.Option(help="Database file (var/swathplan.db when left out).")
    ] = None,
    end: Annotated[
        bool, typer.Option("--end", help="End the process, also while a vehicle is armed: its link closes.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Tell of the process that holds the links to the vehicles, or end it.

    `swathplan serve` starts it and finds it again. It outlives a service that dies, and one that is ended
    while a vehicle is armed: heartbeats, recordings and flights go on.
    """
    from app.settings import Settings

    path = Settings().database if database is None else Path(database)
    found = asyncio.run(_ended(path) if end else _told(path))
    if as_json:
        emit_json(found)
    elif found["pid"] is None:
        emit(f"No process holds links of {path}.")
    else:
        in_use = f", in use: {', '.join(found['in_use'])}" if found["in_use"] else ""
        done = "has been ended" if end else "holds the links"
        emit(f"Process {found['pid']} {done} of {found['vehicles']} vehicles{in_use}.")


async def _told(database: Path) -> dict[str, Any]:
    from app.services.errors import LinkError
    from app.services.links.client import LinksClient
    from app.services.links.place import place_of

    place = place_of(database)
    holder = place.holder()
    if holder is None:
        return {"pid": None, "version": None, "vehicles": 0, "in_use": []}
    client = LinksClient(place.links)
    try:
        state = await client.state()
    except LinkError as error:
        raise CommandError(f"process {holder.pid}: {error}") from error
    finally:
        await client.close()
    return {
        "pid": holder.pid,
        "version": holder.version,
        "vehicles": state.vehicles,
        "in_use": list(state.in_use),
    }


async def _ended(database: Path) -> dict[str, Any]:
    from app.services.links.keeper import end_holder
    from app.services.links.place import place_of

    found = await _told(database)
    if found["pid"] is not None:
        await end_holder(place_of(database))
    return found


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(links)
