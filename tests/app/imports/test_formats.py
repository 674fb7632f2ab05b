"""Files of every format, written by other writers than ours, are read back as they were drawn."""

from __future__ import annotations

import csv
import io
import json
import random
from collections.abc import Callable
from typing import Any

import pytest
import shapefile
import shapely
import simplekml
from pymavlink import mavwp
from pyproj import CRS, Transformer
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, mapping, shape
from shapely.geometry.base import BaseGeometry

from app.imports import Imported, ImportOptions, RegionFileError, import_regions
from tests.app.imports.samples import packed

Drawn = list[tuple[str, BaseGeometry]]
OPTIONS = ImportOptions("roi", width_m=10.0)


def drawn(dice: random.Random) -> Drawn:
    """Named polygons with and without holes, many in one, lines and points, apart from each other."""
    found: Drawn = []
    for index in range(dice.randint(1, 6)):
        lon, lat = 8.0 + 0.2 * index, 47.0 + dice.uniform(-0.05, 0.05)
        disc = Point(lon, lat).buffer(dice.uniform(0.01, 0.04), quad_segs=dice.randint(1, 5))
        kind = dice.choice(["polygon", "holed", "many", "line", "point"])
        geometry: BaseGeometry = disc
        if kind == "holed":
            geometry = disc.difference(Point(lon, lat).buffer(0.004, quad_segs=2))
        elif kind == "many":
            geometry = MultiPolygon([disc, shapely.affinity.translate(disc, 0.0, 0.2)])
        elif kind == "line":
            geometry = LineString(disc.exterior.coords[: dice.randint(2, 3)])
        elif kind == "point":
            geometry = Point(lon, lat)
        found.append((f"shape {index} {dice.choice(['Süd', '农田', 'A&B'])}", geometry))
    return found


def polygons_only(items: Drawn) -> Drawn:
    return [item for item in items if isinstance(item[1], (Polygon, MultiPolygon))] or [
        ("only", Point(8.0, 47.0).buffer(0.01))
    ]


def by_simplekml(items: Drawn) -> bytes:
    """As KML, by simplekml."""
    document = simplekml.Kml()
    for name, geometry in items:
        parts = getattr(geometry, "geoms", [geometry])
        holder = document.newmultigeometry(name=name) if len(parts) > 1 else document
        for part in parts:
            if isinstance(part, Polygon):
                holder.newpolygon(
                    name=name,
                    outerboundaryis=list(part.exterior.coords),
                    innerboundaryis=[list(ring.coords) for ring in part.interiors],
                )
            elif isinstance(part, LineString):
                holder.newlinestring(name=name, coords=list(part.coords))
            else:
                holder.newpoint(name=name, coords=list(part.coords))
    return document.kml().encode()


def by_simplekml_packed(items: Drawn) -> bytes:
    return packed({"doc.kml": by_simplekml(items), "files/x.png": b""})


def by_pyshp(items: Drawn) -> bytes:
    """As a zipped shapefile in UTM, by pyshp and pyproj."""
    move = Transformer.from_crs("EPSG:4326", "EPSG:32632", always_xy=True)
    shp, shx, dbf = io.BytesIO(), io.BytesIO(), io.BytesIO()
    with shapefile.Writer(shp=shp, shx=shx, dbf=dbf) as writer:
        writer.field("Name", "C", size=60)
        for name, geometry in polygons_only(items):
            writer.shape(mapping(shapely.transform(geometry, move.transform, interleaved=False)))
            writer.record(name)
    files = {"a.shp": shp, "a.shx": shx, "a.dbf": dbf}
    prj = CRS.from_epsg(32632).to_wkt("WKT1_ESRI").encode()
    return packed(
        {name: stream.getvalue() for name, stream in files.items()} | {"a.prj": prj, "a.cpg": b"UTF-8"}
    )


def _features(items: Drawn) -> list[dict[str, Any]]:
    return [
        {
            "type": "Feature",
            "properties": {"Name": name},
            "geometry": json.loads(shapely.to_geojson(geometry)),
        }
        for name, geometry in items
    ]


def by_shapely(items: Drawn) -> bytes:
    return json.dumps({"type": "FeatureCollection", "features": _features(items)}).encode()


