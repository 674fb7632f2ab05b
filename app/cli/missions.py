"""``swathplan export``, ``upload``, ``download`` and ``sim``."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from app.cli.keyring import signing_here
from app.cli.output import (
    CommandError,
    Exit,
    Json,
    Narrator,
    Output,
    emit,
    emit_bytes,
    emit_json,
    read_document,
    say,
)

if TYPE_CHECKING:
    from app.services.plans.missions import MissionChoice
    from mavlink.dialects import Autopilot, VehicleType
    from mavlink.transfer.machine import Progress

PlanFile = Annotated[str, typer.Argument(help="Plan GeoJSON; - is standard input.", metavar="PLAN")]
VehicleName = Annotated[str | None, typer.Option(help="Vehicle of the plan; its first when left out.")]
Payload = Annotated[
    str | None,
    typer.Option(
        help="How the sensor is switched: relay:0, servo:9:1900:1100, camera:distance=25, trigger:time …; the"
        " plan's cameras by their own triggers when left out."
    ),
]
Gimbal = Annotated[
    str | None,
    typer.Option(help="What points the sensor, degrees from straight down: manager:tilt=45, mount:tilt=45 …"),
]
ChordError = Annotated[
    float | None,
    typer.Option(
        min=0.1, max=100.0, help="Largest distance between an arc and the lines between its points; else 2 m."
    ),
]
Sortie = Annotated[int, typer.Option(min=1, help="Which of the vehicle's flights in the plan.")]
Timeout = Annotated[float, typer.Option(min=0.1, help="How long to wait for the vehicle's heartbeat.")]
Url = Annotated[
    str, typer.Option(help="udpin:host:port, udpout:host:port, tcp:host:port, serial:device:baud or sim:")
]

Result = TypeVar("Result")


class MissionFormat(StrEnum):
    """Formats a mission can be exported in."""

    PLAN = "plan"
    WAYPOINTS = "waypoints"
    KML = "kml"
    KMZ = "kmz"


class HeldFormat(StrEnum):
    """Formats a vehicle's mission can be saved in."""

    PLAN = "plan"
    WAYPOINTS = "waypoints"


class AutopilotChoice(StrEnum):
    """Autopilots a mission can be encoded for."""

    ARDUPILOT = "ardupilot"
    PX4 = "px4"


class ArcsChoice(StrEnum):
    """How arcs are said."""

    AUTO = "auto"
    POINTS = "points"
    LOITER = "loiter"


ArcsOption = Annotated[
    ArcsChoice | None,
    typer.Option("--arcs", help="Arcs as points along them, or as loiter turns (ArduPlane); else auto."),
]


class TypeChoice(StrEnum):
    """Types of vehicle."""

    FIXED_WING = "fixed_wing"
    MULTIROTOR = "multirotor"
    VTOL = "vtol"


class PartChoice(StrEnum):
    """Parts of a mission."""

    MISSION = "mission"
    FENCE = "fence"
    RALLY = "rally"


def run_async(work: Coroutine[Any, Any, Result]) -> Result:
    """Run to the end, with the services' errors as messages."""
    from app.services import errors
    from mavlink.errors import MavlinkError

    try:
        return asyncio.run(work)
    except errors.UnsafeError as error:
        raise CommandError(str(error), Exit.FAILED, error.findings) from error
    except (errors.RefusedError, errors.NotFoundError) as error:
        found = error.findings if isinstance(error, errors.RefusedError) else ()
        raise CommandError(str(error), Exit.BAD_INPUT, found) from error
    except (errors.ServiceError, MavlinkError) as error:
        raise CommandError(str(error)) from error


def export(
    plan: PlanFile,
    form: Annotated[MissionFormat, typer.Option("--format", help="Format to write.")] = MissionFormat.PLAN,
    output: Output = "-",
    vehicle: VehicleName = None,
    autopilot: Annotated[
        AutopilotChoice | None, typer.Option(help="Encode for this autopilot instead of the plan's.")
    ] = None,
    payload: Payload = None,
    gimbal: Gimbal = None,
    arcs: ArcsOption = None,
    chord_error_m: ChordError = None,
    sortie: Sortie = 1,
    as_json: Json = False,
) -> None:
    """Write a plan's mission for other programs.

    With --json and -o FILE the file's name, format and size go to standard output.
    """
    from app.cli.filing import given
    from app.services.plans.mission_scene import FileChoice
    from app.services.plans.missions import MissionChoice, exported

    found = given(plan, FileChoice(), None, None)
    choice = MissionChoice(
        vehicle,
        autopilot.value if autopilot else None,
        payload,
        gimbal,
        arcs=arcs.value if arcs else None,
        chord_error_m=chord_error_m,
        sortie=sortie,
    )

    async def write() -> bytes:
        return exported(found.text, choice, form.value)

    content = run_async(write())
    emit_bytes(content, output)
    if as_json and output != "-":
        emit_json({"file": output, "format": form.value, "bytes": len(content)})


