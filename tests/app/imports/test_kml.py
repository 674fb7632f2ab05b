"""KML and KMZ as features of a scenario."""

from __future__ import annotations

import zipfile
from io import BytesIO
from typing import Any

import pytest
from shapely.geometry import Polygon, shape

from app.imports import ImportOptions, RegionFileError, import_regions
from app.imports.archive import MAX_MEMBERS
from planner.geojson import read_scenario
from tests.app.imports.samples import HOLE, RING, folder, kml, line, packed, placemark, point, polygon
from tests.planner.moved import GEOD
from tests.planner.scenarios import small


def imported(data: bytes, **options: Any) -> list[dict[str, Any]]:
    features: list[dict[str, Any]] = import_regions(data, ImportOptions(**options)).collection["features"]
    return features


def rule_of(data: bytes, **options: Any) -> str:
    with pytest.raises(RegionFileError) as caught:
        imported(data, **options)
    assert caught.value.findings
    return caught.value.findings[0].rule


def test_a_polygon_is_a_region_with_its_name_and_holes() -> None:
    """Heights go, the outer ring runs counter-clockwise, the hole stays."""
    (feature,) = imported(
        kml(placemark("Märchen & Co".replace("&", "&amp;"), polygon(RING[::-1], HOLE[::-1])))
    )
    assert feature["id"] == feature["properties"]["name"] == "Märchen & Co"
    assert feature["properties"]["role"] == "roi"
    drawn = shape(feature["geometry"])
    assert isinstance(drawn, Polygon)
    assert drawn.exterior.is_ccw
    assert len(drawn.interiors) == 1
    assert not drawn.interiors[0].is_ccw
    assert drawn.area == pytest.approx(0.01 - 0.0004)
    assert not drawn.has_z


@pytest.mark.parametrize(
    ("folder_name", "role"),
    [
        ("Regions", "roi"),
        ("No-fly zones", "no_fly"),
        ("NO_FLY", "no_fly"),
        ("NFZ 2", "no_fly"),
        ("Operating area", "area"),
        ("Holiday", "roi"),
    ],
)
def test_folders_give_roles(folder_name: str, role: str) -> None:
    """Words for roles are known in any case, with blanks, hyphens or underscores."""
    (feature,) = imported(kml(folder(folder_name, placemark("x", polygon(RING)))))
    assert feature["properties"]["role"] == role


def test_names_and_values_go_before_folders() -> None:
    """A placemark's own role goes first, then its name, then the innermost folder, then the wish."""
    features = imported(
        kml(
            folder(
                "Regions",
                placemark("Start", point(8.5, 47.3)),
                placemark("no fly 3: airport", polygon(RING)),
                placemark("field", polygon(RING), role="importance", score=2),
                folder("Obstacles", placemark("tower", polygon(RING), height_m=80)),
            ),
            placemark("other", polygon(RING)),
        ),
        role="area",
    )
    assert [f["properties"]["role"] for f in features] == [
        "start",
        "no_fly",
        "importance",
        "obstacle",
        "area",
    ]
    assert features[2]["properties"]["score"] == 2.0
    assert features[3]["properties"]["height_m"] == 80.0


def test_lines_are_corridors_with_a_width() -> None:
    """A line needs width_m, from the import or from the placemark."""
    text = kml(placemark("road", line(RING[:3])), placemark("rail", line(RING[1:3]), width_m=30))
    road, rail = imported(text, width_m=200.0)
    assert (road["geometry"]["type"], road["properties"]["width_m"]) == ("LineString", 200.0)
    assert rail["properties"]["width_m"] == 30.0
    found = import_regions(text)
    assert [feature["id"] for feature in found.collection["features"]] == ["rail"]
    assert [(finding.feature, finding.rule) for finding in found.left_out] == [("road", "width_m-missing")]
    assert rule_of(kml(placemark("road", line(RING[:3])))) == "width_m-missing"


