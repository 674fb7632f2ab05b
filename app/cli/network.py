"""``swathplan network``: the recognition segments round the targets of a plan."""

from __future__ import annotations

from collections import Counter
from typing import Annotated

import typer

from app.cli.output import CommandError, Exit, Json, Output, emit_json, read_document, require_writable, say
from app.cli.planning import ScenarioFile, with_raster


def network(
    plan: Annotated[str, typer.Argument(help="Plan GeoJSON.", metavar="PLAN")],
    scenario: ScenarioFile,
    target: Annotated[
        list[str] | None, typer.Option(help="Only this region; may be given again.", metavar="NAME")
    ] = None,
    terrain: Annotated[
        str | None, typer.Option(help="Elevation raster of the scenario.", metavar="FILE")
    ] = None,
    output: Output = "-",
    as_json: Json = False,
) -> None:
    """Write the segments round a plan's targets: chosen, open, and ruled out with the reason, as GeoJSON.

    With --json and -o FILE how many there are of each goes to standard output.
    """
    from app.services.errors import ConflictError, RefusedError
    from app.services.plans.network import network_document
    from planner.errors import ScenarioError
    from planner.geojson import read_plan, read_scenario

    require_writable(output)
    document = read_document(scenario)
    rasters = []
    if terrain is not None:
        document, raster = with_raster(document, terrain, "terrain")
        rasters.append(raster)
    try:
        read = read_scenario(document, {each.name: each for each in rasters})
        found = network_document(read, read_plan(read_document(plan)), target or [])
    except (ScenarioError, RefusedError) as error:
        raise CommandError(str(error), Exit.BAD_INPUT, error.findings) from error
    except ConflictError as error:
        raise CommandError(str(error), Exit.BAD_INPUT) from error
    emit_json(found, output)
    segments = [f["properties"] for f in found["features"] if f["properties"]["role"] == "segment"]
    states = Counter(segment["state"] for segment in segments)
    rules = Counter(each["rule"] for segment in segments for each in segment["ruled_out"])
    why = ", ".join(f"{count} for {rule}" for rule, count in rules.most_common())
    say(
        f"{len(segments)} segments: {states['chosen']} chosen, {states['open']} open, "
        f"{states['ruled_out']} ruled out{f' ({why})' if why else ''}"
    )
    if as_json and output != "-":
        emit_json({"segments": len(segments), **states, "ruled_out_for": dict(rules)})


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(network)
