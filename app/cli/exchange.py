"""``swathplan convert`` and ``import``: files of other programs."""

from __future__ import annotations

from typing import Annotated

import typer

from app.cli.missions import AutopilotChoice, HeldFormat
from app.cli.output import CommandError, Exit, Json, Output, emit, emit_json, read_bytes, say

MissionFile = Annotated[str, typer.Argument(help=".plan or .waypoints; - is standard input.", metavar="IN")]


def convert(
    source: MissionFile,
    output: Output = "-",
    form: Annotated[HeldFormat | None, typer.Option("--format", help="Format to write.")] = None,
    autopilot: Annotated[
        AutopilotChoice, typer.Option(help="Whose mission a .waypoints file holds; it does not say.")
    ] = AutopilotChoice.ARDUPILOT,
    as_json: Json = False,
) -> None:
    """Turn a mission file into the other format: .plan into .waypoints, .waypoints into .plan.

    Surveys, corridor and structure scans and landing patterns of a .plan become the items they stand for.
    """
    from mavlink.formats import FormatError, read_plan, read_waypoints, write_plan, write_waypoints

    text = _text(source)
    is_plan = text.lstrip("\ufeff \t\r\n").startswith("{")
    try:
        mission = read_plan(text) if is_plan else read_waypoints(text, autopilot.value)
        target = form or (HeldFormat.WAYPOINTS if is_plan else HeldFormat.PLAN)
        written = write_plan(mission) if target is HeldFormat.PLAN else write_waypoints(mission)
    except FormatError as error:
        raise CommandError(
            f"{source}: {error}", Exit.BAD_INPUT, line=error.line, column=error.column
        ) from error
    emit(written, output)
    lost = []
    if target is HeldFormat.WAYPOINTS:
        lost = [name for name, items in (("fence", mission.fence), ("rally points", mission.rally)) if items]
    notes = [*mission.notes, *(f"the {name} has no place in a .waypoints file" for name in lost)]
    for note in notes:
        say(f"note: {note}")
    if as_json and output != "-":
        emit_json(
            {
                "file": output,
                "format": target.value,
                "autopilot": mission.autopilot,
                "items": len(mission.mission),
                "notes": notes,
            }
        )


def _text(source: str) -> str:
    try:
        return read_bytes(source).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CommandError(f"{source} is no UTF-8 text", Exit.BAD_INPUT) from error


def register(cli: typer.Typer) -> None:
    """Add the commands."""
    cli.command()(convert)
