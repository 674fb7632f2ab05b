"""Roles of shapes: where words forbid flying a shape forbids it, in doubt its role is asked for."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import pytest
from shapely.geometry import Polygon, shape

from app.imports import Account, Imported, ImportOptions, RegionFileError, import_regions, read_choices
from app.imports.words import forbids
from planner.errors import ScenarioError
from planner.geojson import read_scenario
from tests.app.imports.samples import (
    RING,
    archive_of,
    folder,
    kml,
    line,
    placemark,
    point,
    polygon,
    shapefiles,
)
from tests.planner.scenarios import small

FAULTS = Path(__file__).parents[2] / "faults"
FORBIDDING = (
    "no-fly", "NFZ", "NFZ north", "nfz_3", "NoFlyZone", "Drone No Fly Zones", "restrict_area",
    "RESTRICTED", "prohibited", "Danger area D-12", "CTR Zürich", "TFR 4/1234", "geofence exclusion",
    "keep out", "Exclusion zone", "do not enter", "Flugverbotszone", "Sperrgebiet", "Gefahrengebiet",
    "zone interdite", "survol réglementé", "zona proibita", "área restringida", "zona peligrosa",
    "vietato", "verboden gebied", "förbjudet", "lentokielto", "strefa zakazana", "zakázaný prostor",
    "nebezpečná oblast", "tiltott", "yasak bölge", "запретная зона", "опасная зона", "заборонено",
    "απαγορευμένη", "禁飞区", "限飞区域", "飛行禁止区域", "비행금지구역", "منطقة محظورة", "אסור לטיסה",
    "ห้ามบิน", "cấm bay", "khu vực cấm", "उड़ान निषेध क्षेत्र", "repülési tilalom", "bannsvæði",
    "lennukeeluala", "eremu debekatua", "bawal lumipad", "نو فلائی زون", "აკრძალული ზონა", "արգելված գոտի",
    "ұшуға тыйым", "нисэх хориотой", "verbode gebied", "zonë e ndaluar", "забрањена зона",
    "gesperrt", "não voar", "zona de no vuelo", "ne pas survoler", "bezletová zóna", "uçuş yasağı",
    "закрытая зона", "geen vliegzone", "lennukeeld", "नो फ्लाई ज़ोन", "请勿飞行", "NFZs", "ＮＦＺ",
    "No\u00adFly", "no\u200bfly\u200bzone", "З\u200bА\u200bП\u200bР\u200bЕ\u200bТ", "fo\u0308rbjudet",
    "nо flу zоnе", "No%20Fly",
    "Fluchverbuetszon", "kein Überflug", "RPZ", "closed area", "ຫ້າມບິນ", "ហាមហោះ", "የተከለከለ",
)  # fmt: skip
HARMLESS = (
    "field 3",
    "Unrestricted view",
    "bank",
    "Urban",
    "north",
    "Ctrl",
    "Vierwaldstättersee",
    "zone 4",
    "R1",
    "Feld R-1",
    "DJI P4",
    "dangle",
    "Talsperre",
    "Zitrone",
    "Ei saari",
    "A&B farm",
    "100% coverage",
    "Größe",
    "Поле",
)


def became(data: bytes, **options: Any) -> Imported:
    return import_regions(data, ImportOptions(**options))


def account_of(data: bytes, **options: Any) -> Account:
    (account,) = became(data, **options).shapes
    return account


def geojson(
    name: str, drawn: dict[str, Any], collection: dict[str, Any], properties: dict[str, Any]
) -> bytes:
    feature = {"type": "Feature", "geometry": drawn, "properties": {"name": name} | properties}
    return json.dumps({"type": "FeatureCollection", "features": [feature]} | collection).encode()


SQUARE = {"type": "Polygon", "coordinates": [RING]}
OUTLINE = {"type": "LineString", "coordinates": RING}


def written(word: str, place: str, outline: bool) -> tuple[bytes, dict[str, Any]]:
    """A file with one shape, the word at one of the places that say something, and what goes with it."""
    drawn = OUTLINE if outline else SQUARE
    mark = line(RING) if outline else polygon(RING)
    match place:
        case "kml name":
            return kml(placemark(word, mark)), {}
        case "kml folder":
            return kml(folder("a", folder(word, folder("b", placemark("x", mark))))), {}
        case "kml document":
            return kml(placemark("x", mark)).replace(b"<name>d<", f"<name>{word}<".encode()), {}
        case "kml value":
            return kml(placemark("x", mark, remark=word)), {}
        case "role":
            return geojson("x", drawn, {}, {"role": word}), {}
        case "Role":
            return geojson("x", drawn, {}, {"Role": word}), {}
        case "nested":
            return geojson("x", drawn, {}, {"zone": {"kinds": [word]}}), {}
        case "collection":
            return geojson("x", drawn, {"name": word}, {}), {}
        case "key":
            return geojson("x", drawn, {}, {word: True}), {}
    return geojson("x", drawn, {}, {}), {"file_name": f"{word}.geojson"}


PLACES = (
    "kml name", "kml folder", "kml document", "kml value", "role", "Role", "nested", "collection", "key",
    "file",
)  # fmt: skip


@pytest.mark.parametrize("word", FORBIDDING)
def test_words_of_restriction_forbid(word: str) -> None:
    """Wherever the word stands, and drawn as polygon or as closed line, the shape is a no-fly polygon."""
    for place, outline in itertools.product(PLACES, (False, True)):
        data, more = written(word, place, outline)
        found = became(data, **more)
        (feature,) = found.collection["features"]
        assert feature["properties"]["role"] == "no_fly", (place, outline)
        assert shape(feature["geometry"]).equals(Polygon(RING)), (place, outline)
        assert "role_in_doubt" not in feature["properties"], (place, outline)
        assert found.shapes[0].why


def test_text_that_was_read_in_a_wrong_code_page_forbids() -> None:
    """UTF-8 that another program took for Latin-1 or Windows-1252 means what it meant; so does HTML."""
    assert forbids("förbjudet".encode().decode("latin-1"))
    assert forbids("запрет".encode().decode("latin-1"))
    assert forbids("interdit de survol – été".encode().decode("cp1252"))
    assert forbids("<b>No&nbsp;Fly</b>")


def test_what_forbids_may_stand_last_in_a_long_text() -> None:
    """A description of a megabyte that ends in words of restriction is a no-fly zone in doubt."""
    data, more = written("a word " * 150_000 + "no fly zone", "kml value", False)
    (feature,) = became(data, **more).collection["features"]
    assert feature["properties"]["role"] == "no_fly"
    assert feature["properties"]["role_in_doubt"]


@pytest.mark.parametrize("word", HARMLESS)
def test_other_words_forbid_nothing(word: str) -> None:
    """Parts of words, and denials that are words of their own, are no restriction."""
    assert forbids(word) is None
    assert account_of(written(word, "kml folder", False)[0]).role == "roi"


def test_a_layer_of_a_shapefile_forbids() -> None:
    """A shapefile's name and its table's values count as well."""
    files = shapefiles([[RING[::-1]]], ["x"])
    assert account_of(archive_of(files, "gis/restrict_area")).role == "no_fly"
    assert account_of(archive_of(shapefiles([[RING[::-1]]], ["Zone interdite"]))).role == "no_fly"


@pytest.mark.parametrize(
    ("properties", "name", "rule"),
    [
        ({"role": "cloud"}, "x", "none of ours"),
        ({"role": "roi"}, "NFZ 4", "but its role"),
        ({"role": "area"}, "restricted", "but its role"),
        ({}, "Geofence", "either side"),
        ({}, "class D airspace", "either side"),
        ({}, "EGD012 Lulworth", "either side"),
        ({}, "R-5503", "either side"),
        ({"type": "P"}, "x", "restricted area"),
        ({"type": "region"}, "danger", "but its type"),
        ({"restriction": "NO_RESTRICTION"}, "x", "either side"),
    ],
)
def test_in_doubt_a_role_is_asked_for(properties: dict[str, Any], name: str, rule: str) -> None:
    """The shape forbids, says that its role is in doubt, and the scenario is refused until it is settled."""
    data = geojson(name, SQUARE, {}, properties)
    found = became(data)
    (feature,) = found.collection["features"]
    assert feature["properties"]["role"] == "no_fly"
    assert rule in feature["properties"]["role_in_doubt"]
    assert found.shapes[0].in_doubt
    with pytest.raises(ScenarioError) as caught:
        read_scenario(small(features=[feature]))
    refused = [f for f in caught.value.findings if f.rule == "role-in-doubt"]
    assert [finding.feature for finding in refused] == [name]
    assert all(finding.message and finding.fix for finding in refused)
    for role in ("roi", "no_fly", "area"):
        settled = became(data, roles=read_choices([f"{name.upper()}={role}"]))
        assert settled.collection["features"][0]["properties"] == {"role": role, "name": name}


def test_the_role_of_the_import_settles_what_is_open_but_no_contradiction() -> None:
    """A word that is none of ours becomes what is asked for; a no-fly zone stays one."""
    unknown = geojson("x", SQUARE, {}, {"role": "cloud"})
    assert not account_of(unknown, role="roi").in_doubt
    forbidden = geojson("NFZ", SQUARE, {}, {})
    assert account_of(forbidden, role="roi").role == "no_fly"
    both = geojson("NFZ", SQUARE, {}, {"role": "roi"})
    assert account_of(both, role="roi").in_doubt
    assert not account_of(both, role="no_fly").in_doubt


@pytest.mark.parametrize(
    ("properties", "name", "role"),
    [
        ({}, "inclusion fence", "area"),
        ({"inclusion": False}, "x", "no_fly"),
        ({"fence_type": "exclusion"}, "geofence", "no_fly"),
        ({"exclusion": False}, "x", "roi"),
        ({"no_fly": "no"}, "x", "roi"),
        ({"no_fly": 1}, "x", "no_fly"),
        ({}, "Operation area", "area"),
        ({"role": "Inclusion"}, "x", "area"),
    ],
)
def test_fences_say_their_side(properties: dict[str, Any], name: str, role: str) -> None:
    """What is to be stayed inside of is the area, what is excluded a no-fly zone, whatever says so."""
    account = account_of(geojson(name, SQUARE, {}, properties))
    assert (account.role, account.in_doubt) == (role, False)


@pytest.mark.parametrize(
    ("name", "role"),
    [
        ("Home", "start"), ("Launch Site", "start"), ("TO", "start"), ("Takeoff 2", "start"),
        ("Landing", "end"), ("Rally 1", "base"), ("Point 7", "none"), ("", "none"), ("Weather mast", "none"),
        ("Radar north", "threat"), ("target 3", "roi"), ("Startpunkt", "start"), ("起飞点", "start"),
    ],
)  # fmt: skip
def test_points_are_what_words_say_or_nothing(name: str, role: str) -> None:
    """A point is never a threat that the file doesn't speak of; what nothing names is left out, and said."""
    data = kml(placemark("field", polygon(RING)), placemark(name, point(8.7, 47.3)))
    found = became(data, radius_m=100.0)
    account = found.shapes[1]
    assert (account.role, len(account.features)) == (role, int(role != "none"))
    assert account.why