def test_points_of_threats_have_a_radius() -> None:
    """A threat's point has the radius given and is a missile site, a radar where the values say so."""
    text = kml(
        folder(
            "Threats",
            placemark("SA-6", point(8.5, 47.3)),
            placemark("r", point(8.6, 47.3), model="radar", intensity_m=9),
        )
    )
    first, second = imported(text, radius_m=500.0)
    assert first["properties"] == {"role": "threat", "name": "SA-6", "radius_m": 500.0, "model": "missile"}
    assert (second["properties"]["model"], second["properties"]["intensity_m"]) == ("radar", 9.0)
    assert rule_of(text) == "radius_m-missing"


def test_many_polygons_of_one_placemark_stay_one_region() -> None:
    """A MultiGeometry is one roi; zones, which are single polygons, come apart with names of their own."""
    away = [(lon + 1.0, lat) for lon, lat in RING]
    multi = f"<MultiGeometry>{polygon(RING)}{polygon(away)}</MultiGeometry>"
    (region,) = imported(kml(placemark("two", multi)))
    assert region["geometry"]["type"] == "MultiPolygon"
    zones = imported(kml(placemark("two", multi)), role="no_fly")
    assert [(z["id"], z["geometry"]["type"]) for z in zones] == [("two", "Polygon"), ("two 2", "Polygon")]


def test_names_are_made_unique() -> None:
    """Same names get numbers, missing ones their role's."""
    text = kml(*(placemark(name, polygon(RING)) for name in ("a", "a", "", "")))
    assert [f["id"] for f in imported(text)] == ["a", "a 2", "roi 1", "roi 2"]


def test_a_closed_line_can_be_a_zone() -> None:
    """Programs that draw outlines as lines are understood where the role wants a polygon."""
    (zone,) = imported(kml(placemark("z", line(RING))), role="no_fly")
    assert zone["geometry"]["type"] == "Polygon"
    assert rule_of(kml(placemark("z", line(RING[:3]))), role="area") == "wrong-geometry"


@pytest.mark.parametrize(
    ("data", "rule"),
    [
        (b"", "empty"),
        (b"hello", "unknown-format"),
        (b"* zones\r\nAC R\r\nAN Range\r\nDP 47:22:00 N 008:32:00 E\r\n", "openair"),
        (kml(), "no-shapes"),
        (b"<html/>", "not-kml"),
        (kml(placemark("x", polygon([(lat, lon + 90) for lon, lat in RING]))), "latitude-out-of-range"),
        (kml(placemark("x", polygon(RING[:2]))), "ring-too-short"),
        (kml(placemark("x", point(8.5, 47.3))).replace(b"8.5,47.3", b"8.5 47.3"), "kml-coordinates"),
        (kml(placemark("x", polygon(RING))).replace(b"8.5,47.3", b"nan,47.3"), "latitude-out-of-range"),
        (kml(placemark("x", point(8.5, 47.3))), "role-unknown"),
        (kml(placemark("x", "<LineString><coordinates/></LineString>")), "kml-coordinates"),
        (kml()[:-4], "xml-syntax"),
        (b"<kml>" + b"<Folder>" * 200 + b"</Folder>" * 200 + b"</kml>", "xml-depth"),
        (b'<?xml version="1.0" encoding="klingon"?><kml/>', "xml-encoding"),
    ],
)
def test_faults_have_rules(data: bytes, rule: str) -> None:
    """Each fault has a finding with a rule of its own."""
    assert rule_of(data, radius_m=1.0) == rule


def test_every_faulty_shape_is_named() -> None:
    """Findings name all the shapes that are wrong, not only the first."""
    with pytest.raises(RegionFileError) as caught:
        imported(kml(*(placemark(f"p{n}", point(8.5, 147.3)) for n in range(3))), role="threat", radius_m=1.0)
    assert [finding.feature for finding in caught.value.findings] == ["p0", "p1", "p2"]