def upload(
    plan: PlanFile,
    to: Url,
    part: Annotated[
        list[PartChoice] | None, typer.Option(help="What to upload (mission when left out).")
    ] = None,
    override: Annotated[
        str | None,
        typer.Option(
            help="Upload although a hard constraint is broken, or the plan is stale; say why.",
            metavar="REASON",
        ),
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option(
            help="Refuse the plan as stale unless it is made of this scenario; judge a mission file by its "
            "zones, area, ground and aircraft.",
            metavar="FILE",
        ),
    ] = None,
    vehicle: VehicleName = None,
    vehicle_type: Annotated[
        TypeChoice | None, typer.Option("--type", help="Of a mission file that does not say its vehicle.")
    ] = None,
    terrain: Annotated[
        str | None, typer.Option(help="Elevation file to judge a mission file over.", metavar="FILE")
    ] = None,
    airspeed_m_s: Annotated[
        float | None, typer.Option(min=0.1, help="Of a mission file's vehicle; else what the file says.")
    ] = None,
    min_turn_radius_m: Annotated[
        float | None, typer.Option(min=0.1, help="Of a mission file's vehicle; else by its autopilot's bank.")
    ] = None,
    payload: Payload = None,
    gimbal: Gimbal = None,
    arcs: ArcsOption = None,
    chord_error_m: ChordError = None,
    sortie: Sortie = 1,
    timeout_s: Timeout = 10.0,
    as_json: Json = False,
) -> None:
    """Upload a plan or a mission file (.plan, .mission, .waypoints) to a vehicle, read it back and compare.

    A mission file is judged first, like a plan: its fence, a scenario's zones and area, the ground, turns.
    Exits with 0 when the vehicle holds what was meant, else with 1. Nothing arms or moves the vehicle.
    """
    from app.cli.filing import given
    from app.services.plans.mission_scene import FileChoice
    from app.services.plans.missions import MissionChoice

    kind: VehicleType | None = vehicle_type.value if vehicle_type else None
    asked = FileChoice(plan, None, kind, vehicle, airspeed_m_s, min_turn_radius_m)
    found = given(plan, asked, scenario, terrain)
    names = list(dict.fromkeys(choice.value for choice in part or [PartChoice.MISSION]))
    choice = MissionChoice(
        vehicle,
        None,
        payload,
        gimbal,
        arcs=arcs.value if arcs else None,
        chord_error_m=chord_error_m,
        sortie=sortie,
    )
    stale = None if scenario is None or found.is_mission else _staleness(found.text, scenario)
    report = run_async(_upload(found.text, to, names, choice, override, timeout_s, stale))
    if as_json:
        emit_json(report)
    for name, result in report["parts"].items():
        count = len(result["differences"] or ())
        compared = (
            "not read back"
            if result["differences"] is None
            else "read back equal"
            if not count
            else f"read back with {count} difference{'' if count == 1 else 's'}"
        )
        say(f"{name}: {result['meant']} items {result['reason']}, {compared}")
        for difference in (result["differences"] or ())[:20]:
            say(f"  {difference['message']}")
    if not report["verified"]:
        raise typer.Exit(int(Exit.FAILED))


def _staleness(plan_text: str, scenario: str) -> str | None:
    """Why a plan is not that of a scenario's file; None when it is."""
    from app.services.plans.missions import plan_of
    from planner.geojson import scenario_hash

    if scenario_hash(read_document(scenario)) == plan_of(plan_text).scenario_hash:
        return None
    return f"{scenario} is another than the scenario it was made of"