def test_a_second_start_is_a_base() -> None:
    """A scenario has one start: further ones of the file are bases."""
    found = became((FAULTS / "11-home-point-is-threat.kml").read_bytes())
    assert [account.role for account in found.shapes] == ["start", "base", "base", "roi", "none"]
    assert all(feature["properties"]["role"] != "threat" for feature in found.collection["features"])


def test_points_that_carry_a_name_are_left_out() -> None:
    """A label of its own within the polygon of its name is no target and no zone, in any folder."""
    data = kml(folder("NFZ", placemark("a", polygon(RING)), placemark("a", point(8.55, 47.35))))
    found = became(data, radius_m=10.0)
    assert [feature["geometry"]["type"] for feature in found.collection["features"]] == ["Polygon"]
    assert (found.shapes[1].role, "labels" in found.shapes[1].why) == ("none", True)


def test_one_bad_shape_refuses_no_other() -> None:
    """A line without a width is left out and found; as a zone it is closed and forbidden."""
    data = (FAULTS / "18-one-open-line.kml").read_bytes()
    found = became(data)
    assert [feature["id"] for feature in found.collection["features"]] == ["zone A", "zone B"]
    assert [finding.feature for finding in found.left_out] == ["zone C"]
    zones = became(data, role="no_fly").collection["features"]
    assert [zone["geometry"]["type"] for zone in zones] == ["Polygon"] * 3


