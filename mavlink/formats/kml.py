"""A plan as KML, for looking at it on a globe."""

from __future__ import annotations

import math
import threading
from collections.abc import Sequence

import simplekml

from mavlink.wire.geometry import LocalMap, here, offset
from planner.plan import (
    Collect,
    FlownPath,
    Footprint,
    LonLat,
    LonLatAlt,
    Photos,
    Plan,
    ZoneCircle,
    ZonePolygon,
)

_PATH = "ff00a5ff"
_COLLECT = "ff00ff00"
_FOOTPRINT = "4000ff00"
_AREA = "ffffffff"
_BARRED = "400000ff"
_CIRCLE_POINTS = 72
#: Of the icons every viewer has.
_DOT = "http://maps.google.com/mapfiles/kml/shapes/placemark_circle.png"

#: simplekml counts its ids, and keeps what it is writing, in class variables.
_LOCK = threading.Lock()


def write_kml(plan: Plan, vehicle: str | None = None) -> str:
    """The paths, collects, photos and footprints of a plan, and its fence, as a KML document.

    Parameters
    ----------
    plan
        As checked.
    vehicle
        Name of one vehicle; None for all.

    Raises
    ------
    ValueError
        Where the plan has no such vehicle.
    """
    names = [v.name for v in plan.vehicles if vehicle in (None, v.name)]
    if not names:
        raise ValueError(f"the plan has no vehicle {vehicle!r}")
    mode = (
        simplekml.AltitudeMode.absolute
        if plan.altitude_reference == "amsl"
        else simplekml.AltitudeMode.relativetoground
    )
    with _LOCK:
        simplekml.Kml.resetidcounter()
        return _document(plan, names, mode)


def _document(plan: Plan, names: list[str], mode: str) -> str:
    document = simplekml.Kml(name=_text(plan.name))
    home = document.newpoint(name="home", coords=[here(plan.home)])
    home.description = "Take-off"
    for name in names:
        folder = document.newfolder(name=_text(name))
        for path in plan.paths:
            if path.vehicle == name:
                _add_path(folder, path, mode)
        for collect in plan.collects_of(name):
            _add_collect(folder, collect, mode)
        for photos in plan.photos_of(name):
            _add_photos(folder, photos, mode)
        for footprint in plan.footprints:
            if footprint.vehicle == name:
                _add_footprint(folder, footprint)
    fence = document.newfolder(name="fence")
    for zone in plan.fence.inclusion:
        _add_zone(fence, zone, barred=False)
    for zone in plan.fence.exclusion:
        _add_zone(fence, zone, barred=True)
    for circle in plan.fence.exclusion_circles:
        _add_circle(fence, circle)
    return str(document.kml())


def _add_path(folder: simplekml.Folder, path: FlownPath, mode: str) -> None:
    line = folder.newlinestring(name=f"path of {_text(path.vehicle)}", coords=_line(path.line))
    line.altitudemode = mode
    line.description = f"{path.length_m / 1000.0:.2f} km, {path.duration_s:.0f} s"
    line.style.linestyle.color = _PATH
    line.style.linestyle.width = 2


def _add_collect(folder: simplekml.Folder, collect: Collect, mode: str) -> None:
    line = folder.newlinestring(
        name=f"collect {collect.seq}: {_text(collect.roi)}", coords=_line(collect.line)
    )
    line.altitudemode = mode
    line.description = _text(
        f"sensor {collect.sensor} looking {collect.look}, heading {collect.heading_deg:.1f}°, "
        f"{collect.end_m - collect.start_m:.0f} m"
    )
    line.style.linestyle.color = _COLLECT
    line.style.linestyle.width = 5


def _add_photos(folder: simplekml.Folder, photos: Photos, mode: str) -> None:
    """The places of one collect's photos, as one thing that can be hidden."""
    places = folder.newmultigeometry(name=f"photos {photos.seq}: {_text(photos.sensor)}")
    places.description = f"{len(photos.places)} photos, every {photos.interval_m:.1f} m"
    places.style.iconstyle.icon.href = _DOT
    places.style.iconstyle.scale = 0.5
    for place in _line(photos.places):
        point = places.newpoint(coords=[place])
        point.altitudemode = mode


def _add_footprint(folder: simplekml.Folder, footprint: Footprint) -> None:
    polygon = folder.newpolygon(
        name=f"footprint {footprint.seq}: {_text(footprint.roi)}", outerboundaryis=_closed(footprint.ring)
    )
    polygon.altitudemode = simplekml.AltitudeMode.clamptoground
    polygon.style.polystyle.color = _FOOTPRINT
    polygon.style.linestyle.color = _COLLECT


def _add_zone(folder: simplekml.Folder, zone: ZonePolygon, *, barred: bool) -> None:
    polygon = folder.newpolygon(name=_text(zone.name), outerboundaryis=_closed(zone.ring))
    polygon.altitudemode = simplekml.AltitudeMode.clamptoground
    polygon.style.polystyle.fill = int(barred)
    polygon.style.polystyle.color = _BARRED
    polygon.style.linestyle.color = _AREA


def _add_circle(folder: simplekml.Folder, circle: ZoneCircle) -> None:
    local = LocalMap(circle.centre)
    ring = tuple(
        local.lonlat(offset((0.0, 0.0), 2.0 * math.pi * n / _CIRCLE_POINTS, circle.radius_m))
        for n in range(_CIRCLE_POINTS)
    )
    _add_zone(folder, ZonePolygon(circle.name, ring), barred=True)


def _line(line: Sequence[LonLatAlt]) -> list[LonLatAlt]:
    """Within ±180°, as KML has it; viewers draw the short way across."""
    return [(*here((lon, lat)), altitude_m) for lon, lat, altitude_m in line]


def _closed(ring: Sequence[LonLat]) -> list[LonLat]:
    places = [here(place) for place in ring]
    return [*places, places[0]] if places[0] != places[-1] else places


def _text(text: str) -> str:
    """Text that XML can hold; simplekml escapes it, but for what looks like a CDATA section."""
    held = "".join(character for character in text if character in "\t\n\r" or _is_xml(ord(character)))
    return held.replace("<![CDATA[", "[CDATA[")


def _is_xml(code: int) -> bool:
    return 0x20 <= code <= 0xD7FF or 0xE000 <= code <= 0xFFFD or code >= 0x10000
