"""``swathplan plan`` and ``swathplan validate``."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from app.cli.output import (
    CommandError,
    Exit,
    Json,
    Narrator,
    Output,
    emit,
    emit_json,
    read_document,
    require_writable,
    say,
)
from app.cli.surveys import tell_surveys

if TYPE_CHECKING:
    from planner.airspace.terrain import Terrain

ScenarioFile = Annotated[
    str, typer.Argument(help="Scenario GeoJSON; - is standard input.", metavar="SCENARIO")
]

#: Of more violations than these the number is told.
VIOLATIONS_SHOWN = 20


class Bound(StrEnum):
    """How far to look for what no plan is shorter than."""

    SHARE = "share"
    FULL = "full"
    NONE = "none"


class Deadline:
    """Stops planning after some seconds."""

    def __init__(self, limit_s: float | None) -> None:
        self._end_s = None if limit_s is None else time.monotonic() + limit_s

    def __call__(self) -> bool:
        """Whether the time is over."""
        return self._end_s is not None and time.monotonic() > self._end_s


def with_choices(document: dict[str, Any], seed: int | None, methods: list[str]) -> dict[str, Any]:
    """A scenario with the seed and the methods asked for on the command line."""
    chosen = dict(document)
    if seed is not None:
        chosen["seed"] = seed
    if methods:
        given = chosen.get("method")
        by_stage = dict(given) if isinstance(given, dict) else {}
        for choice in methods:
            stage, equals, name = choice.partition("=")
            if not equals:
                raise CommandError(f"--method {choice}: write it as stage=name", Exit.BAD_INPUT)
            by_stage[stage] = name
        chosen["method"] = by_stage
    return chosen


def with_raster(document: dict[str, Any], path: str, member: str) -> tuple[dict[str, Any], Terrain]:
    """A scenario whose member names the raster in a file, and the raster; the file's name is its own."""
    from app.cli.output import read_bytes
    from app.services.errors import RefusedError
    from app.services.terrain.rasters import read_raster

    name = document.get(member) or Path(path).stem
    try:
        terrain = read_raster(
            read_bytes(path), Path(path).name, str(name), "none" if member == "importance_raster" else None
        )
    except RefusedError as error:
        raise CommandError(str(error), Exit.BAD_INPUT, error.findings) from error
    return document | {member: str(name)}, terrain


def make(
    document: dict[str, Any],
    time_limit_s: float | None = None,
    rasters: Sequence[Terrain] = (),
    bound: Bound = Bound.NONE,
) -> dict[str, Any]:
    """Plan a scenario in this process; returns the plan document."""
    from app.services.plans.fences import fence_notes
    from planner import errors
    from planner.geojson import write_plan
    from planner.pipeline import make_plan, time_for_bound_s, with_bound
    from planner.validate import laborious, read_valid

    narrator, limit = Narrator(), Deadline(time_limit_s)
    try:
        scenario = read_valid(document, {raster.name: raster for raster in rasters})
        for warning in scenario.warnings + laborious(scenario):
            say(f"warning: {warning}")
        began_s = time.monotonic()
        plan = make_plan(
            scenario,
            progress=narrator,
            stop=limit,
            clock=time.perf_counter,
        )
        plan = replace(plan, warnings=(*plan.warnings, *fence_notes(plan)))
        if bound is not Bound.NONE:
            narrator("bound", 1.0)
            spare_s = time_for_bound_s(time.monotonic() - began_s, scenario.time_budget_s)
            rest = Deadline(spare_s if bound is Bound.SHARE else None)
            plan = with_bound(
                scenario,
                plan,
                enough=lambda: rest() or limit(),
                clock=time.perf_counter,
                share=bound is Bound.SHARE,
            )
        return write_plan(plan)
    except errors.ScenarioError as error:
        raise CommandError("the scenario is refused", Exit.BAD_INPUT, error.findings) from error
    except errors.InfeasibleError as error:
        finding = errors.Finding(error.feature, error.constraint, error.message, error.relaxation)
        raise CommandError("no plan can satisfy the scenario", Exit.FAILED, (finding,)) from error
    except errors.CancelledError as error:
        raise CommandError(f"planning took longer than {time_limit_s:g} s and was stopped") from error
    except errors.PlannerError as error:
        raise CommandError(str(error)) from error
    finally:
        narrator.end()


def tell_plan(document: dict[str, Any]) -> None:
    """Say in a few lines what a plan is like."""
    metrics = document["metrics"]
    coverage = metrics["coverage"].values()
    flight = "all flights together" if metrics.get("vehicles") else "the whole flight"
    if metrics.get("area_seen_m2") is not None:
        _tell_search(metrics)
        _tell_violations(document["violations"])
        return
    say(
        f"planned: {metrics['length_m'] / 1000:.2f} km, {metrics['duration_s'] / 60:.1f} min "
        f"({flight} {metrics['flight_length_m'] / 1000:.2f} km, "
        f"{metrics['flight_duration_s'] / 60:.1f} min), collecting {metrics['duty_cycle']:.0%} of the way, "
        f"{sum(fraction >= 0.9999 for fraction in coverage)} of {len(coverage)} regions covered"
    )
    if metrics.get("lower_bound_m") and metrics.get("gap") is not None:
        say(
            f"no plan is shorter than {metrics['lower_bound_m'] / 1000:.2f} km: "
            f"this one is at most {metrics['gap']:.1%} from the best"
        )
    tell_surveys(document)
    tell_fleet(metrics)
    _tell_violations(document["violations"])


