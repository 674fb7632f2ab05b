"""Archives: every file of regions in them is read."""

from __future__ import annotations

import json
import random
import zipfile
from io import BytesIO

import pytest
from shapely.geometry import MultiPoint, Polygon, shape

from app.imports import Imported, ImportOptions, RegionFileError, import_regions
from app.imports.rings import MAX_RINGS, grouped
from tests.app.imports.samples import (
    GPX,
    HOLE,
    RING,
    archive_of,
    folder,
    kml,
    line,
    packed,
    placemark,
    polygon,
    shapefiles,
)

SHAPES = shapefiles([[RING[::-1]]], ["meadow"])
GEOJSON = json.dumps({"type": "Polygon", "coordinates": [RING]}).encode()


def link(address: str, name: str = "") -> str:
    return f"<NetworkLink><name>{name}</name><Link><href>{address}</href></Link></NetworkLink>"


def names_of(found: Imported) -> list[str]:
    return [account.name for account in found.shapes]


def test_all_files_of_an_archive_are_read() -> None:
    """KML, a shapefile, GPX, GeoJSON and an archive of KML in one: none is passed over."""
    inner = packed({"doc.kml": kml(placemark("inner", polygon(RING)))})
    members = {
        "fields.kml": kml(placemark("field", polygon(RING))),
        "NFZ/zone.geojson": GEOJSON,
        "t.gpx": GPX,
    }
    members |= {"in.kmz": inner} | {f"gis/land{ending}": content for ending, content in SHAPES.items()}
    found = import_regions(packed(members), ImportOptions(width_m=10.0))
    assert found.format == "zip"
    assert set(names_of(found)) == {"field", "inner", "meadow", "", "river", "power line", "mast"}
    by_name = {account.name: account for account in found.shapes}
    assert by_name[""].role == "no_fly"
    assert by_name["meadow"].folders == ("gis", "land")


def test_what_macos_keeps_beside_is_passed_over() -> None:
    """Neither __MACOSX nor ._ files are anybody's regions."""
    members = {
        "__MACOSX/._doc.kml": b"\x00\x05\x16\x07",
        "__MACOSX/fields.shp": b"x",
        "._fields.shp": b"\x00",
    }
    members |= {"doc.kml": kml(placemark("field", polygon(RING)))}
    assert names_of(import_regions(packed(members))) == ["field"]
    members |= {f"fields{ending}": content for ending, content in SHAPES.items()}
    assert names_of(import_regions(packed(members))) == ["field", "meadow"]


def test_links_within_an_archive_are_followed() -> None:
    """Documents stand where the link does, in its folder; each once, in circles too; no link leads out."""
    main = kml(
        folder(
            "Zones",
            link("layers/A%20b.KML", "no fly"),
            link("http://127.0.0.1/x.kml"),
            link("../../etc/x.kml"),
        )
    )
    inner = kml(placemark("inside", polygon(RING)), link("../doc.kml"), link("./c.kml"))
    data = packed(
        {"doc.kml": main, "layers/a b.kml": inner, "layers/c.kml": kml(placemark("c", polygon(RING)))}
    )
    found = import_regions(data)
    assert [(a.name, a.role) for a in found.shapes] == [("inside", "no_fly"), ("c", "no_fly")]
    assert sum("leads elsewhere" in note for note in found.notes) == 2


def test_names_that_differ_in_case_belong_together() -> None:
    """FIELDS.SHP has its table and reference system in fields.Dbf and Fields.PRJ."""
    members = {"FIELDS.SHP": SHAPES[".shp"], "fields.Dbf": SHAPES[".dbf"], "Fields.PRJ": SHAPES[".prj"]}
    assert names_of(import_regions(packed(members))) == ["meadow"]


def test_paths_of_any_code_page_say_what_they_say() -> None:
    """A folder name in GBK, which the archive doesn't declare, forbids like any other."""
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("QQQ/zone.geojson", GEOJSON)
    word = "禁飞".encode("gbk")
    assert import_regions(buffer.getvalue()).shapes[0].role == "roi"
    data = buffer.getvalue().replace(b"QQQ/zone", word + b"/one")
    assert import_regions(data).shapes[0].role == "no_fly"


def test_a_bad_file_of_an_archive_is_named() -> None:
    """What is wrong says in which file."""
    data = packed({"a.geojson": GEOJSON, "b.gpx": b"<gpx><wpt></gpx>"})
    with pytest.raises(RegionFileError) as caught:
        import_regions(data)
    assert caught.value.findings[0].feature == "b.gpx"


