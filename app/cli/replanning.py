"""``swathplan replan``: a new plan of what is left, from where the aircraft are."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, Output, emit_json, read_document, require_writable
from app.cli.planning import Bound, ScenarioFile, make, tell_plan, with_raster


def replan(
    plan: Annotated[str, typer.Argument(help="Plan GeoJSON that is being flown.", metavar="PLAN")],
    scenario: ScenarioFile,
    at_s: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            help="Seconds of the plan's own clock: aircraft are where it has them then, and what it sees "
            "until then is seen.",
        ),
    ] = None,
    begins_in_s: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            max=600.0,
            help="Seconds from then until aircraft in flight fly the new plan; they fly on by the old one "
            "meanwhile. Left out: as long as planning and upload take about.",
        ),
    ] = None,
    changes: Annotated[
        str | None,
        typer.Option(
            help="JSON as POST /api/v1/plans/{id}/replan takes it: vehicles, seen, add, remove, lost, wind.",
            metavar="FILE",
        ),
    ] = None,
    terrain: Annotated[
        str | None, typer.Option(help="Elevation raster of the scenario.", metavar="FILE")
    ] = None,
    scenario_output: Annotated[
        str | None, typer.Option(help="Write the scenario that is left here as well.", metavar="FILE")
    ] = None,
    output: Output = "-",
    as_json: Json = False,
) -> None:
    """Plan anew in flight: what is left of a scenario, with what came in, moved or is gone.

    Aircraft begin in the air where they are told to be (vehicles of the changes), else where the plan has
    them at --at-s; limits count what they have used.
    """
    from pydantic import ValidationError

    from app.schemas.replans import ReplanIn
    from app.services.errors import ConflictError, RefusedError
    from app.services.plans.replanning import left_of
    from planner.errors import ScenarioError
    from planner.geojson import read_plan, read_scenario

    require_writable(output)
    document = read_document(scenario)
    rasters = []
    if terrain is not None:
        document, raster = with_raster(document, terrain, "terrain")
        rasters.append(raster)
    asked: dict[str, Any] = {} if changes is None else dict(read_document(changes))
    if at_s is not None:
        asked["at_s"] = at_s
    if begins_in_s is not None:
        asked["begins_in_s"] = begins_in_s
    try:
        body = ReplanIn.model_validate(asked)
        flown = read_plan(read_document(plan))
        read = read_scenario(document, {each.name: each for each in rasters})
        left = left_of(document, read, flown, body.asked())
    except ValidationError as error:
        said = "; ".join(f"{'.'.join(map(str, each['loc']))}: {each['msg']}" for each in error.errors())
        raise CommandError(f"the changes cannot be read: {said}", Exit.BAD_INPUT) from error
    except (ScenarioError, RefusedError) as error:
        raise CommandError(str(error), Exit.BAD_INPUT, error.findings) from error
    except ConflictError as error:
        raise CommandError(str(error), Exit.BAD_INPUT) from error
    if scenario_output is not None:
        emit_json(left, scenario_output)
    made = make(left, None, rasters, Bound.NONE)
    emit_json(made, output)
    tell_plan(made)
    if as_json and output != "-":
        from app.services.plans.summary import summary_of

        emit_json(summary_of(made))


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(replan)