@pytest.mark.parametrize(
    "prolog",
    [
        '<!DOCTYPE kml [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]>',
        '<!DOCTYPE kml [<!ENTITY x SYSTEM "file:///etc/hostname">]>',
        '<!DOCTYPE kml SYSTEM "http://127.0.0.1:9/kml.dtd">',
    ],
)
def test_entities_are_refused(prolog: str) -> None:
    """A document type declaration is refused whatever it declares."""
    assert rule_of(f"{prolog}<kml><Placemark/></kml>".encode()) == "xml-entities"


def test_every_document_of_a_kmz_is_read() -> None:
    """doc.kml goes before other documents, whose paths are folders; images beside them do not matter."""
    main, other = kml(placemark("main", polygon(RING))), kml(placemark("other", polygon(RING)))
    data = packed({"a/other.kml": other, "doc.kml": main, "files/icon.png": b"\x89PNG"})
    assert [f["id"] for f in imported(data)] == ["main", "other"]
    assert import_regions(data).shapes[1].folders == ("a", "other", "d")
    assert [f["id"] for f in imported(packed({"x.kml": other}))] == ["other"]


@pytest.mark.parametrize(
    "name", ["../doc.kml", "/etc/doc.kml", "a/../../doc.kml", "C:\\doc.kml", "..\\doc.kml"]
)
def test_paths_out_of_the_archive_are_refused(name: str) -> None:
    """Nothing is written to disk anyway; such an archive is nobody's honest work."""
    assert rule_of(packed({name: kml(placemark("x", polygon(RING)))})) == "archive-path"


def test_bombs_are_refused() -> None:
    """A member that swells beyond reason, too many members, and a size that is a lie are refused."""
    blank = kml() + b" " * 30_000_000
    assert rule_of(packed({"doc.kml": blank})) == "archive-too-large"
    assert rule_of(packed({f"{n}.txt": b"" for n in range(MAX_MEMBERS + 1)})) == "archive-too-large"
    small = bytearray(packed({"doc.kml": blank}))
    size = len(blank).to_bytes(4, "little")
    assert small.count(size) == 2
    assert rule_of(bytes(small.replace(size, (5).to_bytes(4, "little")))) in (
        "archive-too-large",
        "archive-damaged",
        "no-kml",
        "xml-syntax",
    )


def test_damaged_and_encrypted_archives_are_refused() -> None:
    """Cut archives, archives with passwords, and archives without a document are named as such."""
    good = packed({"doc.kml": kml(placemark("x", polygon(RING)))})
    assert rule_of(good[: len(good) // 2]) == "archive-damaged"
    assert rule_of(packed({"readme.txt": b"x"})) == "no-shapefile"
    locked = bytearray(good)
    with zipfile.ZipFile(BytesIO(good)) as archive:
        offset = good.rindex(b"PK\x01\x02")
        assert archive.infolist()[0].flag_bits == 0
    locked[offset + 8] |= 1
    assert rule_of(bytes(locked)) == "archive-encrypted"


@pytest.mark.parametrize("east", [-179.99, 180.01])
def test_a_polygon_across_the_antimeridian_is_a_region_of_its_size(east: float) -> None:
    """Drawn with longitudes that jump or go on beyond 180°, it is imported and read as one region."""
    ring = [(179.99, 10.0), (east, 10.0), (east, 10.01), (179.99, 10.01), (179.99, 10.0)]
    (made,) = imported(kml(placemark("A", polygon(ring))))
    start = {"type": "Feature", "properties": {"role": "start"}}
    start["geometry"] = {"type": "Point", "coordinates": [180.0, 10.0]}
    scenario = read_scenario(small(features=[made, start]))
    wanted_m2 = abs(GEOD.polygon_area_perimeter([179.99, 180.01, 180.01, 179.99], [10, 10, 10.01, 10.01])[0])
    assert scenario.regions[0].area.area == pytest.approx(wanted_m2, rel=1e-3)
