"""Surveys, corridor and structure scans of QGroundControl as regions, with the camera and what is asked.

What their items are laid out from is taken over: outline, direction of the transects, camera, overlaps,
height or pixel. The members are those of QGroundControl's plan file format; its heights are over home, over
the sea or over the terrain, its camera in millimetres, its overlaps in percent, its ``ImageDensity`` in
centimetres a pixel.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Literal

from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.shapes import LonLat, Shape

#: ``DistanceMode`` of a camera: what the height counts over.
_OVER = {1: "home", 2: "amsl", 3: "terrain", 4: "terrain"}
_OVER_WORDS = {"home": "over home", "amsl": "above the sea", "terrain": "over the terrain"}
_WORDS = {"survey": "survey", "CorridorScan": "corridor scan", "StructureScan": "structure scan"}
#: A camera that looks further up than this sees the horizon, or next to it, from most lenses.
_MOST_TILT_DEG = 70.0
#: Sides of a chip's pixel may differ by so much before it is told.
_SQUARE = 0.02
_LEFT = {
    "survey": "order, way in, turns and their photos",
    "CorridorScan": "order, way in, turns and their photos",
    "StructureScan": "layers, distance to the walls and the height of the structure: it is photographed from "
    "all round at one height",
}  # fmt: skip


def shapes_of_surveys(document: Mapping[str, Any], notes: Notes) -> list[Shape]:
    """Regions of the complex items of a plan; their cameras go into the members of the notes.

    A survey that cannot be read is left out and found, by its number among its kind.
    """
    mission = document.get("mission")
    items = mission.get("items") if isinstance(mission, dict) else None
    shapes: list[Shape] = []
    counts: dict[str, int] = {}
    cameras = _Cameras(notes)
    for entry in items if isinstance(items, list) else []:
        kind = entry.get("complexItemType", entry.get("type")) if isinstance(entry, dict) else None
        if not isinstance(kind, str) or kind not in _WORDS:
            continue
        counts[kind] = counts.get(kind, 0) + 1
        name = f"{_WORDS[kind]} {counts[kind]}"
        with notes.one_shape(name):
            shapes.append(_region(entry, kind, name, cameras, notes))
    home = mission.get("plannedHomePosition") if shapes and isinstance(mission, dict) else None
    if isinstance(home, list) and len(home) >= 2:
        with notes.one_shape("home"):
            shapes.append(Shape("point", ((_places([home], "home", 1),),), "home", (), {"role": "start"}))
    return shapes


def _region(entry: dict[str, Any], kind: str, name: str, cameras: _Cameras, notes: Notes) -> Shape:
    transects: Any = entry if kind == "StructureScan" else entry.get("TransectStyleComplexItem")
    if not isinstance(transects, dict):
        raise _fault(name, "is of a version without TransectStyleComplexItem")
    calc = transects.get("CameraCalc")
    if not isinstance(calc, dict):
        raise _fault(name, "has no CameraCalc")
    wishes: dict[str, Any] = {}
    taken = ["its outline"]
    shape: Literal["polygon", "line"] = "polygon"
    if kind == "CorridorScan":
        shape = "line"
        positions = _places(entry.get("polyline"), name, 2)
        wishes["width_m"] = _positive(entry, "CorridorWidth", name)
        taken = [f"its line, {wishes['width_m']:g} m wide"]
    else:
        positions = _places(entry.get("polygon"), name, 3)
        positions = (*positions, positions[0])
    if kind == "survey":
        angle_deg = _number(entry, "angle", name) % 180.0
        crossed = transects.get("Refly90Degrees") is True
        headings = [angle_deg + more for more in ((0.0, 90.0, 180.0, 270.0) if crossed else (0.0, 180.0))]
        wishes["approach_deg"] = sorted(round(heading % 360.0, 6) for heading in headings)
        taken.append(f"headings {' and '.join(f'{heading:g}°' for heading in wishes['approach_deg'])}")
        if crossed:
            wishes["pattern"] = "crosshatch"
            taken.append("the second set of transects across")
    if kind == "StructureScan":
        wishes["pattern"] = "orbit"
    sensor = cameras.of(calc, entry, kind, name)
    if sensor is not None:
        wishes["sensor"] = sensor["name"]
        taken.append(f"the camera {sensor['name']} with its overlaps")
    taken.append(_height(calc, transects, entry, kind, name, wishes, cameras))
    lacks = "" if sensor is not None else ". No camera is known to it: name one in sensors"
    notes.append(f"{name}: taken over are {', '.join(taken)}; not {_LEFT[kind]}{lacks}")
    return Shape(shape, ((tuple(positions),),), name, (_WORDS[kind],), {"role": "roi"}, wishes=wishes)


def _height(
    calc: dict[str, Any],
    transects: dict[str, Any],
    entry: dict[str, Any],
    kind: str,
    name: str,
    wishes: dict[str, Any],
    cameras: _Cameras,
) -> str:
    """Put in the height, or the pixel where that was set and the height followed; what it was, in words."""
    if kind == "StructureScan":
        wishes["altitude_m"] = _positive(entry, "EntranceAltitude", name)
        cameras.reference("home", name, wishes)
        return f"its entrance's height, {wishes['altitude_m']:g} m over home"
    if calc.get("ValueSetIsDistance") is False and "ImageDensity" in calc:
        wishes["gsd_m"] = round(_positive(calc, "ImageDensity", name) / 100.0, 9)
        return f"a pixel of {100.0 * wishes['gsd_m']:.3g} cm, which decides the height"
    if transects.get("FollowTerrain") is True:
        over = "terrain"
    elif "DistanceMode" in calc:
        over = _OVER.get(calc["DistanceMode"], "home") if isinstance(calc["DistanceMode"], int) else "home"
    else:
        over = "amsl" if calc.get("DistanceToSurfaceRelative") is False else "home"
    wishes["altitude_m"] = _positive(calc, "DistanceToSurface", name)
    words = f"its height, {wishes['altitude_m']:g} m {_OVER_WORDS[over]}"
    return words if cameras.reference(over, name, wishes) else "no height: another survey's counts otherwise"


class _Cameras:
    """Cameras of the surveys by name, alike ones once, and what their heights count over."""

    def __init__(self, notes: Notes) -> None:
        self._notes = notes

    def reference(self, over: str, name: str, wishes: dict[str, Any]) -> bool:
        """Whether heights may count over this; the first of a file decides, others lose theirs."""
        first = self._notes.members.setdefault("altitude_reference", over)
        if first == over:
            return True
        altitude_m = wishes.pop("altitude_m")
        self._notes.append(
            f"{name}: its {altitude_m:g} m count {_OVER_WORDS[over]}, those of the others "
            f"{_OVER_WORDS[first]}: give its altitude_m {_OVER_WORDS[first]}"
        )
        return False

    def of(self, calc: dict[str, Any], entry: dict[str, Any], kind: str, name: str) -> dict[str, Any] | None:
        """The camera as an entry of ``sensors``; None where only footprints are given."""
        if not {"FocalLength", "SensorWidth", "ImageWidth"} <= calc.keys():
            return None
        focal_mm, wide_mm = _positive(calc, "FocalLength", name), _positive(calc, "SensorWidth", name)
        columns, rows = _positive(calc, "ImageWidth", name), _positive(calc, "ImageHeight", name)
        pitch_mm = wide_mm / columns
        other_mm = _positive(calc, "SensorHeight", name) / rows if "SensorHeight" in calc else pitch_mm
        if abs(other_mm / pitch_mm - 1.0) > _SQUARE:
            self._notes.append(
                f"{name}: its pixels are {1000.0 * pitch_mm:.3g} by {1000.0 * other_mm:.3g} µm; "
                "they count as square, by the width"
            )
        across = [round(columns), round(rows)]
        sensor: dict[str, Any] = {
            "type": "camera",
            "focal_length_m": round(focal_mm / 1000.0, 9),
            "pixel_pitch_m": round(pitch_mm / 1000.0, 12),
            "image_px": across if calc.get("Landscape", True) is not False else across[::-1],
            "forward_overlap": _share(calc, "FrontalOverlap", name),
            "side_overlap": _share(calc, "SideOverlap", name),
        }
        interval_s = _number(calc, "MinTriggerInterval", name) if "MinTriggerInterval" in calc else 0.0
        if interval_s > 0.0:
            sensor["min_interval_s"] = interval_s
        if kind == "StructureScan":
            tilt_deg = 90.0 + _number(entry, "GimbalPitch", name)
            if 0.0 < tilt_deg <= _MOST_TILT_DEG:
                sensor["tilt_deg"] = round(tilt_deg, 6)
        else:
            # as QGroundControl lays its transects out
            sensor["edge_overlap"] = False
        return self._named(sensor, str(calc.get("CameraName") or "camera")[:60])

    def _named(self, sensor: dict[str, Any], called: str) -> dict[str, Any]:
        known: list[dict[str, Any]] = self._notes.members.setdefault("sensors", [])
        alike = next((each for each in known if {**each, "name": ""} == {"name": "", **sensor}), None)
        if alike is not None:
            return alike
        taken = {each["name"] for each in known}
        name, count = called, 1
        while name in taken:
            count += 1
            name = f"{called} {count}"
        known.append({"name": name, **sensor})
        return known[-1]


def _fault(name: str, message: str) -> Exception:
    return file_error(
        "survey", f"{name} {message}", "open the plan in QGroundControl, mend it and save it again"
    )


def _number(members: Mapping[str, Any], key: str, name: str) -> float:
    value = members.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise _fault(name, f"has {key} {str(value)[:40]!r}, a number is meant")
    return float(value)


def _positive(members: Mapping[str, Any], key: str, name: str) -> float:
    value = _number(members, key, name)
    if not 0.0 < value < 1e6:
        raise _fault(name, f"has {key} {value:g}, a positive number is meant")
    return value


def _share(members: Mapping[str, Any], key: str, name: str) -> float:
    percent = _number(members, key, name)
    if not 0.0 <= percent < 100.0:
        raise _fault(name, f"has {key} {percent:g}, percent below 100 are meant")
    return round(percent / 100.0, 6)


def _places(value: Any, name: str, least: int) -> tuple[LonLat, ...]:
    if not isinstance(value, list) or len(value) < least:
        raise _fault(name, f"has fewer than {least} places")
    places: list[LonLat] = []
    for each in value:
        if not isinstance(each, list) or len(each) < 2:
            raise _fault(name, "has a place that is none")
        members = {"latitude": each[0], "longitude": each[1]}
        places.append((_number(members, "longitude", name), _number(members, "latitude", name)))
    return tuple(places)