def tell_fleet(metrics: dict[str, Any]) -> None:
    """Say who does what of a plan of several flights; nothing of one."""
    vehicles = metrics.get("vehicles") or {}
    for name, own in vehicles.items():
        energy = "" if own["energy_wh"] is None else f", {own['energy_wh']:.0f} Wh"
        flights = "1 sortie" if own["sorties"] == 1 else f"{own['sorties']} sorties"
        say(
            f"{name}: {flights} from {own['take_off_s'] / 60:.1f} to {own['landing_s'] / 60:.1f} min, "
            f"{own['length_m'] / 1000:.2f} km{energy}, priority {round(own['priority'], 3):g}"
        )
    if vehicles:
        say(f"the last is down after {metrics['last_landing_s'] / 60:.1f} min")
        _tell_assigned(metrics.get("assignment"))
        for left in metrics["left_out"]:
            by = "" if left["margin"] is None else f", by {left['margin']:.1f}"
            say(f"{left['roi']} is left out: {left['reason']}{by}")


def _tell_search(metrics: dict[str, Any]) -> None:
    parts = metrics["coverage"].values()
    worth, energy_wh = metrics.get("importance_collected"), metrics.get("energy_wh")
    say(
        f"searched: {metrics['area_seen_m2'] / 1e6:.3f} km² seen"
        + (f", {next(iter(parts)):.1%} of the ground" if len(parts) == 1 else "")
        + ("" if worth is None else f", importance {_worth(worth)} of {_worth(metrics['importance_total'])}")
        + f", in {metrics['flight_length_m'] / 1000:.2f} km and {metrics['flight_duration_s'] / 60:.1f} min"
        + ("" if energy_wh is None else f", {energy_wh:.1f} Wh")
    )


def _worth(worth: float) -> str:
    return f"{worth:,.{0 if worth >= 100.0 else 3}f}"


def _tell_violations(violations: list[dict[str, Any]]) -> None:
    for violation in violations[:VIOLATIONS_SHOWN]:
        say(f"violation: {violation.get('feature', '')}: {violation.get('message', violation)}")
    if len(violations) > VIOLATIONS_SHOWN:
        say(f"violation: and {len(violations) - VIOLATIONS_SHOWN} more, in the plan")
    if any(violation.get("hard") for violation in violations):
        say("it breaks hard constraints: uploads refuse it unless they override, saying why")


def plan(
    scenario: ScenarioFile,
    output: Output = "-",
    seed: Annotated[int | None, typer.Option(help="Seed, instead of the scenario's.")] = None,
    method: Annotated[
        list[str] | None, typer.Option(help="Algorithm of a stage, e.g. transit=ssas.", metavar="STAGE=NAME")
    ] = None,
    time_limit_s: Annotated[float | None, typer.Option(min=0.0, help="Give up after this long.")] = None,
    terrain: Annotated[
        str | None,
        typer.Option(help="Elevation raster to plan on: GeoTIFF, DTED or SRTM HGT.", metavar="FILE"),
    ] = None,
    importance_raster: Annotated[
        str | None,
        typer.Option(help="Raster of what seeing a square metre is worth, for a search.", metavar="FILE"),
    ] = None,
    bound: Annotated[
        Bound,
        typer.Option(
            help="What no plan is shorter than: looked for with a third of the work, to the end, or not."
        ),
    ] = Bound.SHARE,
    as_json: Json = False,
) -> None:
    """Plan a scenario; the result is plan GeoJSON.

    What the plan is like is said in a few lines on standard error: length and time, of each camera survey
    height, photos, ground sampled distance and overlaps, of a fleet who does what, and what the judge finds.
    With --json and -o FILE the plan's metrics and violations go to standard output.
    """
    require_writable(output)
    asked = with_choices(read_document(scenario), seed, method or [])
    rasters = []
    for member, path in (("terrain", terrain), ("importance_raster", importance_raster)):
        if path is not None:
            asked, raster = with_raster(asked, path, member)
            rasters.append(raster)
    document = make(asked, time_limit_s, rasters, bound)
    emit_json(document, output)
    tell_plan(document)
    if as_json and output != "-":
        from app.services.plans.summary import summary_of

        emit_json(summary_of(document))


def validate(scenario: ScenarioFile, as_json: Json = False) -> None:
    """Check a scenario without planning it; exits with 2 when it is refused."""
    from app.services.plans.work import finding_json
    from app.services.scenarios.validation import judge

    verdict = judge(read_document(scenario))
    if as_json:
        found = [finding_json(finding) for finding in verdict.errors + verdict.warnings]
        emit_json({"valid": not verdict.errors, "findings": found})
    else:
        for finding in verdict.errors + verdict.warnings:
            emit(f"{finding.severity}: {finding}")
        if not verdict.errors:
            emit("the scenario is valid")
    if verdict.errors:
        raise typer.Exit(int(Exit.BAD_INPUT))


def register(cli: typer.Typer) -> None:
    """Add the commands."""
    cli.command()(plan)
    cli.command()(validate)


def _tell_assigned(told: dict[str, Any] | None) -> None:
    if told is not None and told["gap"] is not None:
        say(
            f"who does what, by {told['method']}, is {told['status']}: by the times thought no other is "
            f"better by more than {told['gap']:.1%}"
        )