def by_lines(items: Drawn) -> bytes:
    return "\n".join(
        json.dumps(one) for one in [*_features(items), *_features([("last", Point(1, 2))])]
    ).encode()


def by_sequence(items: Drawn) -> bytes:
    return "".join(f"\x1e{json.dumps(one)}\n" for one in _features(items)).encode()


def by_wkt(items: Drawn) -> bytes:
    return "\n".join(
        f"SRID=4326;{shapely.to_wkt(geometry, rounding_precision=-1)}" for _, geometry in items
    ).encode()


def by_csv(items: Drawn) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["Name", "WKT", "crop"])
    for name, geometry in items:
        writer.writerow([name, shapely.to_wkt(geometry, rounding_precision=-1), "rye, late"])
    return text.getvalue().encode("utf-8-sig")


def by_arcgis(items: Drawn) -> bytes:
    """As Esri JSON, in web Mercator: outer rings clockwise, holes the other way."""
    move = Transformer.from_crs("EPSG:4326", "EPSG:3857", always_xy=True)
    features = []
    for name, geometry in polygons_only(items):
        flat = shapely.orient_polygons(
            shapely.transform(geometry, move.transform, interleaved=False), exterior_cw=True
        )
        rings = [
            list(map(list, ring.coords))
            for part in getattr(flat, "geoms", [flat])
            for ring in (part.exterior, *part.interiors)
        ]
        features.append({"attributes": {"OBJECTID": 1, "Label": name}, "geometry": {"rings": rings}})
    head = {"geometryType": "esriGeometryPolygon", "spatialReference": {"wkid": 102100, "latestWkid": 3857}}
    return json.dumps(head | {"features": features}).encode()


def by_gml(items: Drawn) -> bytes:
    """As GML 3.2 in the authority's order, latitude first, by GEOS' coordinates."""

    def ring(coords: Any) -> str:
        numbers = " ".join(f"{lat!r} {lon!r}" for lon, lat in coords)
        return f"<gml:LinearRing><gml:posList>{numbers}</gml:posList></gml:LinearRing>"

    def one(part: Polygon) -> str:
        inner = "".join(f"<gml:interior>{ring(hole.coords)}</gml:interior>" for hole in part.interiors)
        return f"<gml:Polygon><gml:exterior>{ring(part.exterior.coords)}</gml:exterior>{inner}</gml:Polygon>"

    members = []
    for name, geometry in polygons_only(items):
        parts = "".join(
            f"<gml:surfaceMember>{one(part)}</gml:surfaceMember>"
            for part in getattr(geometry, "geoms", [geometry])
        )
        surface = f'<gml:MultiSurface srsName="urn:ogc:def:crs:EPSG::4326">{parts}</gml:MultiSurface>'
        name = name.replace("&", "&amp;")
        members.append(
            f"<f:featureMember><f:field><f:name>{name}</f:name><f:g>{surface}</f:g></f:field></f:featureMember>"
        )
    return (
        '<f:FeatureCollection xmlns:f="urn:f" xmlns:gml="http://www.opengis.net/gml/3.2">'
        f"{''.join(members)}</f:FeatureCollection>"
    ).encode()


WRITERS: dict[str, tuple[Callable[[Drawn], bytes], str]] = {
    "KML by simplekml": (by_simplekml, "kml"),
    "KMZ by simplekml": (by_simplekml_packed, "kmz"),
    "shapefile by pyshp": (by_pyshp, "shapefile"),
    "GeoJSON by GEOS": (by_shapely, "geojson"),
    "GeoJSON lines": (by_lines, "geojsonl"),
    "GeoJSON sequence": (by_sequence, "geojsonl"),
    "WKT by GEOS": (by_wkt, "wkt"),
    "CSV with WKT": (by_csv, "csv"),
    "Esri JSON": (by_arcgis, "esrijson"),
    "GML": (by_gml, "gml"),
}


def _same(found: Imported, wanted: Drawn, *, named: bool) -> None:
    got = {
        feature["properties"]["name"]: shape(feature["geometry"]) for feature in found.collection["features"]
    }
    left = list(got.values())
    for name, geometry in wanted:
        mine = got[name] if named else min(left, key=lambda one: one.hausdorff_distance(geometry))
        assert mine.geom_type == geometry.geom_type
        # an edge that is straight on a map projection is not in degrees: a metre on these of some kilometres
        assert mine.hausdorff_distance(geometry) < 1e-5
        if geometry.area > 0.0:
            assert mine.symmetric_difference(geometry).area < 3e-4 * geometry.area


