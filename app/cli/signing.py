"""``swathplan signing``."""

from __future__ import annotations

import os
import secrets
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from app.cli.keyring import signing_here, signing_in
from app.cli.missions import Timeout, run_async
from app.cli.output import CommandError, Exit, Json, emit_json, say


class Action(StrEnum):
    """What is to become of signing."""

    NEW = "new"
    SET_UP = "set-up"
    REMOVE = "remove"


def signing(
    action: Annotated[
        Action,
        typer.Argument(
            help="new: make a key. set-up: hand it to a vehicle. remove: have the vehicle sign no more."
        ),
    ],
    to: Annotated[
        str | None, typer.Option(help="With set-up and remove: link address of the vehicle.", metavar="URL")
    ] = None,
    name: Annotated[
        str, typer.Option(help="The vehicle's name among the keys; the key of all when left out.")
    ] = "",
    output: Annotated[
        str | None,
        typer.Option("-o", help="With new: file to write, which must not be there.", metavar="FILE"),
    ] = None,
    in_use: Annotated[
        Path | None,
        typer.Option(
            help="With set-up: file with the key that the vehicle signs with by now; the next is handed over"
            " signed with it.",
            metavar="FILE",
        ),
    ] = None,
    timeout_s: Timeout = 10.0,
    as_json: Json = False,
) -> None:
    """Keys of MAVLink 2 signing: make one, hand it to a vehicle, have the vehicle sign no more.

    Keys are read from the file in SWATHPLAN_SIGNING_KEYS and from SWATHPLAN_SIGNING_KEY, and never printed.
    The first one goes to the vehicle unsigned: over a link that nobody else hears, best by USB. Vehicles take
    keys while they are disarmed. To replace a key, name the file that has the one in use: --in-use.
    """
    if action is Action.NEW:
        if output is None:
            raise CommandError("new needs -o FILE: a key is never printed", Exit.BAD_INPUT)
        _write(Path(output), name or "*")
        say(f"A new key stands in {output}; set SWATHPLAN_SIGNING_KEYS={output}")
    else:
        if to is None:
            raise CommandError(f"{action.value} needs --to URL", Exit.BAD_INPUT)
        if in_use is not None and action is Action.REMOVE:
            raise CommandError(
                "--in-use goes with set-up: remove is signed with the key given", Exit.BAD_INPUT
            )
        run_async(_change(action, to, name, timeout_s, in_use))
        say("The vehicle signs with the key." if action is Action.SET_UP else "The vehicle signs no more.")
    if as_json:
        emit_json({"action": action.value, "file": output, "done": True})


def _write(path: Path, name: str) -> None:
    """A file with one key that only its owner reads."""
    try:
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(descriptor, "w", encoding="ascii") as out:
            out.write(f"{name} = {secrets.token_hex(32)}\n")
    except OSError as error:
        raise CommandError(f"{path}: {error.strerror}") from error


async def _change(action: Action, url: str, name: str, timeout_s: float, in_use: Path | None) -> None:
    from app.services.vehicles.connection import connected

    ours = signing_here(url, name)
    if ours is None:
        message = "no key is given: set SWATHPLAN_SIGNING_KEYS or SWATHPLAN_SIGNING_KEY"
        raise CommandError(message, Exit.BAD_INPUT)
    known = ours if action is Action.REMOVE else None
    if in_use is not None:
        known = signing_in(in_use, name)
        if known is None:
            message = f"{in_use} has no key of {name or 'all vehicles (*)'}: it is to have the one in use"
            raise CommandError(message, Exit.BAD_INPUT)
    async with connected(url, None, timeout_s, known) as client:
        if action is Action.REMOVE:
            await client.stop_signing()
        else:
            await client.set_up_signing(ours)


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(signing)
