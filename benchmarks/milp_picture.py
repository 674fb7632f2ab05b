"""A picture of lines among threats, as SVG."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from planner.dubins.path import Path

WIDE, HIGH, LEGEND = 760, 560, 30
COLOURS = {"tangent": "#222", "control": "#1565c0", "length": "#c62828"}
TITLES = {"tangent": "tangent", "control": "milp, eq 34 (control)", "length": "milp, eq 47 (length)"}


def picture(discs: NDArray[np.float64], lines: Sequence[tuple[str, str, Path]], half_m: float) -> str:
    """Threats, and lines of a kind and a title each."""
    scale = WIDE / (2.9 * half_m)

    def placed(east_m: float, north_m: float) -> tuple[float, float]:
        return WIDE / 2.0 + scale * east_m, HIGH / 2.0 - scale * north_m

    body = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDE} {HIGH + LEGEND}" '
        'font-family="sans-serif" font-size="13">',
        "<title>Lines beyond 23 threats and in among them, by both objectives and by tangents</title>",
        f'<rect width="{WIDE}" height="{HIGH + LEGEND}" fill="#fff"/>',
    ]
    for east_m, north_m, radius_m in discs.tolist():
        x, y = placed(east_m, north_m)
        body.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{scale * radius_m:.1f}" fill="#d9534f" fill-opacity=".3" '
            'stroke="#a33"/>'
        )
    for kind, title, path in lines:
        places = " ".join("{:.1f},{:.1f}".format(*placed(e, n)) for e, n in path.sample(10.0)[:, :2].tolist())
        body.append(
            f'<polyline points="{places}" fill="none" stroke="{COLOURS[kind]}" stroke-width="1.8">'
            f"<title>{title}</title></polyline>"
        )
    for number, (kind, title) in enumerate(TITLES.items()):
        left, foot = 20 + 200 * number, HIGH + 20
        body.append(
            f'<path d="M{left} {foot - 4}h24" stroke="{COLOURS[kind]}" stroke-width="2"/>'
            f'<text x="{left + 30}" y="{foot}">{title}</text>'
        )
    return "\n".join([*body, "</svg>", ""])