@pytest.mark.parametrize("kind", WRITERS)
def test_what_is_written_is_read(kind: str) -> None:
    """Random shapes come back under their names with their outlines and holes."""
    write, form = WRITERS[kind]
    dice = random.Random(kind)
    for _ in range(12):
        items = drawn(dice)
        found = import_regions(write(items), OPTIONS)
        assert found.format == form
        only = polygons_only(items) if kind in ("shapefile by pyshp", "Esri JSON", "GML") else items
        _same(found, only, named=kind != "WKT by GEOS" and "sequence" not in kind)


@pytest.mark.parametrize(
    ("head", "rows"),
    [
        ("name,lat,lon", ["a,47.5,8.25", "b,-12,170.5"]),
        ("Name;Latitude;Longitude;note", ["a;47,5;8,25;x", "b;-12;170,5;"]),
        ("id\tLNG\tLAT", ["a\t8.25\t47.5", "b\t170.5\t-12.0"]),
        ("\ufefflabel|x|y", ["a|8.25|47.5", "b|170.5|-12"]),
        ("纬度,经度,名称", ["47.5,8.25,a", "-12,170.5,b"]),
        ("name,lat,long", ["a,47°30'N,8°15'00\"E", "b,12 00 00 S,170°30'0\"E"]),
    ],
)
def test_tables_of_places_are_points(head: str, rows: list[str]) -> None:
    """Whatever divides the columns and whatever they are called; rows without a place are noted."""
    data = "\r\n".join([head, *rows, ""]).encode()
    features = import_regions(data, OPTIONS).collection["features"]
    assert [feature["geometry"]["coordinates"] for feature in features] == [[8.25, 47.5], [170.5, -12.0]]
    assert [feature["properties"]["name"] for feature in features] == ["a", "b"]


def test_a_table_in_a_projection_needs_its_code() -> None:
    """Eastings and northings are moved from the reference system given."""
    east, north = Transformer.from_crs("EPSG:4326", "EPSG:32632", always_xy=True).transform(8.25, 47.5)
    data = f"name,easting,northing\na,{east!r},{north!r}\n".encode()
    (feature,) = import_regions(data, ImportOptions("roi", crs="EPSG:32632")).collection["features"]
    assert feature["geometry"]["coordinates"] == pytest.approx([8.25, 47.5], abs=1e-8)
    with pytest.raises(RegionFileError) as caught:
        import_regions(data, OPTIONS)
    assert caught.value.findings[0].rule == "latitude-out-of-range"


def test_fences_and_rally_points_of_mavproxy_are_read() -> None:
    """What pymavlink's loaders save is the area and the bases; the place to return to is no region."""
    fence = mavwp.MAVFenceLoader()
    corners = [(-35.36, 149.16), (-35.37, 149.16), (-35.37, 149.17), (-35.36, 149.17)]
    for lat, lon in [(-35.365, 149.165), *corners, corners[0]]:
        fence.add_latlon(lat, lon)
    saved = "".join(f"{point.lat:f}\t{point.lng:f}\n" for point in fence.points).encode()
    found = import_regions(saved)
    (area,) = found.collection["features"]
    assert (found.format, area["properties"]["role"]) == ("mission", "area")
    wanted = Polygon([(lon, lat) for lat, lon in corners])
    # the loader keeps single precision
    assert shape(area["geometry"]).symmetric_difference(wanted).area < 1e-6
    rally = b"RALLY -35.36 149.16 100 0 0 0\nRALLY -35.37 149.17 90 0 0 0\n"
    bases = import_regions(rally).collection["features"]
    assert [base["properties"]["role"] for base in bases] == ["base", "base"]
    assert bases[0]["geometry"]["coordinates"] == pytest.approx([149.16, -35.36])