async def _upload(
    plan_text: str,
    url: str,
    parts: list[Any],
    choice: MissionChoice,
    override: str | None,
    timeout_s: float,
    stale: str | None,
) -> dict[str, Any]:
    from app.services.plans.missions import flight_of, mission_of, sent
    from app.services.vehicles.connection import connected
    from app.services.vehicles.uploads import judge_upload, new_report, report_json, send_parts

    plan = flight_of(plan_text, choice)
    async with connected(url, (plan.home[1], plan.home[0], 0.0), timeout_s, signing_here(url)) as client:
        autopilot = client.state.autopilot
        if autopilot != "generic":
            choice = replace(choice, autopilot=autopilot)
        if client.state.type != "other":
            choice = replace(choice, vehicle_type=client.state.type)
        mission = sent(mission_of(plan_text, choice))
        for note in mission.notes if mission.declared is not None else ():
            say(f"note: {note}")
        findings = judge_upload(plan, mission, parts, client.state, override, stale)
        for finding in findings:
            say(f"{'overridden' if finding.severity == 'error' else 'note'}: {finding}")
        report = new_report(0, plan.scenario_hash, mission, parts, override, findings)
        narrator = Narrator()

        def tell(name: str, made: Progress) -> None:
            narrator(f"sending the {name}", made.done / (made.total or 1))

        try:
            await send_parts(client, report, tell)
        except asyncio.CancelledError:
            narrator.end()
            say(
                "interrupted: the vehicle may hold what it held before, or nothing, or what was sent; "
                "upload again, or look at what it holds (swathplan download)"
            )
            raise
        finally:
            narrator.end()
        return report_json(report)


def download(
    url: Annotated[str, typer.Option("--from", help="Link address, as for upload.", metavar="URL")],
    output: Output = "-",
    form: Annotated[HeldFormat, typer.Option("--format", help="Format to write.")] = HeldFormat.PLAN,
    timeout_s: Timeout = 10.0,
    as_json: Json = False,
) -> None:
    """Save what a vehicle holds: mission, fence and rally points (.plan) or the mission (.waypoints).

    With --json the items of all three are written as JSON instead.
    """
    from app.services.vehicles.items import item_json
    from mavlink.formats import losses, qgc_plan, waypoints

    mission = run_async(_download(url, timeout_s))
    if as_json:
        lists = {"mission": mission.mission, "fence": mission.fence, "rally": mission.rally}
        emit_json({name: [item_json(item) for item in items] for name, items in lists.items()}, output)
    elif form is HeldFormat.PLAN:
        emit(qgc_plan.write_plan(mission), output)
    else:
        emit(waypoints.write_waypoints(mission), output)
    for note in (*mission.notes, *(() if as_json else losses(mission, form.value))):
        say(f"note: {note}")
    say(f"{len(mission.mission)} mission, {len(mission.fence)} fence and {len(mission.rally)} rally items")


async def _download(url: str, timeout_s: float) -> Any:
    from app.services.vehicles.connection import connected
    from mavlink.dialects.mission import Mission, declared_by
    from mavlink.wire.items import MissionType

    async with connected(url, None, timeout_s, signing_here(url)) as client:
        items = await client.download(MissionType.MISSION)
        fence = await client.download(MissionType.FENCE)
        rally = await client.download(MissionType.RALLY)
        state = client.state
    home = (state.home_lon_deg or 0.0, state.home_lat_deg or 0.0)
    autopilot: Autopilot = "px4" if state.autopilot == "px4" else "ardupilot"
    unsaid = "the vehicle has not said where its home is: 0, 0 is written"
    notes = [] if state.home_lat_deg is not None else [unsaid]
    return Mission(
        mission=items,
        fence=fence,
        rally=rally,
        autopilot=autopilot,
        vehicle="",
        vehicle_type="fixed_wing" if state.type == "other" else state.type,
        home=home,
        notes=tuple(notes),
        home_altitude_m=state.home_altitude_amsl_m or 0.0,
        # The vehicle says its type and no speeds: none are written.
        declared=declared_by(autopilot, None if state.type == "other" else state.type),
    )


def sim(context: typer.Context) -> None:
    """Run a simulated aircraft on a link; see `swathplan sim --help` for its options."""
    from mavlink.sim.run import main

    arguments = [argument for argument in context.args if argument != "--json"]
    raise typer.Exit(main(arguments))


def register(cli: typer.Typer) -> None:
    """Add the commands."""
    cli.command()(export)
    cli.command()(upload)
    cli.command()(download)
    passed_on = {"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
    cli.command(context_settings=passed_on)(sim)
