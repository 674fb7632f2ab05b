"""Pieces of airspace by the columns of those who publish them: never regions to fly over unasked."""

from __future__ import annotations

import json
from typing import Any

import pytest

from app.imports import ImportOptions, RegionFileError, import_regions

SQUARE = [[[8.5, 47.3], [8.52, 47.3], [8.52, 47.32], [8.5, 47.32], [8.5, 47.3]]]
LIMITS = {
    "icaoClass": 8,
    "upperLimit": {"value": 3500, "unit": 1, "referenceDatum": 1},
    "lowerLimit": {"value": 0, "unit": 1, "referenceDatum": 0},
}
#: Values of one piece each, as their publishers write them.
PUBLISHED: dict[str, dict[str, Any]] = {
    **{f"openAIP, type {kind}": {"name": "X", "type": kind, **LIMITS} for kind in range(1, 37)},
    "FAA, facility map": {"CEILING": 0, "UNIT": "Feet", "APT1_NAME": "San Jose", "APT1_ICAO": "KSJC"},
    "FAA, special use": {"NAME": "EDWARDS", "TYPE_CODE": "R"},
    "FAA, class C": {"NAME": "SAN JOSE", "CLASS": "C", "LOCAL_TYPE": "CLASS_C", "UPPER_VAL": "4000"},
    "FAA, security": {"Facility": "Fort X", "Floor": 0, "Ceiling": 400},
    "France, heights": {"limite": "Hauteur maximale de vol de 50 m *"},
    "Germany, DIPUL": {"name": "Moor", "type_code": "NATURSCHUTZGEBIETE"},
    "Poland, by number": {"name": "DRA-R 123"},
    "an airport": {"name": "Zürich", "type": "airport"},
    "OpenStreetMap, airfield": {"name": "LSZH", "aeroway": "aerodrome"},
    "OpenStreetMap, barracks": {"name": "Kaserne", "landuse": "military"},
}


#: What is not permitted, or within limits, as names say it.
WORDS = (
    "restrizioni di volo", "zone restreinte", "Beschränkungsgebiet", "Flugeinschränkung",
    "begränsat område", "begrænset", "drönarförbud", "dronefri sone", "vliegvrij gebied",
    "Überflug untersagt", "nicht erlaubt", "non autorizzato", "no autorizado", "não autorizado",
    "pas autorisé", "ikke tilladt", "ikke tillatt", "ej tillåtet", "niet toegestaan",
    "ei sallittu", "nie wolno", "nepovoleno", "nem engedélyezett", "izin yok", "не разрешено",
    "нельзя", "δεν επιτρέπεται", "不允许飞行", "严禁", "不許可", "危険区域", "غير مسموح", "drone free zone",
    "limitación",
)  # fmt: skip


def account(properties: dict[str, Any]) -> tuple[str, bool]:
    geometry = {"type": "Polygon", "coordinates": SQUARE}
    feature = {"type": "Feature", "properties": properties, "geometry": geometry}
    (shape,) = import_regions(
        json.dumps({"type": "FeatureCollection", "features": [feature]}).encode(), ImportOptions()
    ).shapes
    return shape.role, shape.in_doubt


@pytest.mark.parametrize("who", PUBLISHED)
def test_published_airspace_is_asked_for(who: str) -> None:
    """By its columns alone, whatever kind a number or a code in them means."""
    role, in_doubt = account(PUBLISHED[who])
    assert role == "no_fly"
    assert in_doubt


@pytest.mark.parametrize(
    "key", ["allowed", "flight_allowed", "drone", "uav", "flying", "fly_permitted", "overflight"]
)
@pytest.mark.parametrize("value", [False, "no", "No", "false", "nein"])
def test_what_is_not_permitted_is_forbidden(key: str, value: object) -> None:
    """A value that says no to flying forbids as plainly as a word."""
    assert account({key: value}) == ("no_fly", False)
    assert account({key: True}) == ("roi", False)
    assert account({f"{key}_required": value}) == ("roi", False)


@pytest.mark.parametrize("word", WORDS)
def test_words_of_what_is_not_permitted(word: str) -> None:
    """They forbid as words of prohibition do; that there is no limit leaves it open."""
    assert account({"name": word}) == ("no_fly", False)
    assert account({"name": "X", "note": word})[0] == "no_fly"


def test_values_of_a_region_are_no_airspace() -> None:
    """Heights, floors of houses and our own members say nothing of airspace."""
    assert account({"name": "Champ", "limite": "parcelle 12", "floor": 2}) == ("roi", False)
    assert account(
        {"name": "Field", "height": 12, "floors": 3, "floor_m": 30, "ceiling_m": 90, "crop": "rye"}
    ) == ("roi", False)


def test_zones_under_the_older_name_of_their_list() -> None:
    """ED-269's list as UASZoneList; JSON that holds no shapes says what it holds."""
    projection = {"type": "Polygon", "coordinates": SQUARE}
    volume = {"uomDimensions": "M", "lowerLimit": 0, "upperLimit": 120, "horizontalProjection": projection}
    zone = {"identifier": "X1", "restriction": "PROHIBITED", "geometry": [volume]}
    (shape,) = import_regions(json.dumps({"UASZoneList": [zone]}).encode(), ImportOptions()).shapes
    assert (shape.role, shape.in_doubt) == ("no_fly", False)
    with pytest.raises(RegionFileError, match="areas"):
        import_regions(
            json.dumps({"areas": [{"lat": 47.3, "lng": 8.5, "radius": 5000}]}).encode(), ImportOptions()
        )
