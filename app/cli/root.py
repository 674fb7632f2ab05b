"""All commands under one name."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from app.cli import (
    aircraft,
    audit,
    bench,
    exchange,
    flown,
    journey,
    links,
    logs,
    missions,
    network,
    planning,
    replanning,
    sensors,
    serve,
    signing,
)
from app.cli.output import CommandError, Exit, fail

cli = typer.Typer(
    name="swathplan",
    help="Plan how one aircraft or several see regions, or search ground, with cameras and side-looking "
    "radars, and put the missions into them.\n\n"
    "Commands read - as standard input, write results to standard output or -o, tell messages on standard "
    "error, and exit with 0 (done), 1 (failed) or 2 (bad usage or input).",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        from app.version import VERSION

        typer.echo(VERSION)
        raise typer.Exit


@cli.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Tell the version and end.")
    ] = False,
) -> None:
    pass


MODULES = (
    serve, links, planning, replanning, network, missions, exchange, journey, sensors, aircraft, audit, logs,
    flown, signing, bench,
)  # fmt: skip
for module in MODULES:
    module.register(cli)


def run() -> None:
    """Run the command line; every foreseen error ends with its findings, not with a traceback."""
    as_json = "--json" in sys.argv
    try:
        # Left to itself the library words wrong usage in a box, which no program reads.
        ended = cli(standalone_mode=not as_json)
        raise SystemExit(ended if isinstance(ended, int) else 0)
    except typer.TyperException as error:
        fail(CommandError(error.format_message(), Exit.BAD_INPUT), as_json)
    except typer.Abort:
        raise SystemExit(130) from None
    except CommandError as error:
        fail(error, as_json)
    except KeyboardInterrupt:
        raise SystemExit(130) from None
    except BrokenPipeError:
        # the reader of our output has gone, as with `| head`
        sys.stderr.close()
        raise SystemExit(int(Exit.FAILED)) from None
