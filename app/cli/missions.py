"""``swathplan export``, ``upload``, ``download`` and ``sim``."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from app.cli.output import CommandError, Exit, Json, Output, emit, emit_bytes, emit_json, read_document, say

if TYPE_CHECKING:
    from app.services.plans.missions import MissionChoice
    from planner.plan import Plan

PlanFile = Annotated[str, typer.Argument(help="Plan GeoJSON; - is standard input.", metavar="PLAN")]
VehicleName = Annotated[str | None, typer.Option(help="Vehicle of the plan; its first when left out.")]
Payload = Annotated[
    str | None,
    typer.Option(help="How the sensor is switched: relay:0, servo:9:1900:1100, camera:distance=25 …"),
]
Gimbal = Annotated[
    str | None,
    typer.Option(help="What points the sensor, degrees from straight down: manager:tilt=45, mount:tilt=45 …"),
]
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


def read_plan_file(source: str) -> Plan:
    """A plan from a file or standard input."""
    from planner.errors import ScenarioError
    from planner.geojson import read_plan

    try:
        return read_plan(read_document(source))
    except ScenarioError as error:
        raise CommandError(f"{source} is no plan", Exit.BAD_INPUT, error.findings) from error


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
    as_json: Json = False,
) -> None:
    """Write a plan's mission for other programs.

    With --json and -o FILE the file's name, format and size go to standard output.
    """
    from app.services.plans.missions import MissionChoice, mission_bytes

    document = read_plan_file(plan)
    choice = MissionChoice(vehicle, autopilot.value if autopilot else None, payload, gimbal)

    async def write() -> bytes:
        return mission_bytes(document, choice, form.value)

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
        typer.Option(help="Refuse the plan as stale unless it is made of this scenario.", metavar="FILE"),
    ] = None,
    vehicle: VehicleName = None,
    payload: Payload = None,
    gimbal: Gimbal = None,
    timeout_s: Timeout = 10.0,
    as_json: Json = False,
) -> None:
    """Upload a plan to a vehicle, read it back and compare.

    Exits with 0 when the vehicle holds what was meant, else with 1. Nothing arms or moves the vehicle.
    """
    from app.services.plans.missions import MissionChoice

    document = read_plan_file(plan)
    names = list(dict.fromkeys(choice.value for choice in part or [PartChoice.MISSION]))
    choice = MissionChoice(vehicle, None, payload, gimbal)
    stale = None if scenario is None else _staleness(document, scenario)
    report = run_async(_upload(document, to, names, choice, override, timeout_s, stale))
    if as_json:
        emit_json(report)
    for name, result in report["parts"].items():
        count = len(result["differences"] or ())
        compared = (
            "not read back"
            if result["differences"] is None
            else "read back equal"
            if not count
            else f"read back with {count} differences"
        )
        say(f"{name}: {result['meant']} items {result['reason']}, {compared}")
        for difference in (result["differences"] or ())[:20]:
            say(f"  {difference['message']}")
    if not report["verified"]:
        raise typer.Exit(int(Exit.FAILED))


def _staleness(plan: Plan, scenario: str) -> str | None:
    """Why a plan is not that of a scenario's file; None when it is."""
    from planner.geojson import scenario_hash

    if scenario_hash(read_document(scenario)) == plan.scenario_hash:
        return None
    return f"{scenario} is another than the scenario it was made of"


async def _upload(
    plan: Plan,
    url: str,
    parts: list[Any],
    choice: MissionChoice,
    override: str | None,
    timeout_s: float,
    stale: str | None,
) -> dict[str, Any]:
    from app.services.plans.missions import encode_plan
    from app.services.vehicles.connection import connected
    from app.services.vehicles.uploads import judge_upload, new_report, report_json, send_parts

    async with connected(url, (plan.home[1], plan.home[0], 0.0), timeout_s) as client:
        autopilot = client.state.autopilot
        if autopilot != "generic":
            choice = replace(choice, autopilot=autopilot)
        mission = encode_plan(plan, choice)
        findings = judge_upload(plan, mission, parts, client.state, override, stale)
        for finding in findings:
            say(f"{'overridden' if finding.severity == 'error' else 'note'}: {finding}")
        report = new_report(0, plan.scenario_hash, mission, parts, override, findings)
        await send_parts(client, report, lambda *_: None)
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
    from mavlink.formats import qgc_plan, waypoints

    mission = run_async(_download(url, timeout_s))
    if as_json:
        lists = {"mission": mission.mission, "fence": mission.fence, "rally": mission.rally}
        emit_json({name: [item_json(item) for item in items] for name, items in lists.items()}, output)
    elif form is HeldFormat.PLAN:
        emit(qgc_plan.write_plan(mission), output)
    else:
        emit(waypoints.write_waypoints(mission), output)
    say(f"{len(mission.mission)} mission, {len(mission.fence)} fence and {len(mission.rally)} rally items")


async def _download(url: str, timeout_s: float) -> Any:
    from app.services.vehicles.connection import connected
    from mavlink.dialects.mission import Mission
    from mavlink.wire.items import MissionType

    async with connected(url, None, timeout_s) as client:
        items = await client.download(MissionType.MISSION)
        fence = await client.download(MissionType.FENCE)
        rally = await client.download(MissionType.RALLY)
        state = client.state
    home = (state.home_lon_deg or 0.0, state.home_lat_deg or 0.0)
    return Mission(
        mission=items,
        fence=fence,
        rally=rally,
        autopilot="px4" if state.autopilot == "px4" else "ardupilot",
        vehicle="",
        vehicle_type="fixed_wing" if state.type == "other" else state.type,
        home=home,
        home_altitude_m=state.home_altitude_amsl_m or 0.0,
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