def test_one_shape_that_cannot_be_read_refuses_no_other() -> None:
    """It is found by its name, in every format; where it is the only one the file is refused."""
    good, bad = (
        placemark("good", polygon(RING)),
        placemark("bad", "<Point><coordinates>x</coordinates></Point>"),
    )
    ring = {"type": "Feature", "properties": {"name": "good"}, "geometry": SQUARE}
    broken = {
        "type": "Feature",
        "properties": {"name": "bad"},
        "geometry": {"type": "Polygon", "coordinates": [3]},
    }
    rings = [{"attributes": {"name": "good"}, "geometry": {"rings": [RING]}}]
    rings.append({"attributes": {"name": "bad"}, "geometry": {"rings": [[["x", 3]]]}})
    files = [
        kml(good, bad),
        json.dumps({"type": "FeatureCollection", "features": [ring, broken]}).encode(),
        json.dumps({"features": rings}).encode(),
    ]
    for data in files:
        found = became(data)
        assert [feature["id"] for feature in found.collection["features"]] == ["good"]
        assert [finding.feature for finding in found.left_out] == ["bad"]
    with pytest.raises(RegionFileError):
        became(kml(bad))


PROSE = "This field lies to the north of the village, beside the restricted wood; mind the fence."


def test_prose_is_asked_about() -> None:
    """A longer text that speaks of a restriction may mean another place: the import settles it."""
    data = geojson("x", SQUARE, {}, {"description": PROSE})
    account = account_of(data)
    assert (account.role, account.in_doubt) == ("no_fly", True)
    assert not account_of(data, role="roi").in_doubt
    assert account_of(geojson("x", SQUARE, {}, {"description": PROSE, "role": "roi"})).role == "roi"
    assert account_of(geojson("NFZ", SQUARE, {}, {"description": PROSE}), role="roi").role == "no_fly"


