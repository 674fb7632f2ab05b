"""``swathplan demo``: from scenario to ground seen, without a browser."""

from __future__ import annotations

import asyncio
import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from app.cli.missions import run_async
from app.cli.output import CommandError, Exit, Json, emit, emit_json, read_document, say
from app.cli.planning import ScenarioFile, make

if TYPE_CHECKING:
    from app.services.records import FlightEvent, TrackSample
    from mavlink.state.telemetry import VehicleState
    from mavlink.station.client import VehicleClient

#: Without news from the vehicle for this long, in real time, the flight is given up.
STALLED_S = 20.0
#: Of a sensor.
MARGINS = ("pointing_margin_deg", "position_margin_m")


@dataclass(frozen=True, slots=True)
class Flight:
    """A flight that has ended."""

    samples: tuple[TrackSample, ...]
    photos: tuple[FlightEvent, ...]
    duration_s: float


def demo(
    scenario: ScenarioFile,
    speedup: Annotated[float, typer.Option(min=1.0, help="Simulated seconds per second of flight.")] = 100.0,
    autopilot: Annotated[str, typer.Option(help="ardupilot or px4; the plan's when left out.")] = "",
    wind: Annotated[str, typer.Option(help="Wind of the simulation: m/s, direction it comes from.")] = "0,0",
    margins: Annotated[
        Literal["scenario", "autopilot"],
        typer.Option(help="Settling and margins of the passes: as stated, or what the autopilot needs."),
    ] = "scenario",
    as_json: Json = False,
) -> None:
    """Plan a scenario, upload it to a simulated aircraft, read it back, fly it, and tell what was seen."""
    document = read_document(scenario)
    if margins == "autopilot":
        _leave_margins_out(document)
    began_s = time.perf_counter()
    plan = make(document)
    planned_s = time.perf_counter() - began_s
    told = _Teller(as_json)
    metrics = plan["metrics"]
    covered = [name for name, fraction in metrics["coverage"].items() if fraction >= 0.9999]
    told.tell(
        f"planned in {planned_s:.2f} s, {metrics['flight_length_m'] / 1000:.2f} km and "
        f"{metrics['flight_duration_s'] / 60:.1f} min of flight, "
        f"{metrics['length_m'] / 1000:.2f} km of mission, "
        f"regions covered {len(covered)} of {len(metrics['coverage'])}, violations {len(plan['violations'])}",
        planned_s=planned_s,
        length_m=metrics["length_m"],
        flight_length_m=metrics["flight_length_m"],
        flight_duration_s=metrics["flight_duration_s"],
        coverage=metrics["coverage"],
        violations=plan["violations"],
    )
    result = run_async(_fly(document, plan, speedup, autopilot, wind, told))
    total_s = time.perf_counter() - began_s
    told.tell(f"all in {total_s:.1f} s", total_s=total_s)
    told.end()
    if not result:
        raise typer.Exit(int(Exit.FAILED))


def _leave_margins_out(document: dict[str, Any]) -> None:
    """What is not stated of them is what the autopilot needs."""
    for member, names in (("vehicles", ("settle_m",)), ("sensors", MARGINS)):
        for each in document.get(member) or ():
            for name in names if isinstance(each, dict) else ():
                each.pop(name, None)


class _Teller:
    """Tells each step as it happens, or all of them as one JSON object at the end."""

    def __init__(self, as_json: bool) -> None:
        self._as_json = as_json
        self._all: dict[str, Any] = {}

    def tell(self, line: str, **figures: Any) -> None:
        self._all |= figures
        if not self._as_json:
            emit(line)

    def end(self) -> None:
        if self._as_json:
            emit_json(self._all)


