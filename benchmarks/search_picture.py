"""A picture of searches, as SVG: lines on the paper's square, and the example of an island whole."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.search.course import swept
from planner.search.horizon import VARIANTS, energy_horizon
from planner.search.paper_case import HEADING_RAD, SIDE_M, paper_case
from planner.search.refine import auto

Floats = NDArray[np.float64]

EXAMPLE = Path(__file__).parents[1] / "examples" / "island-volcano.geojson"
PANEL, GAP, FOOT = 300, 20, 44
SEEN, LINE, GROUND, EDGE = "#cfe3f7", "#0b57a4", "#f6f2ea", "#777"
#: Of scores by their share of the greatest.
WORTH = "#d95f02"


def picture(turn_s: float = 6.0) -> str:
    """Three panels: ``auto`` and the receding horizon on the paper's square, and the island."""
    case = paper_case()
    flown = energy_horizon(case, HEADING_RAD, VARIANTS["energy-horizon"], turn_s)
    square = (0.0, 0.0, SIDE_M, SIDE_M)
    wide, high = 3 * PANEL + 4 * GAP, PANEL + 2 * GAP + FOOT
    body = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" font-family="sans-serif" '
        'font-size="13">',
        "<title>Searches: lines on the paper's square, and an island with a volcano</title>",
        f'<rect width="{wide}" height="{high}" fill="#fff"/>',
    ]
    lines = (("auto", auto(case).points), (f"energy-horizon, τ = {turn_s:g} s", flown.points))
    for number, (name, points) in enumerate(lines):
        seen = swept(points, case.reach_m).intersection(case.ground)
        caption = f"{name}: {seen.area / case.ground.area:.1%} seen"
        body += _panel(number, square, caption, [(case.ground, GROUND, 1.0), (seen, SEEN, 1.0)], points)
    return "\n".join([*body, *_island(2), "</svg>", ""])


def _island(number: int) -> list[str]:
    document: dict[str, Any] = json.loads(EXAMPLE.read_text())
    scenario = read_scenario(document)
    plan = make_plan(scenario)
    frame = scenario.frame

    def upright(shape: BaseGeometry) -> BaseGeometry:
        turned: BaseGeometry = shapely.transform(shape, frame.north_up)
        return turned

    line = frame.north_up(frame.to_local([place[:2] for place in plan.paths[0].line]))
    (ground,) = (upright(region.area) for region in scenario.regions)
    most = max(patch.score for patch in scenario.importance.patches)
    shapes: list[tuple[BaseGeometry, str, float]] = [(ground, GROUND, 1.0)]
    shapes += [
        (upright(patch.area), WORTH, 0.5 * patch.score / most) for patch in scenario.importance.patches
    ]
    prints = [upright(Polygon(frame.to_local(each.ring))) for each in plan.footprints]
    shapes += [(each, LINE, 0.18) for each in prints]
    west, south, east, north = ground.union(LineString(line)).bounds
    middle, half = ((west + east) / 2.0, (south + north) / 2.0), 1.02 * max(east - west, north - south) / 2.0
    bounds = (middle[0] - half, middle[1] - half, middle[0] + half, middle[1] + half)
    worth = sum(
        patch.score * upright(patch.area).intersection(ground).area for patch in scenario.importance.patches
    )
    collected = plan.metrics.importance_collected or 0.0
    caption = (
        f"{scenario.name}: {plan.metrics.coverage['island']:.0%} seen, {collected / worth:.0%} of its worth"
    )
    return _panel(number, bounds, caption, shapes, line)


def _panel(
    number: int,
    bounds: tuple[float, float, float, float],
    caption: str,
    shapes: Sequence[tuple[BaseGeometry, str, float]],
    line: Floats,
) -> list[str]:
    west, south, east, _ = bounds
    scale = PANEL / (east - west)

    def places(points: Floats) -> str:
        at = (np.asarray(points)[:, :2] - [west, south]) * scale
        return " ".join(f"{x:.1f},{PANEL - y:.1f}" for x, y in at)

    left = GAP + number * (PANEL + GAP)
    body = [f'<g transform="translate({left} {GAP})">']
    for shape, colour, opacity in shapes:
        for part in shape.geoms if isinstance(shape, MultiPolygon) else [shape]:
            if isinstance(part, Polygon) and not part.is_empty:
                rings = [part.exterior, *part.interiors]
                path = " ".join(f"M{places(np.asarray(ring.coords))}Z" for ring in rings)
                body.append(
                    f'<path d="{path}" fill="{colour}" fill-opacity="{opacity:.2f}" fill-rule="evenodd" '
                    f'stroke="{EDGE}" stroke-width="0.4"/>'
                )
    body.append(f'<polyline points="{places(line)}" fill="none" stroke="{LINE}" stroke-width="1.2"/>')
    body.append(f'<text x="0" y="{PANEL + GAP + 6}">{caption}</text></g>')
    return body