def test_shapes_and_folders_have_roles_chosen() -> None:
    """By number, name or folder, in any case; none leaves a shape out; a choice of nothing is refused."""
    data = kml(
        folder("Zones", placemark("a", polygon(RING)), placemark("b", polygon(RING))),
        placemark("c", polygon(RING)),
    )
    found = became(data, roles=read_choices(["ZONES=no_fly", "b=area", "#3=none"]))
    assert [account.role for account in found.shapes] == ["no_fly", "area", "none"]
    several = became(data, roles=read_choices(["#1-2=area", "#3,2=none"]))
    assert [account.role for account in several.shapes] == ["area", "none", "none"]
    for text in ("e=roi", "#4=roi", "#0=roi", "#1-4=roi", "a=cloud", "a", "=roi"):
        with pytest.raises(RegionFileError) as caught:
            became(data, roles=read_choices([text]))
        assert caught.value.findings[0].rule == "bad-option"


def test_a_point_with_a_model_is_a_threat() -> None:
    """The file says so by our own value; nothing else makes a point one."""
    data = kml(placemark("x", point(8.5, 47.3), model="radar", intensity_m=9, radius_m=100))
    (feature,) = became(data).collection["features"]
    assert (feature["properties"]["role"], feature["properties"]["model"]) == ("threat", "radar")
