"""``swathplan sensors``: the cameras and radars known, and what each camera sees from a height."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, Output, emit, emit_json
from app.cli.quality_picture import picture
from planner.sensors.cameras import CAMERAS, Camera, find_camera
from planner.sensors.quality import Giqe4
from planner.sensors.radars import RADARS, Radar


def register(cli: typer.Typer) -> None:
    """Add the command."""
    cli.command("sensors")(sensors)


def row(camera: Camera, height_m: float, gsd_m: float | None) -> dict[str, Any]:
    """A camera's figures, and what they make of a height or of a ground sampled distance."""
    optics = camera.optics
    height_m = height_m if gsd_m is None else optics.height_for_m(gsd_m)
    across_m, along_m = optics.footprint_m(height_m)
    return {
        "name": camera.name,
        "kind": camera.kind,
        "spectrum": camera.spectrum,
        "focal_length_m": optics.focal_length_m,
        "pixel_pitch_m": optics.pixel_pitch_m,
        "image_px": [optics.columns, optics.rows],
        "min_interval_s": camera.min_interval_s,
        "height_m": height_m,
        "gsd_m": optics.gsd_m(height_m),
        "footprint_m": [across_m, along_m],
        "source": camera.source,
    }


def _radar_line(radar: Radar) -> str:
    resolves = "" if radar.resolution_m is None else f"{radar.resolution_m:g} m"
    beam = f"{radar.elevation_beamwidth_deg:g}° × {radar.azimuth_beamwidth_deg:g}°"
    return (
        f"{radar.name:30} {radar.mode:13} {radar.incidence_deg:>8g}° {beam:>20} {resolves:>9}  {radar.source}"
    )


def sensors(
    name: Annotated[str | None, typer.Argument(help="One camera alone, by its name.")] = None,
    height_m: Annotated[float, typer.Option("--height", min=1.0, help="Metres over the ground.")] = 100.0,
    gsd_m: Annotated[
        float | None,
        typer.Option("--gsd", min=1e-4, help="Metres a pixel is to cover: tells the height for it."),
    ] = None,
    tilt_deg: Annotated[
        float, typer.Option("--tilt", min=-70.0, max=70.0, help="Degrees tilted forward, for the picture.")
    ] = 0.0,
    rer: Annotated[float, typer.Option(min=0.01, help="Relative edge response, for the picture.")] = 0.9,
    snr: Annotated[float, typer.Option(min=0.1, help="Signal to noise ratio, for the picture.")] = 50.0,
    drawn: Annotated[
        bool, typer.Option("--picture", help="Draw one camera's quality over its footprint, as SVG.")
    ] = False,
    as_json: Json = False,
    output: Output = "-",
) -> None:
    """List cameras by published figures, with the ground a pixel and an image cover, and radars."""
    try:
        chosen = list(CAMERAS.values()) if name is None else [find_camera(name)]
    except KeyError as error:
        raise CommandError(str(error.args[0]), Exit.BAD_INPUT) from None
    rows = [row(camera, height_m, gsd_m) for camera in chosen]
    if drawn:
        if name is None:
            raise CommandError("--picture is of one camera: give its name", Exit.BAD_INPUT)
        quality = Giqe4(chosen[0].spectrum, rer, snr)
        shape = (chosen[0].optics, math.radians(tilt_deg), rows[0]["height_m"])
        try:
            emit(picture(chosen[0].name, *shape, quality), output)
        except ValueError as error:
            raise CommandError(f"{error}: give a smaller --tilt", Exit.BAD_INPUT) from None
        return
    if as_json:
        emit_json(rows if name is None else rows[0], output)
        return
    lines = [f"{'camera':30} {'kind':13} {'lens':>8} {'image':>12} {'height':>8} {'a pixel':>9}  the image"]
    for each in rows:
        columns, count = each["image_px"]
        across_m, along_m = each["footprint_m"]
        lines.append(
            f"{each['name']:30} {each['kind']:13} {1000.0 * each['focal_length_m']:5.1f} mm"
            f" {columns:>5} × {count:<4} {each['height_m']:6.0f} m {100.0 * each['gsd_m']:6.2f} cm"
            f"  {across_m:.0f} × {along_m:.0f} m"
        )
    if name is not None:
        lines.append(f"source: {rows[0]['source']}")
    else:
        lines.append(
            f"\n{'radar':30} {'mode':13} {'incidence':>9} {'beam, up and along':>20} {'resolves':>9}"
        )
        lines += [_radar_line(radar) for radar in RADARS.values()]
    emit("\n".join(lines) + "\n", output)
