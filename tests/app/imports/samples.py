"""Region files made for tests."""

from __future__ import annotations

import io
import zipfile

import shapefile
from pyproj import CRS

RING = [(8.5, 47.3), (8.6, 47.3), (8.6, 47.4), (8.5, 47.4), (8.5, 47.3)]
HOLE = [(8.52, 47.32), (8.52, 47.34), (8.54, 47.34), (8.54, 47.32), (8.52, 47.32)]


def coordinates(places: list[tuple[float, float]], height_m: float = 400.0) -> str:
    return " ".join(f"{lon},{lat},{height_m}" for lon, lat in places)


def _ring(ring: list[tuple[float, float]]) -> str:
    return f"<LinearRing><coordinates>{coordinates(ring)}</coordinates></LinearRing>"


def polygon(ring: list[tuple[float, float]], *holes: list[tuple[float, float]]) -> str:
    inner = "".join(f"<innerBoundaryIs>{_ring(hole)}</innerBoundaryIs>" for hole in holes)
    outer = f"<outerBoundaryIs>{_ring(ring)}</outerBoundaryIs>"
    return f"<Polygon>{outer}{inner}</Polygon>"


def line(places: list[tuple[float, float]]) -> str:
    return f"<LineString><coordinates>\n {coordinates(places)}\n</coordinates></LineString>"


def point(lon: float, lat: float) -> str:
    return f"<Point><coordinates>{lon},{lat}</coordinates></Point>"


def placemark(name: str, geometry: str, **data: object) -> str:
    values = "".join(f'<Data name="{key}"><value>{value}</value></Data>' for key, value in data.items())
    return f"<Placemark><name>{name}</name><ExtendedData>{values}</ExtendedData>{geometry}</Placemark>"


def folder(name: str, *parts: str) -> str:
    return f"<Folder><name>{name}</name>{''.join(parts)}</Folder>"


def kml(*parts: str) -> bytes:
    body = "".join(parts)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2">'
        f"<Document><name>d</name>{body}</Document></kml>"
    ).encode()


def packed(members: dict[str, bytes]) -> bytes:
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def shapefiles(
    rings: list[list[list[tuple[float, float]]]], names: list[str], crs: str | None = "EPSG:4326"
) -> dict[str, bytes]:
    """A shapefile of polygons, written by pyshp: content by ending."""
    shp, shx, dbf = io.BytesIO(), io.BytesIO(), io.BytesIO()
    with shapefile.Writer(shp=shp, shx=shx, dbf=dbf) as writer:
        writer.field("NAME", "C", size=40)
        writer.field("height_m", "N", size=10, decimal=2)
        for parts, name in zip(rings, names, strict=True):
            writer.poly(parts)
            writer.record(name, 12.5)
    found = {".shp": shp.getvalue(), ".shx": shx.getvalue(), ".dbf": dbf.getvalue()}
    if crs is not None:
        found[".prj"] = CRS.from_user_input(crs).to_wkt("WKT1_ESRI").encode()
    return found


def archive_of(files: dict[str, bytes], stem: str = "fields") -> bytes:
    return packed({stem + ending: content for ending, content in files.items()})


GPX = b"""<?xml version="1.0"?>
<gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1">
<wpt lat="47.31" lon="8.51"><name>mast</name></wpt>
<rte><name>power line</name><rtept lat="47.3" lon="8.5"/><rtept lat="47.31" lon="8.52"/></rte>
<trk><name>river</name><trkseg>
<trkpt lat="47.30" lon="8.50"><ele>400</ele></trkpt>
<trkpt lat="47.31" lon="8.50"><ele>401</ele></trkpt>
<trkpt lat="47.32" lon="8.500000001"><ele>402</ele></trkpt>
<trkpt lat="47.32" lon="8.52"><ele>403</ele></trkpt>
</trkseg></trk></gpx>"""
