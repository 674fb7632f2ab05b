"""Vehicles: connect, watch, upload, command."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import aclosing
from typing import Annotated

from fastapi import APIRouter, Query, Response
from fastapi.responses import StreamingResponse
from sse_starlette import EventSourceResponse, ServerSentEvent

from app.problems import responses
from app.routers.held import require_held
from app.routers.streams import event_stream, file_stream
from app.schemas.forwards import ForwardsIn, ForwardsOut
from app.schemas.missions import ClearedOut, HeldOut, MissionIn, Part, UploadOut
from app.schemas.preflight import ParametersOut, PreflightIn, PreflightOut
from app.schemas.together import FleetMissionIn, FleetUploadOut
from app.schemas.vehicles import (
    AddressIn,
    CommandIn,
    CommandList,
    CommandOut,
    IdentityIn,
    LogList,
    LogOut,
    SigningIn,
    VehicleIn,
    VehicleList,
    VehicleOut,
)
from app.services.plans.missions import MissionChoice
from app.services.vehicles import signing
from app.services.vehicles.flight_orders import Wish
from app.services.vehicles.orders import give_order
from app.services.vehicles.together import upload_all
from app.vehicle_deps import ChecksDep, FleetDep, PermitsDep, TransfersDep

router = APIRouter(prefix="/api/v1/vehicles", tags=["vehicles"])

TLOG = "application/octet-stream"

Parts = Annotated[list[Part], Query(description="Repeat for several.")]


@router.post("", status_code=201, summary="Connect a vehicle", responses=responses(409, 422))
async def connect(body: VehicleIn, fleet: FleetDep, permits: PermitsDep, response: Response) -> VehicleOut:
    """Open the link and wait for a heartbeat.

    A vehicle that stays silent is listed as not connected, and connects when it is heard. Links beyond this
    machine, serial ports and recordings are opened as far as the settings allow (`link-not-allowed`).
    """
    permits.require(body.url)
    permits.require_forwards(each.url for each in body.forward)
    forward = [(each.url, each.write) for each in body.forward]
    vehicle = await fleet.connect(body.name, body.url, body.timeout_s, forward=forward)
    response.headers["Location"] = f"/api/v1/vehicles/{vehicle.id}"
    return VehicleOut.of(vehicle)


@router.get("", summary="List vehicles")
async def list_vehicles(fleet: FleetDep) -> VehicleList:
    """Vehicles, oldest first."""
    return VehicleList(vehicles=[VehicleOut.of(vehicle) for vehicle in fleet.all()])


@router.get("/{vehicle_id}", summary="Read a vehicle", responses=responses(404))
async def get_vehicle(vehicle_id: str, fleet: FleetDep) -> VehicleOut:
    """Its state, its last upload, what is at work on it."""
    return VehicleOut.of(fleet.get(vehicle_id))


@router.delete("/{vehicle_id}", status_code=204, summary="Let a vehicle go", responses=responses(404, 409))
async def disconnect(
    vehicle_id: str,
    fleet: FleetDep,
    in_flight: Annotated[bool, Query(description="Let it go even while it flies.")] = False,
) -> None:
    """Close the link; a simulated aircraft ends. The vehicle itself gets no command.

    One in flight is let go only with `in_flight=true` (409 `in-flight`): nobody hears or records it then.
    """
    await fleet.disconnect(vehicle_id, in_flight)


@router.get("/{vehicle_id}/forward", summary="List forwards", responses=responses(404))
async def list_forwards(vehicle_id: str, fleet: FleetDep) -> ForwardsOut:
    """Other ground stations that hear the vehicle, with what was sent, dropped, passed on and held back."""
    return ForwardsOut.of(fleet.get(vehicle_id))


@router.put("/{vehicle_id}/forward", summary="Forward to others", responses=responses(404, 409, 422))
async def set_forwards(
    vehicle_id: str, body: ForwardsIn, fleet: FleetDep, permits: PermitsDep
) -> ForwardsOut:
    """Forward the link to these addresses and no others; those there already stay open.

    Stations only watch unless `write` says otherwise: then they may arm and move the vehicle as over a radio
    of their own. What they send is recorded with the rest. Addresses beyond this machine are opened as far as
    the settings allow.
    """
    permits.require_forwards(each.url for each in body.forward)
    forward = [(each.url, each.write) for each in body.forward]
    return ForwardsOut.of(await fleet.forward(vehicle_id, forward))


@router.get(
    "/{vehicle_id}/telemetry",
    summary="Watch a vehicle",
    response_class=EventSourceResponse,
    responses=responses(404)
    | {
        200: {
            "description": "Events `state`, at most five a second; the data is the vehicle's record.",
            "content": {"text/event-stream": {"schema": {"type": "string"}}},
        }
    },
)
async def telemetry(vehicle_id: str, fleet: FleetDep) -> EventSourceResponse:
    """Server-sent events until the vehicle is let go."""
    fleet.get(vehicle_id)

    async def stream() -> AsyncGenerator[ServerSentEvent, None]:
        async with aclosing(fleet.telemetry(vehicle_id)) as vehicles:
            async for vehicle in vehicles:
                yield ServerSentEvent(VehicleOut.of(vehicle).model_dump_json(), event="state")

    return event_stream(stream())


@router.post(
    "/{vehicle_id}/mission",
    summary="Upload a plan",
    responses=responses(404, 409, 422)
    | {202: {"model": UploadOut, "description": "The outcome is unknown until the vehicle comes back."}},
)
async def upload(
    vehicle_id: str, body: MissionIn, fleet: FleetDep, transfers: TransfersDep, response: Response
) -> UploadOut:
    """Encode the plan for the autopilot that is there, upload, read back, compare.

    Plans that break a hard constraint, plans whose kept scenario is another by now (`plan-stale`), missions
    for another kind of vehicle and vehicles in flight are refused (409) unless `override` is true and
    `reason` says why. `outcome` tells what the vehicle said: `accepted`, `refused`, or `unknown` when it
    vanished meanwhile; `held` and `differences` tell what it holds. 200 only where all of it was read back
    and is what was meant; 409 `not-held`, with the same members, where the vehicle refused part of it or
    holds something else.
    """
    choice = MissionChoice(
        body.vehicle,
        None,
        body.payload,
        body.gimbal,
        arcs=body.arcs,
        chord_error_m=body.chord_error_m,
        sortie=body.sortie,
    )
    vehicle = fleet.get(vehicle_id)
    report = await transfers.upload(
        vehicle, body.plan_id, body.parts, choice, body.reason if body.override else None
    )
    told = UploadOut.of(report)
    # It may have been let go meanwhile: nothing is asked of the fleet any more.
    require_held(f"{vehicle.name} does not hold the plan", report.failings, told)
    response.status_code = 200 if report.verified else 202
    return told


@router.post(
    "/missions",
    summary="Upload a plan to all of its vehicles",
    responses=responses(404, 409, 422)
    | {202: {"model": FleetUploadOut, "description": "The outcome of one is unknown until it comes back."}},
)
async def upload_fleet(
    body: FleetMissionIn, fleet: FleetDep, transfers: TransfersDep, response: Response
) -> FleetUploadOut:
    """Each vehicle of the plan is sent its own mission, all at once, and read back; one verdict tells of all.

    Nothing is sent unless every vehicle of the plan has a connected one of its own. A vehicle that is refused
    holds up no other: what became of each is told by name. Statuses as of one upload.
    """
    report = await upload_all(
        fleet,
        transfers,
        await transfers.plan_text(body.plan_id),
        body.plan_id,
        body.vehicles,
        body.sorties,
        list(dict.fromkeys(body.parts)),
        MissionChoice(None, None, body.payload, body.gimbal),
        body.reason if body.override else None,
    )
    told = FleetUploadOut.of(report)
    require_held("not every vehicle holds its part of the plan", report.failings, told)
    response.status_code = 200 if report.verified else 202
    return told


@router.get("/{vehicle_id}/mission", summary="Download", responses=responses(404, 409, 422))
async def download(
    vehicle_id: str,
    fleet: FleetDep,
    transfers: TransfersDep,
    part: Parts = ["mission"],  # noqa: B006
) -> HeldOut:
    """What the vehicle holds."""
    parts = await transfers.download(fleet.get(vehicle_id), list(dict.fromkeys(part)))
    return HeldOut(vehicle_id=vehicle_id, parts=parts)


@router.delete("/{vehicle_id}/mission", summary="Clear", responses=responses(404, 409, 422))
async def clear(
    vehicle_id: str,
    fleet: FleetDep,
    transfers: TransfersDep,
    response: Response,
    part: Parts = ["mission"],  # noqa: B006
    in_flight: Annotated[bool, Query(description="Clear them even while it flies.")] = False,
) -> ClearedOut:
    """Empty the vehicle's lists; 409 where the vehicle refuses, 202 where nobody can tell.

    Of one in flight only with `in_flight=true` (409 `in-flight`): it would have nothing left to land by.
    """
    outcomes = await transfers.clear(fleet.get(vehicle_id), list(dict.fromkeys(part)), in_flight)
    if any(outcome.kind == "unknown" for outcome in outcomes.values()):
        response.status_code = 202
    return ClearedOut(vehicle_id=vehicle_id, parts={name: o.kind for name, o in outcomes.items()})


@router.post("/{vehicle_id}/preflight", summary="Check before flight", responses=responses(404, 409, 422))
async def preflight(vehicle_id: str, body: PreflightIn, fleet: FleetDep, checks: ChecksDep) -> PreflightOut:
    """Plan, dialect, mission and fence as held, parameters, battery, place, fix, altitude datum, wind.

    The vehicle is read, never changed. It is `ready` when no check has failed.
    """
    choice = MissionChoice(
        body.vehicle,
        None,
        body.payload,
        body.gimbal,
        arcs=body.arcs,
        chord_error_m=body.chord_error_m,
        sortie=body.sortie,
    )
    return PreflightOut.of(await checks.preflight(fleet.get(vehicle_id), body.plan_id, choice))


@router.get("/{vehicle_id}/parameters", summary="Read parameters", responses=responses(404, 409, 422))
async def parameters(
    vehicle_id: str,
    fleet: FleetDep,
    checks: ChecksDep,
    name: Annotated[list[str] | None, Query(max_length=200, description="Repeat for several.")] = None,
    plan_id: Annotated[str | None, Query(max_length=36, description="Read and judge what it needs.")] = None,
    payload: Annotated[str | None, Query(max_length=200)] = None,
    gimbal: Annotated[str | None, Query(max_length=200)] = None,
) -> ParametersOut:
    """Parameters by name; with `plan_id` also those the plan needs, with findings. None is ever changed."""
    choice = MissionChoice(None, None, payload, gimbal)
    report = await checks.parameters(fleet.get(vehicle_id), name or [], plan_id, choice)
    return ParametersOut.of(vehicle_id, report)


@router.get("/{vehicle_id}/logs", summary="List recordings", responses=responses(404))
async def list_logs(vehicle_id: str, fleet: FleetDep) -> LogList:
    """Recordings of the vehicle's link (.tlog), also of a vehicle that was let go."""
    files = await fleet.recordings(vehicle_id)
    base = f"/api/v1/vehicles/{vehicle_id}/logs"
    logs = [
        LogOut(name=f.name, size_bytes=f.size_bytes, ended_at=f.ended_at, url=f"{base}/{f.name}")
        for f in files
    ]
    known = {vehicle.id: vehicle for vehicle in fleet.all()}
    failure = known[vehicle_id].tape.failure if vehicle_id in known else None
    return LogList(vehicle_id=vehicle_id, failure=failure, logs=logs)


