"""Turns at a waypoint compared: how far each strays from the legs (eq 48), how long it is, the room it needs.

Stecz and Gromada (2020), section 4.2.2. Legs of 10 turn radii on either side of the waypoint, so that figures
are in turn radii: quality in R², the rest in R. ``room`` is needed on the leg before the waypoint, ``detour``
is the line's length beyond that of the legs, ``missed`` how near it comes to the waypoint. With
``--option picture=FILE`` an SVG of the turns, and of the arcs onto and off a segment (Algorithms 5 and 6), is
written instead.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path as FilePath
from typing import Any

import numpy as np

from benchmarks.turn_picture import picture
from planner.dubins.path import Path, Segment
from planner.dubins.rounding import TURNS, TurnName
from planner.dubins.turns import Turn, quality_m2
from planner.route import Pose

RADIUS_M = 100.0
LEG_M = 10.0 * RADIUS_M
DEGREES = (30, 60, 90, 120, 150)
SPACING_M = 0.25


def run(degrees: Sequence[int] = DEGREES, picture: str | None = None) -> Iterator[dict[str, Any]]:
    """A row for each turn and name."""
    if picture is not None:
        yield drawn(picture)
        return
    for turn_deg in degrees:
        corner = legs(turn_deg)
        for name in TURNS:
            path, turn = flown(name, corner)
            places = path.sample(SPACING_M, SPACING_M)[:, :2]
            yield {
                "bench": "smoothing", "turn_deg": turn_deg, "smoothing": name,
                "quality_r2": quality_m2(path, corner, SPACING_M) / RADIUS_M**2,
                "detour_r": (path.length_m - 2.0 * LEG_M) / RADIUS_M,
                "room_r": turn.before_m / RADIUS_M,
                "missed_r": round(float(np.hypot(places[:, 0], places[:, 1]).min()) / RADIUS_M, 2),
            }  # fmt: skip


def legs(turn_deg: float) -> list[tuple[float, float]]:
    """East to the waypoint at the origin, then turned to the left."""
    turn_rad = math.radians(turn_deg)
    return [(-LEG_M, 0.0), (0.0, 0.0), (LEG_M * math.cos(turn_rad), LEG_M * math.sin(turn_rad))]


def flown(name: TurnName, corner: list[tuple[float, float]]) -> tuple[Path, Turn]:
    """The line from the first leg's beginning to the end of the second, and its turn."""
    before, waypoint, after = corner
    turn = TURNS[name](before, waypoint, after, RADIUS_M)
    if turn is None:
        raise ValueError(f"{name} has no turn at {corner}")
    pieces = [Segment("straight", Pose(*before, 0.0), math.dist(before, turn.path.start.position))]
    pieces.extend(turn.path.segments)
    if math.isfinite(turn.after_m):
        pieces.append(Segment("straight", pieces[-1].end, math.dist(pieces[-1].end.position, after)))
    return Path(tuple(pieces)), turn


def drawn(file: str) -> dict[str, Any]:
    """The picture written to a file."""
    corners = [(turn_deg, legs(turn_deg)) for turn_deg in (60, 90, 150)]
    lines = [
        (f"turn of {d}°", corner, {name: flown(name, corner)[0] for name in TURNS}) for d, corner in corners
    ]
    FilePath(file).write_text(picture(lines, RADIUS_M), encoding="utf-8")
    return {"bench": "smoothing", "picture": file}


if __name__ == "__main__":
    for row in run():
        print(json.dumps(row))
