"""``swathplan convert`` and ``import``: files of other programs."""

from __future__ import annotations

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from app.cli.missions import AutopilotChoice, HeldFormat, TypeChoice
from app.cli.output import CommandError, Exit, Json, Output, emit, emit_json, read_bytes, say


class RoleChoice(StrEnum):
    """Roles that a shape can be given."""

    ROI = "roi"
    THREAT = "threat"
    NO_FLY = "no_fly"
    AREA = "area"
    OBSTACLE = "obstacle"
    START = "start"
    END = "end"
    BASE = "base"
    IMPORTANCE = "importance"


Metres = Annotated[float | None, typer.Option(help="For shapes that do not say theirs.", metavar="M")]
RegionFile = Annotated[
    str,
    typer.Argument(
        help="KML, KMZ, GPX, GML, .shp, .zip, GeoJSON, Esri JSON, WKT, CSV, fences and rally points; "
        "- is standard input.",
        metavar="FILE",
    ),
]
MissionFile = Annotated[
    str, typer.Argument(help=".plan, .mission or .waypoints; - is standard input.", metavar="IN")
]


def convert(
    source: MissionFile,
    output: Output = "-",
    form: Annotated[HeldFormat | None, typer.Option("--format", help="Format to write.")] = None,
    autopilot: Annotated[
        AutopilotChoice | None,
        typer.Option(help="Whose mission it is: instead of the file's word, or ardupilot where it has none."),
    ] = None,
    vehicle_type: Annotated[
        TypeChoice | None, typer.Option("--type", help="Type of vehicle, where the file does not say.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Turn a mission file into the other format: .plan into .waypoints, .waypoints into .plan.

    Also reads .mission files and plain lists of fences and rally points. Surveys, corridor and structure
    scans and landing patterns of a .plan become the items they stand for. What was mended, and what the
    format written cannot hold, is told item by item.
    """
    from mavlink.formats import FormatError, kind_of, losses, read_mission, write_plan, write_waypoints
    from mavlink.formats.reading import decoded

    try:
        text = decoded(read_bytes(source))
        target = form or (HeldFormat.WAYPOINTS if kind_of(text) == "plan" else HeldFormat.PLAN)
        mission = read_mission(
            text,
            autopilot.value if autopilot else None,
            vehicle_type.value if vehicle_type else None,
        )
        written = write_plan(mission) if target is HeldFormat.PLAN else write_waypoints(mission)
    except FormatError as error:
        raise CommandError(
            f"{source}: {error}", Exit.BAD_INPUT, line=error.line, column=error.column
        ) from error
    emit(written, output)
    notes = [*mission.notes, *losses(mission, target.value)]
    for note in notes:
        say(f"note: {note}")
    if as_json and output != "-":
        emit_json(
            {
                "file": output,
                "format": target.value,
                "autopilot": mission.autopilot,
                "type": mission.vehicle_type,
                "items": len(mission.mission),
                "fence_items": len(mission.fence),
                "rally_points": len(mission.rally),
                "notes": notes,
            }
        )


def import_(
    source: RegionFile,
    output: Output = "-",
    role: Annotated[
        RoleChoice | None,
        typer.Option(
            help="Role of shapes that no value, name or folder of the file gives one "
            "(roi for polygons and lines; points are left out)."
        ),
    ] = None,
    role_of: Annotated[
        list[str] | None,
        typer.Option(
            help="Role of one shape, or of all in a folder or layer, by its name or number; goes before "
            "everything the file says: 'NFZ north=no_fly', 'Buildings=obstacle', '#3=none' (left out). "
            "May be repeated.",
            metavar="WHICH=ROLE",
        ),
    ] = None,
    width_m: Metres = None,
    radius_m: Metres = None,
    height_m: Metres = None,
    crs: Annotated[
        str | None,
        typer.Option(
            help="Reference system of the coordinates, where the file names none or a wrong one: EPSG:32611."
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Turn regions drawn elsewhere into features of a scenario: KML, GML, GPX, shapefiles, GeoJSON and more.

    Writes a GeoJSON FeatureCollection to be merged into a scenario, and says what every shape became and why.
    Lines become corridors of --width-m, threats and no-fly circles have --radius-m, footprints of buildings
    are obstacles of --height-m. Where words forbid flying a shape forbids it; one whose role is in doubt is
    marked (role_in_doubt) and cannot be planned before --role or --role-of settles it.
    """
    from app.services.errors import RefusedError
    from app.services.scenarios.regions_import import ImportOptions, import_file, words_of

    name = "" if source == "-" else Path(source).name
    options = ImportOptions(role.value if role else None, width_m, radius_m, height_m, crs, file_name=name)
    try:
        found = import_file(read_bytes(source), options, companions=_companions(source), roles=role_of or ())
    except RefusedError as error:
        raise CommandError(f"{source} is not imported: {error}", Exit.BAD_INPUT, error.findings) from error
    emit_json(found.collection, output)
    for line in words_of(found):
        say(line)
    for finding in found.left_out:
        say(f"not as it is: {finding}")
    for note in found.notes:
        say(f"note: {note}")
    count = len(found.collection["features"])
    say(f"{count} features from {found.format}")
    if as_json and output != "-":
        emit_json(
            {
                "file": output,
                "format": found.format,
                "features": count,
                "shapes": [asdict(account) for account in found.shapes],
                "left_out": [asdict(finding) for finding in found.left_out],
                "notes": list(found.notes),
            }
        )


def _companions(source: str) -> dict[str, bytes]:
    """What lies beside a .shp file under the same name."""
    path = Path(source)
    if path.suffix.lower() != ".shp":
        return {}
    stem = path.stem.casefold()
    return {
        beside.suffix.lower(): read_bytes(str(beside))
        for beside in sorted(path.parent.iterdir())
        if beside.stem.casefold() == stem and beside.suffix.lower() in (".prj", ".dbf", ".cpg")
    }


def register(cli: typer.Typer) -> None:
    """Add the commands."""
    cli.command()(convert)
    cli.command("import")(import_)
