"""A picture of turns at waypoints and of arcs onto and off a segment, as SVG."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from planner.dubins.path import Path, Segment
from planner.dubins.segment_arcs import egress, ingress
from planner.route import Point, Pose

PANEL, HEIGHT, FOOT = 260, 300, 30
#: Pixels a turn radius.
SCALE = 42.0
COLOURS = {"three-arc": "#1565c0", "past-target": "#c62828", "short-turn": "#2e7d32"}
LEG, CIRCLE, SEGMENT = "#999", "#bbb", "#e69f00"

Lines = Sequence[tuple[str, Sequence[Point], Mapping[str, Path]]]


def picture(corners: Lines, radius_m: float) -> str:
    """Panels of turns by name beside each other, then one of a segment with its circles."""
    wide = PANEL * (len(corners) + 1)
    body = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {HEIGHT + FOOT}" '
        'font-family="sans-serif" font-size="12">',
        "<title>Turns at a waypoint by name, and the arcs onto and off a segment</title>",
        f'<rect width="{wide}" height="{HEIGHT + FOOT}" fill="#fff"/>',
        '<clipPath id="panel"><rect width="250" height="300"/></clipPath>',
    ]
    for number, (title, legs, lines) in enumerate(corners):
        body.append(_opened(number, title))
        body.append(_polyline(legs, radius_m, LEG, dashed=True))
        body += [_polyline(_points(path), radius_m, COLOURS[name]) for name, path in lines.items()]
        body += [_dot(legs[1], radius_m), "</g></g>"]
    body.append(_opened(len(corners), "onto and off a segment"))
    body += [*_segment(radius_m), "</g></g>"]
    for number, (name, colour) in enumerate(COLOURS.items()):
        left, foot = 12 + 150 * number, HEIGHT + 20
        body.append(
            f'<path d="M{left} {foot - 4}h24" stroke="{colour}" stroke-width="2"/>'
            f'<text x="{left + 30}" y="{foot}">{name}</text>'
        )
    return "\n".join([*body, "</svg>", ""])


def _opened(number: int, title: str) -> str:
    """A panel, its origin in the middle and a little to the right."""
    return (
        f'<g transform="translate({PANEL * number},0)" clip-path="url(#panel)">'
        f'<text x="10" y="20">{title}</text><g transform="translate(150,190)" fill="none" stroke-width="1.6">'
    )


def _points(path: Path) -> list[Point]:
    return [(float(row[0]), float(row[1])) for row in path.sample(2.0)]


def _placed(point: Point, radius_m: float) -> tuple[float, float]:
    return SCALE * point[0] / radius_m, -SCALE * point[1] / radius_m


def _polyline(points: Sequence[Point], radius_m: float, colour: str, *, dashed: bool = False) -> str:
    said = " ".join(f"{x:.1f},{y:.1f}" for x, y in (_placed(point, radius_m) for point in points))
    dash = ' stroke-dasharray="5 4"' if dashed else ""
    return f'<polyline points="{said}" stroke="{colour}"{dash}/>'


def _dot(point: Point, radius_m: float) -> str:
    x, y = _placed(point, radius_m)
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#000"/>'


def _circle(arc: Segment, radius_m: float) -> str:
    if arc.centre is None:
        raise ValueError("a straight has no circle")
    x, y = _placed(arc.centre, radius_m)
    across = SCALE * arc.radius_m / radius_m
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{across:.1f}" stroke="{CIRCLE}" stroke-dasharray="2 3"/>'


def _segment(radius_m: float) -> list[str]:
    """A segment flown northwards: the arc before it is wider than the arcs onto and off it."""
    begin, end = (0.2 * radius_m, -0.2 * radius_m), (0.2 * radius_m, 1.2 * radius_m)
    before, after = (-2.6 * radius_m, 1.4 * radius_m), (1.9 * radius_m, 1.6 * radius_m)
    first = Segment("left", Pose(*before, -0.7 * math.pi), 1.0, 1.2 * radius_m)
    onto = ingress(first, before, Pose(*begin, 0.5 * math.pi), 0.8 * radius_m)
    off = egress(Pose(*end, 0.5 * math.pi), after, 0.8 * radius_m)
    if onto is None or off is None:
        raise ValueError("the picture's own segment has no arcs")
    arcs = (onto.segments[0], onto.segments[2], off.segments[0])
    return [
        *(_circle(arc, radius_m) for arc in arcs),
        _polyline(_points(onto), radius_m, COLOURS["three-arc"]),
        _polyline([begin, end], radius_m, SEGMENT),
        _polyline(_points(off), radius_m, COLOURS["three-arc"]),
        *(_dot(point, radius_m) for point in (before, begin, end, after)),
    ]
