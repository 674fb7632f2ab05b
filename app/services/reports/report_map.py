"""The report's picture: regions, zones and the flown line as SVG shapes in metres."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from planner.frames import LocalFrame
from planner.geojson.extent import middle_of


@dataclass(frozen=True, slots=True)
class Shape:
    """A closed or open line, or a disc (``radius`` > 0), in picture coordinates."""

    kind: str
    points: str = ""
    x: float = 0.0
    y: float = 0.0
    radius: float = 0.0
    label: str = ""


@dataclass(frozen=True, slots=True)
class Picture:
    """Shapes and the box round them."""

    box: str
    unit: float
    shapes: tuple[Shape, ...]


def draw_map(scenario: dict[str, Any], plan: dict[str, Any]) -> Picture | None:
    """The picture of a plan, None when nothing has a place."""
    features = [*scenario["features"], *plan["features"]]
    places = [place for feature in features for place in _places(feature["geometry"]["coordinates"])]
    if not places:
        return None
    frame = LocalFrame(*middle_of([(place[0], place[1]) for place in places]))
    local_m = frame.to_local([place[:2] for place in places])
    (west, south), (east, north) = local_m.min(axis=0), local_m.max(axis=0)
    width, height = float(east - west), float(north - south)
    unit = max(width, height, 1.0) / 100

    def put(drawn: list[list[float]]) -> list[tuple[float, float]]:
        return [(float(e - west), float(north - n)) for e, n in frame.to_local([at[:2] for at in drawn])]

    shapes = [shape for feature in features for shape in _shapes(feature, put)]
    order = (
        "area", "footprint", "unknown", "roi", "threat", "no_fly", "obstacle", "path", "not_counted",
        "collect", "photos", "start", "end",
    )  # fmt: skip
    shapes = [shape for shape in shapes if shape.kind in order]
    shapes.sort(key=lambda shape: order.index(shape.kind))
    margin = 2 * unit
    box = f"{-margin:.1f} {-margin:.1f} {width + 2 * margin:.1f} {height + 2 * margin:.1f}"
    return Picture(box, unit, tuple(shapes))


def _places(coordinates: Any) -> Iterator[list[float]]:
    if coordinates and isinstance(coordinates[0], (int, float)):
        yield coordinates
        return
    for part in coordinates:
        yield from _places(part)


def _shapes(feature: dict[str, Any], put: Any) -> Iterator[Shape]:
    properties, geometry = feature["properties"], feature["geometry"]
    kind = str(properties["role"])
    label = str(feature.get("id", properties.get("name", "")))
    coordinates = geometry["coordinates"]
    match geometry["type"]:
        case "Point":
            ((x, y),) = put([coordinates])
            yield Shape(kind, x=x, y=y, radius=float(properties.get("radius_m", 0.0)), label=label)
        case "LineString":
            yield Shape(kind, _line(coordinates, put), label=label)
        case "MultiPoint":
            yield Shape(kind, _line(coordinates, put), label=label)
        case "MultiLineString":
            for line in coordinates:
                yield Shape(kind, _line(line, put), label=label)
        case "Polygon":
            yield Shape(kind, _line(coordinates[0], put), label=label)
        case "MultiPolygon":
            for polygon in coordinates:
                yield Shape(kind, _line(polygon[0], put), label=label)


def _line(places: list[list[float]], put: Any) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in put(places))