@router.get(
    "/{vehicle_id}/logs/{name}",
    summary="Download a recording",
    response_class=StreamingResponse,
    responses=responses(404)
    | {200: {"content": {TLOG: {"schema": {"type": "string", "format": "binary"}}}, "description": "OK"}},
)
async def get_log(vehicle_id: str, name: str, fleet: FleetDep) -> StreamingResponse:
    """A .tlog, as MAVProxy, Mission Planner, QGroundControl and pymavlink read it."""
    return file_stream(await fleet.recording(vehicle_id, name), TLOG)


@router.post(
    "/{vehicle_id}/identity", summary="Acknowledge another aircraft", responses=responses(404, 409, 422)
)
async def acknowledge(
    vehicle_id: str, body: IdentityIn, fleet: FleetDep, transfers: TransfersDep
) -> VehicleOut:
    """Take the aircraft that answers in the vehicle's place (`other_system`) for the vehicle.

    Until then it gets no order and no mission. The flight of the aircraft before it ends; that one's plan,
    upload and what was sent to it are not taken for this one's. 409 when that system does not answer there.
    """
    vehicle = fleet.get(vehicle_id)
    await transfers.acknowledge(vehicle, body.system_id)
    return VehicleOut.of(vehicle)


@router.post("/{vehicle_id}/address", summary="Acknowledge an address", responses=responses(404, 409, 422))
async def acknowledge_address(
    vehicle_id: str, body: AddressIn, fleet: FleetDep, transfers: TransfersDep
) -> VehicleOut:
    """Say at which address of its port the vehicle is: `address`, or one of `strangers`.

    It alone is heard and sent to from then on, and others that say that they are this system are no longer
    in doubt. From another address than before another aircraft may speak: what this one held, and its flight,
    are not taken for that one's. 409 when nobody was heard there lately.
    """
    vehicle = fleet.get(vehicle_id)
    await transfers.acknowledge_address(vehicle, body.address)
    return VehicleOut.of(vehicle)