@pytest.mark.parametrize("turned", [(False, False), (True, True), (False, True), (True, False)])
def test_rings_have_holes_whatever_way_they_run(turned: tuple[bool, bool]) -> None:
    """A shapefile's rings in any direction and order are one polygon with its hole, and an island in that."""
    island = [(8.525, 47.325), (8.535, 47.325), (8.535, 47.335), (8.525, 47.325)]
    outer, hole = (ring[::-1] if turn else ring for ring, turn in zip((RING, HOLE), turned, strict=True))
    wanted = Polygon(RING, [HOLE]).union(Polygon(island))
    for rings in ([outer, hole, island], [island, hole, outer], [hole, island, outer]):
        files = shapefiles([rings], ["x"])
        (feature,) = import_regions(packed({f"x{e}": c for e, c in files.items()})).collection["features"]
        assert shape(feature["geometry"]).symmetric_difference(wanted).area < 1e-12
        (feature,) = import_regions(
            json.dumps({"type": "Polygon", "coordinates": rings}).encode()
        ).collection["features"]
        assert shape(feature["geometry"]).symmetric_difference(wanted).area < 1e-12


def test_rings_that_cross_and_rings_drawn_twice_are_no_holes() -> None:
    """Only what lies wholly in another is cut out of it."""
    away = [(lon + 0.05, lat) for lon, lat in RING]
    assert [len(part) for part in grouped([tuple(RING), tuple(away)])] == [1, 1]
    assert [len(part) for part in grouped([tuple(RING), tuple(RING), tuple(HOLE)])] == [2]


def test_rings_within_rings_have_an_end() -> None:
    """Thousands of rings side by side are grouped, thousands within each other refused by name."""
    many = [
        tuple((8.0 + i * 1e-3 + x * 1e-4, 47.0 + y * 1e-4) for x, y in ((0, 0), (1, 0), (1, 1), (0, 0)))
        for i in range(4000)
    ]
    assert len(grouped(many)) == 4000
    nested = [
        tuple((8.0 + i * x, 47.0 + i * y) for x, y in ((-1, -1), (1, -1), (0, 1), (-1, -1)))
        for i in range(1, 2000)
    ]
    with pytest.raises(RegionFileError) as caught:
        grouped(nested)
    assert caught.value.findings[0].rule == "rings-nested"
    with pytest.raises(RegionFileError) as caught:
        grouped([many[0]] * (MAX_RINGS + 1))
    assert caught.value.findings[0].rule == "too-many-rings"


def test_scribbles_and_deep_links_have_an_end() -> None:
    """A zone of thousands of crossings is its hull; links that lead on and on are refused by name."""
    dice = random.Random(7)
    places = [(8.0 + dice.random(), 47.0 + dice.random()) for _ in range(3000)]
    for mark in (polygon([*places, places[0]]), line(places)):
        (feature,) = import_regions(kml(placemark("NFZ", mark))).collection["features"]
        hull = MultiPoint(places).convex_hull
        assert shape(feature["geometry"]).symmetric_difference(hull).area < 1e-9
    long = [(8.0 + dice.random(), 47.0 + dice.random()) for _ in range(20_000)]
    (feature,) = import_regions(kml(placemark("NFZ", polygon([*long, long[0]])))).collection["features"]
    assert shape(feature["geometry"]).symmetric_difference(MultiPoint(long).convex_hull).area < 1e-9
    chain = {f"{n}.kml": kml(link(f"{n + 1}.kml")) for n in range(60)}
    with pytest.raises(RegionFileError) as caught:
        import_regions(packed(chain))
    assert caught.value.findings[0].rule == "kml-links"


@pytest.mark.parametrize("place", ["NFZ.{}", "no fly/a.{}", "a/No Fly Zones/b.{}"])
def test_paths_forbid_in_every_kind_of_archive(place: str) -> None:
    """What forbids in the name of a document, a layer or an archive, or of a folder about it, forbids."""
    document = kml(placemark("a", polygon(RING)))
    for ending, content in (
        ("kml", document),
        ("kmz", packed({"doc.kml": document})),
        ("zip", packed({"doc.kml": document})),
        ("zip", archive_of(SHAPES)),
        ("geojson", GEOJSON),
    ):
        found = import_regions(packed({place.format(ending): content}))
        assert [account.role for account in found.shapes] == ["no_fly"], ending
    layer = {place.format(ending[1:]): content for ending, content in SHAPES.items()}
    assert [account.role for account in import_regions(packed(layer)).shapes] == ["no_fly"]


def test_archives_in_archives_are_opened_once() -> None:
    """One in another is read; one in that is not."""
    inner = packed({"doc.kml": kml(placemark("a", polygon(RING)))})
    assert names_of(import_regions(packed({"a.zip": inner}))) == ["a"]
    with pytest.raises(RegionFileError):
        import_regions(packed({"b.zip": packed({"a.zip": inner})}))


def test_of_files_that_an_archive_holds_twice_none_is_dropped() -> None:
    """A zone behind a region of the same path is refused by name; of shapefiles in any case."""
    zone, field = kml(placemark("NFZ", polygon(RING))), kml(placemark("field", polygon(RING)))
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        archive.writestr("doc.kml", zone)
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("doc.kml", field)
    shapes = shapefiles([[RING]], ["x"])
    cased = packed({f"fields{e}": d for e, d in shapes.items()} | {"FIELDS.SHP": shapes[".shp"]})
    for data in (buffer.getvalue(), cased):
        with pytest.raises(RegionFileError) as caught:
            import_regions(data)
        assert [finding.rule for finding in caught.value.findings] == ["archive-twice"]
