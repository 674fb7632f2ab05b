"""A picture of a search for what drifts, as SVG: what is believed, and what has been flown, at four times."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.search.belief.drifting import believed

Floats = NDArray[np.float64]

EXAMPLE = Path(__file__).parents[1] / "examples" / "missing-at-sea.geojson"
PANEL, GAP, FOOT = 300, 16, 40
SEA, LINE, SEEN, DOT, EDGE = "#eef4f8", "#0b57a4", "#0b57a4", "#d95f02", "#777"
PARTS = (0.0, 0.33, 0.67, 1.0)
#: Cells of the heat to a panel's side.
CELLS = 60


def picture(seed: int = 0) -> str:
    """What is believed of one overboard after parts of the flight, darker where it is likelier."""
    scenario = read_scenario(json.loads(EXAMPLE.read_text()))
    plan = make_plan(scenario)
    importance, frame = scenario.importance, scenario.frame
    drift = importance.drift
    if drift is None:
        raise ValueError("the example drifts")
    belief = believed(importance, drift, 65_536, seed)
    path = plan.paths[0]
    belief = replace(
        belief, places_m=frame.north_up(belief.places_m), drifts_m_s=frame.north_up(belief.drifts_m_s)
    )
    line = frame.north_up(frame.to_local([place[:2] for place in path.line]))
    along_m = np.concatenate([[0.0], np.hypot(*np.diff(line, axis=0).T).cumsum()])
    end = belief.places_m + path.duration_s * belief.drifts_m_s
    corners = np.vstack(
        [line, np.quantile(belief.places_m, [0.01, 0.99], axis=0), np.quantile(end, [0.01, 0.99], axis=0)]
    )
    west, south = corners.min(axis=0) - 150.0
    side = float(np.ptp(corners, axis=0).max()) + 300.0
    wide, high = len(PARTS) * (PANEL + GAP) + GAP, PANEL + GAP + FOOT
    body = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" font-family="sans-serif" '
        'font-size="13">',
        "<title>Someone overboard: where they may be, and what has been flown by then</title>",
        f'<rect width="{wide}" height="{high}" fill="#fff"/>',
    ]
    prints = [Polygon(frame.north_up(frame.to_local(each.ring))) for each in plan.footprints]
    most = 0.0
    for number, part in enumerate(PARTS):
        time_s = part * path.duration_s
        left = belief.weights.copy()
        for collect, seen in zip(plan.collects, prints, strict=True):
            if collect.end_s <= time_s:
                there = belief.places_m + 0.5 * (collect.start_s + collect.end_s) * belief.drifts_m_s
                shapely.prepare(seen)
                left[shapely.contains_xy(seen, there[:, 0], there[:, 1])] *= 1.0 - importance.detection
        now = belief.places_m + time_s * belief.drifts_m_s
        heat, _, _ = np.histogram2d(
            now[:, 1], now[:, 0], CELLS, [[south, south + side], [west, west + side]], weights=left
        )
        most = max(most, float(heat.max()))
        flown = line[along_m <= part * along_m[-1] + 1e-6]
        caption = f"{time_s / 60.0:.0f} min: found with {1.0 - left.sum() / belief.weights.sum():.0%}"
        body += _panel(number, heat / most, flown, (float(west), float(south), side), caption)
    return "\n".join([*body, "</svg>", ""])


def _panel(
    number: int, heat: Floats, line: Floats, window: tuple[float, float, float], caption: str
) -> list[str]:
    west, south, side = window
    scale, cell = PANEL / side, PANEL / CELLS
    left = GAP + number * (PANEL + GAP)
    body = [
        f'<g transform="translate({left} {GAP})">',
        f'<rect width="{PANEL}" height="{PANEL}" fill="{SEA}"/>',
    ]
    for row, column in np.argwhere(heat > 0.02).tolist():
        body.append(
            f'<rect x="{column * cell:.1f}" y="{PANEL - (row + 1) * cell:.1f}" width="{cell:.1f}" '
            f'height="{cell:.1f}" fill="{DOT}" fill-opacity="{min(1.0, heat[row, column]):.2f}"/>'
        )
    places = " ".join(f"{(e - west) * scale:.1f},{PANEL - (n - south) * scale:.1f}" for e, n in line.tolist())
    body.append(f'<polyline points="{places}" fill="none" stroke="{LINE}" stroke-width="1.2"/>')
    body.append(f'<text x="0" y="{PANEL + 20}">{caption}</text></g>')
    return body