@router.post("/{vehicle_id}/signing", summary="Change signing", responses=responses(404, 409, 422))
async def change_signing(vehicle_id: str, body: SigningIn, fleet: FleetDep) -> VehicleOut:
    """Sign with the vehicle's key, hand it over, or have the vehicle sign no more; only when it is disarmed.

    The key stands in `SWATHPLAN_SIGNING_KEYS` or the environment and is in no request, answer, recording or
    log. It goes to the vehicle unsigned the first time: over a link that nobody else hears, best by USB. 409
    when the vehicle, if it is heard, does not show within some seconds that it has it; then all is as before.
    """
    vehicle = fleet.get(vehicle_id)
    await signing.change(vehicle, body.action)
    return VehicleOut.of(vehicle)


@router.post("/{vehicle_id}/commands", summary="Command", responses=responses(404, 409, 422, 504))
async def command(vehicle_id: str, body: CommandIn, fleet: FleetDep) -> CommandOut:
    """An explicit flight command; nothing else arms or moves a vehicle.

    Answered once the vehicle shows it (`done`), or `pending` after `wait_s`. Refused and overtaken commands
    are a 409, those nobody can tell of a 504, each a problem with the command's members and, in `errors`,
    the rule and the way out: `not-armed` (start), `mode-would-take-off` (arm), `no-landing` (land of a fixed
    wing), `item-out-of-range` (goto_item), `in-flight` (disarm), `mission-differs`, `mission-unknown`,
    `mission-unread` (start, arm: the vehicle is asked what is on board, and it is not what was sent;
    `as_held` passes), `command-refused` (the vehicle said no: its answer and state in words, and what it said
    meanwhile of the same matter), and whatever `doubt` of the vehicle says.
    """
    vehicle = fleet.get(vehicle_id)
    wish = Wish(body.command, body.seq, body.arm_first, body.hold_first, body.payload, body.as_held)
    return CommandOut.of(vehicle, await give_order(vehicle, wish, body.wait_s))


@router.get("/{vehicle_id}/commands", summary="List commands", responses=responses(404))
async def list_commands(vehicle_id: str, fleet: FleetDep) -> CommandList:
    """The last fifty commands given from here, and what became of each."""
    vehicle = fleet.get(vehicle_id)
    return CommandList(commands=[CommandOut.of(vehicle, order) for order in vehicle.book.newest_first()])


@router.get("/{vehicle_id}/commands/{command_id}", summary="Read a command", responses=responses(404))
async def get_command(vehicle_id: str, command_id: str, fleet: FleetDep) -> CommandOut:
    """How a command stands; a pending one ends as done or as unknown."""
    vehicle = fleet.get(vehicle_id)
    return CommandOut.of(vehicle, vehicle.book.get(command_id))
