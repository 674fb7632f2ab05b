"""``swathplan flown``: what a flight, or all flights of a plan, saw."""

from __future__ import annotations

import json
from typing import Annotated, Any, Literal

import typer

from app.cli.asking import DEFAULT_SERVICE, Service, fetched
from app.cli.output import CommandError, Exit, Json, Output, emit, emit_bytes

What = Literal["summary", "coverage", "overlap", "gsd", "track", "report"]
FILES: dict[What, str] = {
    "summary": "coverage.geojson",
    "coverage": "coverage.geojson",
    "overlap": "overlap.tif",
    "gsd": "gsd.tif",
    "track": "track.geojson",
    "report": "report.html",
}
#: Of all flights of a plan; the rest is that of one flight.
OF_A_PLAN: dict[What, str] = {
    "summary": "coverage",
    "coverage": "coverage",
    "overlap": "overlap.tif",
    "gsd": "gsd.tif",
}


def flown(
    flight: Annotated[str, typer.Argument(help="The flight's id, or with --plan a plan's.", metavar="ID")],
    what: Annotated[
        What,
        typer.Option("--as", help="overlap and gsd are GeoTIFFs: photos a cell, and metres a pixel."),
    ] = "summary",
    plan: Annotated[bool, typer.Option("--plan", help="What all flights of a plan saw together.")] = False,
    roi: Annotated[str, typer.Option(help="One region, of overlap and gsd; all when left out.")] = "",
    service: Service = DEFAULT_SERVICE,
    output: Output = "-",
    as_json: Json = False,
) -> None:
    """Tell what was seen as flown: fractions, photos, overlaps, ground sampled distances, gaps."""
    if plan and what not in OF_A_PLAN:
        raise CommandError(f"{what} is that of one flight: give its id without --plan", Exit.BAD_INPUT)
    path = f"plans/{flight}/{OF_A_PLAN[what]}" if plan else f"flights/{flight}/{FILES[what]}"
    params = {"roi": roi} if roi and what in ("overlap", "gsd") else {}
    content = fetched(service, "GET", path, params, timeout_s=300.0)
    if what != "summary":
        emit_bytes(content, output)
    elif as_json:
        emit(content.decode(), output)
    else:
        emit("\n".join(summary(json.loads(content))), output)


def summary(told: dict[str, Any]) -> list[str]:
    """Lines for people."""
    lines = [
        f"{region['roi']}: seen {region['fraction']:.2%}, unknown {region['unknown_fraction']:.2%}"
        for region in told["regions"]
    ]
    photos = told.get("photos")
    if photos is None:
        return lines
    missing = sum(each["missing"] for each in photos["passes"])
    lines.append(f"photos: {photos['taken']} taken, {photos['counted']} counted, {missing} missing")
    if photos["assumed"]:
        lines.append(f"assumed, and proving nothing: {photos['assumed']}")
    for region in photos["regions"]:
        forward, side = region["forward_overlap"]["least"], region["side_overlap"]["least"]
        gsd_m = region["gsd_worst_m"]
        lines.append(
            f"{region['roi']}: overlap forward {_part(forward)}, side {_part(side)} at least; GSD "
            f"{'unknown' if gsd_m is None else f'{100.0 * gsd_m:.2f} cm'} at worst"
        )
    return lines


def _part(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.1%}"


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command()(flown)
