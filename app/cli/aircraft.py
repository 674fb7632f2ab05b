"""``swathplan aircraft``: the airframes known, and how long and far each flies on its battery."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, emit, emit_json
from planner.geojson.equipment import read_aircraft
from planner.geojson.fields import Findings
from planner.vehicle.airframes import AIRFRAMES, Airframe, find_airframe
from planner.vehicle.energy import FlightState


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command("aircraft")(aircraft)


def row(airframe: Airframe) -> dict[str, Any]:
    """An airframe's figures, its power in level flight at sea level, and what its battery comes to."""
    read = read_aircraft({"name": airframe.name, "model": airframe.name}, 0, Findings())
    if read is None or read.power is None:
        raise CommandError(f"the figures of {airframe.name} make no aircraft")
    power_w = read.power.power_w(FlightState(read.airspeed_m_s))
    usable_wh = read.usable_wh
    time_s = None if usable_wh is None else 3600.0 * usable_wh / power_w
    return {
        "name": airframe.name,
        **airframe.members,
        "cruise_power_w": round(power_w, 1),
        "flight_time_s": None if time_s is None else round(time_s),
        "range_m": None if time_s is None else round(time_s * read.airspeed_m_s),
        "source": airframe.source,
    }


def aircraft(
    name: Annotated[str | None, typer.Argument(help="One airframe alone, by its name.")] = None,
    as_json: Json = False,
) -> None:
    """List airframes by published figures: name one as a vehicle's model. Times keep the usual reserve."""
    try:
        chosen = list(AIRFRAMES.values()) if name is None else [find_airframe(name)]
    except KeyError as error:
        raise CommandError(str(error.args[0]), Exit.BAD_INPUT) from None
    rows = [row(airframe) for airframe in chosen]
    if as_json:
        emit_json(rows if name is None else rows[0])
        return
    lines = [f"{'airframe':24} {'type':11} {'speed':>8} {'battery':>9} {'cruise':>8} {'lasts':>8}  source"]
    for each in rows:
        stored, lasts = each.get("energy_wh"), each["flight_time_s"]
        lines.append(
            f"{each['name']:24} {each['type']:11} {each['airspeed_m_s']:4g} m/s"
            f" {'' if stored is None else f'{stored:.0f} Wh':>9} {each['cruise_power_w']:6.0f} W"
            f" {'' if lasts is None else f'{lasts / 60.0:.0f} min':>8}  {each['source']}"
        )
    emit("\n".join(lines) + "\n")
