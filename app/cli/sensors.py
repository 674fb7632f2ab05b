"""``swathplan sensors``: the cameras known, and what each sees from a height."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from app.cli.output import CommandError, Exit, Json, Output, emit, emit_json
from planner.sensors.cameras import CAMERAS, Camera, find_camera


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


def sensors(
    name: Annotated[str | None, typer.Argument(help="One camera alone, by its name.")] = None,
    height_m: Annotated[float, typer.Option("--height", min=1.0, help="Metres over the ground.")] = 100.0,
    gsd_m: Annotated[
        float | None,
        typer.Option("--gsd", min=1e-4, help="Metres a pixel is to cover: tells the height for it."),
    ] = None,
    as_json: Json = False,
    output: Output = "-",
) -> None:
    """List cameras by the figures their makers publish, and the ground a pixel and an image cover."""
    try:
        chosen = list(CAMERAS.values()) if name is None else [find_camera(name)]
    except KeyError as error:
        raise CommandError(str(error.args[0]), Exit.BAD_INPUT) from None
    rows = [row(camera, height_m, gsd_m) for camera in chosen]
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
    emit("\n".join(lines) + "\n", output)
