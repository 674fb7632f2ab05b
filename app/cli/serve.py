"""``swathplan serve``."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, emit, read_document, say


def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on (127.0.0.1 when left out).")] = None,
    port: Annotated[
        int | None, typer.Option(help="Port to listen on (8000 when left out); 0 takes a free one.")
    ] = None,
    database: Annotated[
        str | None, typer.Option(help="Database file (var/swathplan.db when left out).")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Planning processes (cores - 1 when left out).")] = None,
    sim: Annotated[bool, typer.Option("--sim", help="Connect a simulated aircraft at the start.")] = False,
    sim_count: Annotated[int, typer.Option(min=1, max=16, help="How many with --sim.")] = 1,
    sim_url: Annotated[
        str, typer.Option(help="What the simulated aircraft are, e.g. sim:?autopilot=px4&speedup=10.")
    ] = "sim:",
    vehicle: Annotated[
        str | None,
        typer.Option(help="Connect the vehicle at this address, unless it is known already.", metavar="URL"),
    ] = None,
    forward: Annotated[
        list[str] | None,
        typer.Option(
            help="Let another ground station watch that vehicle, or the simulated aircraft: "
            "udpout:127.0.0.1:14550, udpin:…, tcpin:… May be repeated.",
            metavar="URL",
        ),
    ] = None,
    forward_write: Annotated[
        list[str] | None,
        typer.Option(help="The same, and let it command the vehicle, too.", metavar="URL"),
    ] = None,
    scenario: Annotated[
        str | None, typer.Option(help="Plan this scenario at the start.", metavar="FILE")
    ] = None,
    keep_links: Annotated[
        bool,
        typer.Option(
            "--keep-links",
            help="Let the process that holds the links to the vehicles go on when this command ends. It does "
            "so anyway while a vehicle is armed; the next serve finds it again.",
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Serve the map and the HTTP interface.

    Further settings come from environment variables with the prefix SWATHPLAN_; docs/settings.md lists them.
    """
    from pydantic import ValidationError

    from app.settings import Settings, unknown_variables

    given: dict[str, Any] = {"host": host, "port": port, "database": database, "workers": workers}
    document = None if scenario is None else read_document(scenario)
    try:
        settings = Settings(**{name: value for name, value in given.items() if value is not None})
    except ValidationError as error:
        reasons = "; ".join(
            f"{'.'.join(map(str, entry['loc'])) or 'settings'}: {entry['msg']}" for entry in error.errors()
        )
        raise CommandError(reasons, Exit.BAD_INPUT) from error

    for variable in unknown_variables():
        say(f"warning: {variable} is no setting and does nothing; docs/settings.md lists them")
    _check_wishes(document, settings.database, sim_url)
    forwards = [(url, False) for url in forward or ()] + [(url, True) for url in forward_write or ()]
    _check_vehicle(vehicle, forwards, sim_count if sim else 0)

    # What the service writes is for its own user: recordings, rasters, sockets.
    os.umask(0o077)
    from app.server import StartError, Welcome, run_apart

    welcome = Welcome(
        simulated=sim_count if sim else 0,
        sim_url=sim_url,
        scenario=document,
        vehicle=vehicle,
        forward=tuple(forwards),
    )

    def announce(address: str) -> None:
        emit(f'{{"address": "{address}"}}' if as_json else f"Swathplan is at {address}")

    try:
        run_apart(settings, welcome, announce, keep_links=keep_links)
    except StartError as error:
        raise CommandError(str(error)) from error


def _check_wishes(scenario: dict[str, Any] | None, database: Path, sim_url: str) -> None:
    """Refuse before anything is started what would be refused afterwards, where nobody looks."""
    from app.services.errors import RefusedError
    from app.services.scenarios.validation import judge
    from app.services.terrain.ground import terrain_folder
    from app.services.vehicles.connection import simulated_of

    try:
        if simulated_of(sim_url) is None:
            raise CommandError(
                f"--sim-url {sim_url} is not the address of a simulated aircraft", Exit.BAD_INPUT
            )
    except RefusedError as error:
        raise CommandError(f"--sim-url: {error}", Exit.BAD_INPUT, error.findings) from error
    if scenario is not None:
        verdict = judge(scenario, str(terrain_folder(database)))
        if verdict.errors:
            raise CommandError("the scenario is refused", Exit.BAD_INPUT, verdict.errors)


def _check_vehicle(vehicle: str | None, forwards: list[tuple[str, bool]], simulated: int) -> None:
    """The same for a vehicle and where it is forwarded to."""
    from app.services.errors import RefusedError
    from app.services.vehicles.connection import is_replay, simulated_of
    from app.services.vehicles.forwarding import read_forwards, refuse_loops
    from mavlink.errors import AddressError
    from mavlink.links.link import parse_address

    try:
        if vehicle is not None and simulated_of(vehicle) is None and not is_replay(vehicle):
            parse_address(vehicle)
        addresses = read_forwards(forwards, replay=vehicle is not None and is_replay(vehicle))
        refuse_loops([] if vehicle is None else [vehicle], addresses)
    except RefusedError as error:
        raise CommandError(str(error), Exit.BAD_INPUT, error.findings) from error
    except AddressError as error:
        raise CommandError(f"--vehicle: {error}", Exit.BAD_INPUT) from error
    if forwards and vehicle is None and simulated != 1:
        raise CommandError(
            "--forward needs one vehicle to forward: give --vehicle, or --sim with one aircraft",
            Exit.BAD_INPUT,
        )


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(serve)