async def _fly(
    document: dict[str, Any],
    plan_document: dict[str, Any],
    speedup: float,
    autopilot: str,
    wind: str,
    told: _Teller,
) -> bool:
    """Upload, fly and judge; whether everything was as it should be."""
    from app.services.flights.seen import seen_by
    from app.services.plans.missions import MissionChoice, encode_plan
    from app.services.vehicles.connection import connected
    from app.services.vehicles.uploads import judge_upload, new_report, send_parts
    from planner.geojson import read_plan, read_scenario

    plan = read_plan(plan_document)
    vehicle = plan.vehicles[0]
    url = (
        f"sim:?speedup={speedup:g}&autopilot={autopilot or vehicle.autopilot}&wind={wind}"
        f"&type={vehicle.type}&airspeed={vehicle.airspeed_m_s:g}&turn_radius={vehicle.min_turn_radius_m:g}"
    )
    async with connected(url, (plan.home[1], plan.home[0], 0.0), 20.0) as client:
        flown_by = client.state.autopilot
        mission = encode_plan(plan, MissionChoice(autopilot=None if flown_by == "generic" else flown_by))
        findings = judge_upload(plan, mission, ["mission", "fence"], client.state, None)
        report = new_report(0, plan.scenario_hash, mission, ["mission", "fence"], None, findings)
        began_s = time.perf_counter()
        await send_parts(client, report, lambda *_: None)
        took_s = time.perf_counter() - began_s
        items = sum(part.meant for part in report.parts.values())
        told.tell(
            f"uploaded {items} items in {took_s:.2f} s, "
            f"{'read back equal' if report.verified else f'outcome {report.outcome}, not as meant'}",
            uploaded_items=items,
            upload_s=took_s,
            upload_outcome=report.outcome,
            read_back_equal=report.verified,
        )
        if not report.verified:
            return False
        began_s = time.perf_counter()
        flight = await _to_the_end(client)
        took_s = time.perf_counter() - began_s
    seen = seen_by(read_scenario(document), plan, flight.samples, flight.photos)
    worst_m = max((collect.cross_track_max_m for collect in seen.passes), default=float("nan"))
    told.tell(
        f"flown: {flight.duration_s / 60:.1f} min in {took_s:.1f} s, {len(seen.passes)} of "
        f"{len(plan.collects)} collects, at most {worst_m:.1f} m off the planned line while collecting",
        flight_s=flight.duration_s,
        flown_collects=[asdict(collect) for collect in seen.passes],
        cross_track_max_m=worst_m,
    )
    regions = " ".join(f"{name} {fraction:.2%}" for name, fraction in seen.fraction.items())
    least = min(seen.fraction.values(), default=0.0)
    if seen.photos is not None:
        planned = sum(each.planned for each in seen.photos.passes)
        told.tell(
            f"photos: {seen.photos.taken} taken of {planned}, {seen.photos.counted} counted",
            photos_taken=seen.photos.taken,
            photos_planned=planned,
            photos_counted=seen.photos.counted,
        )
    told.tell(f"seen {least:.2%} or more of each region: {regions}", seen=seen.fraction)
    return len(seen.passes) == len(plan.collects)


async def _to_the_end(client: VehicleClient) -> Flight:
    """Arm, start, and wait for the landing, or for the return that ArduPilot ends in circles over home."""
    from app.services.flights.photos import photos_of
    from app.services.vehicles.recorder import Thinner, flight_event, is_flying

    recorder = client.start_recording()
    for order in (client.arm, client.start_mission):
        outcome = await order()
        if not outcome.accepted:
            raise CommandError(f"the aircraft refused {outcome}")
    await client.wait_for(is_flying, STALLED_S)
    news_s, last_seq = time.monotonic(), -1
    while is_flying(client.state) and not _returning(client.state):
        await asyncio.sleep(0.1)
        state = client.state
        if state.mission_current is not None and state.mission_current != last_seq:
            news_s, last_seq = time.monotonic(), state.mission_current
            if last_seq % 20 == 0:
                say(f"item {last_seq} of {state.mission_total or '?'}")
        if not state.connected or time.monotonic() - news_s > STALLED_S:
            raise CommandError(f"the flight stalled at item {last_seq}, mode {state.mode}")
    client.stop_recording(recorder)
    track = recorder.track()
    samples = tuple(Thinner(0.0).more(track))
    photos = photos_of([flight_event(event) for event in track.events])
    return Flight(samples, photos, samples[-1].time_s - samples[0].time_s)


def _returning(state: VehicleState) -> bool:
    return state.mode.endswith("RTL") or state.mission_state == "complete"


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(demo)
