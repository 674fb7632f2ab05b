"""A picture of quality over a camera's footprint, as SVG: ground sampled distance beside NIIRS."""

from __future__ import annotations

import math
from collections.abc import Callable

from planner.sensors.optics import Optics
from planner.sensors.photo_band import band
from planner.sensors.quality import Giqe4

#: Cells across and along the image, and pixels of the picture for each panel.
CELLS, PANEL, LEGEND = 24, 320, 60
#: From good to bad.
_GOOD, _BAD = (38, 110, 170), (235, 150, 60)

Corner = tuple[float, float]
#: Ground of a part of the image, ahead and to the right in metres, and its ground sampled distance.
Cell = tuple[tuple[Corner, ...], float]


def gsd_m(optics: Optics, tilt_rad: float, height_m: float, up: float) -> float:
    """Of an image point so far up, as a tangent: the mean of along and across."""
    depth = 1.0 / (math.cos(tilt_rad) - up * math.sin(tilt_rad))
    return optics.gsd_m(height_m) * (depth + depth * depth) / 2.0


def cells(optics: Optics, tilt_rad: float, height_m: float) -> list[Cell]:
    """The image row by row from its lower edge, each from left to right."""
    wide, high = math.tan(optics.half_width_rad), math.tan(optics.half_height_rad)
    cos, sin = math.cos(tilt_rad), math.sin(tilt_rad)

    def ground(u: float, v: float) -> Corner:
        down = cos - v * sin
        return height_m * u / down, height_m * (sin + v * cos) / down

    found: list[Cell] = []
    for row in range(CELLS):
        low, top = (high * (2.0 * (row + k) / CELLS - 1.0) for k in (0, 1))
        for column in range(CELLS):
            left, right = (wide * (2.0 * (column + k) / CELLS - 1.0) for k in (0, 1))
            ring = (ground(left, low), ground(right, low), ground(right, top), ground(left, top))
            found.append((ring, gsd_m(optics, tilt_rad, height_m, (low + top) / 2.0)))
    return found


def picture(name: str, optics: Optics, tilt_rad: float, height_m: float, quality: Giqe4) -> str:
    """The SVG. Raises ValueError where a part of the image looks over the horizon."""
    corners = band(optics, tilt_rad, 0.0).corners
    reach_m = height_m * max(max(abs(left) for _, left in corners), 1e-9)
    low_m, high_m = (height_m * edge(ahead for ahead, _ in corners) for edge in (min, max))
    scale = PANEL / max(2.0 * reach_m, high_m - low_m)
    made = cells(optics, tilt_rad, height_m)
    tall = round((high_m - low_m) * scale) + LEGEND + 40
    body = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * PANEL + 60}" height="{tall}" '
        'font-family="sans-serif" font-size="13">',
        f'<text x="20" y="20">{name}, {height_m:g} m up, tilted {math.degrees(tilt_rad):g}°: '
        f"{2.0 * reach_m:.0f} m wide at its widest, {high_m - low_m:.0f} m long</text>",
    ]
    best, worst = min(gsd for _, gsd in made), max(gsd for _, gsd in made)
    titles = (
        ("ground sampled distance", f"{100.0 * best:.2f} cm", f"{100.0 * worst:.2f} cm"),
        ("NIIRS", f"{quality.niirs(best):.2f}", f"{quality.niirs(worst):.2f}"),
    )
    # NIIRS goes with the logarithm of the distance.
    shades: tuple[Callable[[float], float], ...] = (float, math.log)
    for number, (words, shown) in enumerate(zip(titles, shades, strict=True)):
        left, foot = 20.0 + number * (PANEL + 20), float(tall - LEGEND)
        body += _panel(
            made, shown, lambda c: (c[0] * scale, (c[1] - low_m) * scale), left + PANEL / 2.0, foot
        )
        body += _legend(left, foot, *words)
    return "\n".join([*body, "</svg>", ""])


def _panel(
    made: list[Cell],
    shown: Callable[[float], float],
    placed: Callable[[Corner], Corner],
    middle: float,
    foot: float,
) -> list[str]:
    values = [shown(gsd) for _, gsd in made]
    low, span = min(values), max(max(values) - min(values), 1e-12)
    body = []
    for (ring, _), value in zip(made, values, strict=True):
        places = [placed(corner) for corner in ring]
        points = " ".join(f"{middle + right:.1f},{foot - ahead:.1f}" for right, ahead in places)
        body.append(f'<polygon points="{points}" fill="{_colour((value - low) / span)}"/>')
    return body


def _legend(left: float, foot: float, title: str, best: str, worst: str) -> list[str]:
    body = [f'<text x="{left:.0f}" y="{foot + 22.0:.0f}">{title}</text>']
    for k, (share, said) in enumerate(((0.0, best), (1.0, worst))):
        x = left + 150.0 * k
        body.append(
            f'<rect x="{x:.0f}" y="{foot + 32.0:.0f}" width="14" height="14" fill="{_colour(share)}"/>'
        )
        body.append(f'<text x="{x + 20.0:.0f}" y="{foot + 44.0:.0f}">{said}</text>')
    return body


def _colour(share: float) -> str:
    mixed = (round(good + share * (bad - good)) for good, bad in zip(_GOOD, _BAD, strict=True))
    return "#" + "".join(f"{part:02x}" for part in mixed)