def test_fences_of_plans_keep_their_side() -> None:
    """Inclusion is the area, exclusion a no-fly zone, circles too; a part that is no shape refuses all."""
    inside = [[47.3, 8.5], [47.3, 8.6], [47.4, 8.6]]
    plan: dict[str, Any] = {
        "fileType": "Plan",
        "version": 1,
        "groundStation": "x",
        "mission": {
            "version": 2,
            "firmwareType": 3,
            "vehicleType": 1,
            "items": [],
            "plannedHomePosition": [47, 8, 0],
        },
        "geoFence": {
            "version": 2,
            "polygons": [
                {"version": 1, "inclusion": True, "polygon": inside},
                {"version": 1, "inclusion": False, "polygon": inside},
            ],
            "circles": [
                {"version": 1, "inclusion": False, "circle": {"center": [47.35, 8.55], "radius": 120.0}}
            ],
        },
        "rallyPoints": {"version": 2, "points": [[47.3, 8.5, 50.0]]},
    }
    features = import_regions(json.dumps(plan).encode()).collection["features"]
    assert [feature["properties"]["role"] for feature in features] == ["area", "no_fly", "no_fly", "base"]
    assert features[2]["properties"]["radius_m"] == 120.0
    plan["geoFence"]["polygons"][1]["polygon"] = [[47.3, 8.5]]
    with pytest.raises(RegionFileError) as caught:
        import_regions(json.dumps(plan).encode())
    assert caught.value.findings[0].rule == "fence-not-whole"


DJI = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.2"><Document>
<wpml:missionConfig><wpml:takeOffRefPoint>47.31,8.51,400</wpml:takeOffRefPoint></wpml:missionConfig>
<Folder><wpml:templateType>mapping2d</wpml:templateType>{}</Folder></Document></kml>"""


def test_routes_of_dji_are_regions_and_a_line() -> None:
    """The area of a survey is a region, waypoints are one line; the route made of a template is left out."""
    ring = "8.5,47.3,0 8.6,47.3,0 8.6,47.4,0"
    area = (
        f"<Placemark><Polygon><outerBoundaryIs><LinearRing><coordinates>{ring}</coordinates></LinearRing>"
        "</outerBoundaryIs></Polygon></Placemark>"
    )
    places = "".join(
        f"<Placemark><Point><coordinates>8.5,{47 + n / 10}</coordinates></Point><wpml:index>{n}</wpml:index>"
        "</Placemark>"
        for n in range(3)
    )
    template, route = DJI.format(area).encode(), DJI.format(places).encode()
    both = import_regions(packed({"wpmz/template.kml": template, "wpmz/waylines.wpml": route}), OPTIONS)
    assert [(a.kind, a.role) for a in both.shapes] == [("point", "start"), ("polygon", "roi")]
    alone = import_regions(packed({"wpmz/waylines.wpml": route}), OPTIONS)
    (way,) = [f for f in alone.collection["features"] if f["properties"]["role"] == "roi"]
    assert way["geometry"]["coordinates"] == [[8.5, 47.0], [8.5, 47.1], [8.5, 47.2]]


def test_placemarks_of_a_schema_are_placemarks() -> None:
    """KML 2.0 and 2.1 name elements and fields of their own by a schema; KML 2.2 has data by a schema."""
    outline = "<LineString><coordinates>8,47 8,48 9,48 8,47</coordinates></LineString>"
    old = (
        '<kml xmlns="http://earth.google.com/kml/2.1"><Document><Schema name="Zone" parent="Placemark">'
        '<SimpleField type="string" name="Use"/></Schema>'
        f"<Zone><name>a</name><Use>No fly</Use>{outline}</Zone></Document></kml>"
    )
    new = (
        '<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Schema name="Zone" id="z">'
        '<SimpleField type="string" name="Use"/></Schema><Placemark><name>a</name><ExtendedData>'
        '<SchemaData schemaUrl="#z"><SimpleData name="Use">No fly</SimpleData></SchemaData></ExtendedData>'
        f"{outline}</Placemark></Document></kml>"
    )
    for document in (old, new):
        (account,) = import_regions(document.encode()).shapes
        assert (account.name, account.role) == ("a", "no_fly")


def test_collections_within_collections_have_an_end() -> None:
    """Well-known text of thousands of brackets within brackets is refused before anything follows them."""
    for deep in (5_000, 1_000_000):
        data = b"GEOMETRYCOLLECTION(" * deep + b"POINT(8 47)" + b")" * deep
        with pytest.raises(RegionFileError) as caught:
            import_regions(data)
        assert [finding.rule for finding in caught.value.findings] == ["wkt"]
