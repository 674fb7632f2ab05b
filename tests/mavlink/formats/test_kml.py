"""KML, read back as XML."""

from __future__ import annotations

from dataclasses import replace
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.geometry import Point, Polygon

from mavlink.formats import write_kml
from planner.plan import Fence, Plan, ZoneCircle
from tests.mavlink.cameras import with_photos
from tests.mavlink.plans import FRAME, lonlat, make_plan, square_fence

KML = "{http://www.opengis.net/kml/2.2}"


def placemarks(text: str) -> dict[str, ElementTree.Element]:
    root = ElementTree.fromstring(text)
    found = list(root.iter(f"{KML}Placemark"))
    named = {mark.findtext(f"{KML}name", ""): mark for mark in found}
    assert len(named) == len(found)
    return named


def coordinates(mark: ElementTree.Element) -> list[tuple[float, ...]]:
    text = mark.find(f".//{KML}coordinates")
    assert text is not None
    return [tuple(float(value) for value in point.split(",")) for point in (text.text or "").split()]


def test_path_collects_and_footprints_are_placemarks() -> None:
    """The path has the plan's line, collects both ends, footprints closed rings."""
    plan = make_plan()
    marks = placemarks(write_kml(plan))
    assert coordinates(marks["path of uav-1"]) == [pytest.approx(point) for point in plan.paths[0].line]
    assert coordinates(marks["collect 1: R2"]) == [pytest.approx(point) for point in plan.collects[1].line]
    ring = coordinates(marks["footprint 0: R1"])
    assert ring[0] == ring[-1]
    assert [point[:2] for point in ring[:-1]] == [pytest.approx(p) for p in plan.footprints[0].ring]
    assert coordinates(marks["home"])[0][:2] == pytest.approx(plan.home)
    assert len(coordinates(marks["area"])) == 5


def test_photos_are_where_they_are_taken() -> None:
    """The places of each collect's photos are one placemark, at their heights."""
    plan = with_photos(make_plan())
    marks = placemarks(write_kml(plan))
    for photos in plan.photos:
        mark = marks[f"photos {photos.seq}: eye"]
        found = [text.text or "" for text in mark.iter(f"{KML}coordinates")]
        places = [tuple(float(value) for value in text.split(",")) for text in found]
        assert places == [pytest.approx(place) for place in photos.places]
        assert {text.text for text in mark.iter(f"{KML}altitudeMode")} == {"relativeToGround"}


@pytest.mark.parametrize(
    ("reference", "mode"),
    [("amsl", "absolute"), ("home", "relativeToGround"), ("terrain", "relativeToGround")],
)
def test_heights_have_their_datum(reference: str, mode: str) -> None:
    """Heights over the sea are absolute, others count from the ground."""
    marks = placemarks(write_kml(replace(make_plan(), altitude_reference=reference)))
    assert marks["path of uav-1"].findtext(f".//{KML}altitudeMode") == mode
    assert marks["collect 0: R1"].findtext(f".//{KML}altitudeMode") == mode


def test_names_may_hold_anything() -> None:
    """Signs with a meaning in XML come back as they were."""
    plan = make_plan()
    odd = 'Site <A> & "B"'
    collects = tuple(replace(collect, roi=odd) for collect in plan.collects)
    text = write_kml(replace(plan, name=odd, collects=collects))
    assert f"collect 0: {odd}" in placemarks(text)
    assert ElementTree.fromstring(text).findtext(f".//{KML}Document/{KML}name") == odd


@given(st.text(max_size=30))
@settings(max_examples=50, deadline=None)
def test_any_name_leaves_a_readable_file(name: str) -> None:
    """Control characters and half sections do not break the file."""
    text = write_kml(replace(make_plan(), name=name + "<![CDATA[\x00"))
    assert len(placemarks(text)) >= 6


def test_circles_become_rings() -> None:
    """A disc of the fence is drawn as a ring of its radius."""
    fence = Fence(square_fence(6000.0).inclusion, (), (ZoneCircle("tower", lonlat((900.0, 900.0)), 250.0),))
    marks = placemarks(write_kml(make_plan(fence=fence)))
    ring = Polygon(FRAME.to_local([point[:2] for point in coordinates(marks["tower"])]))
    assert ring.area == pytest.approx(Point(900.0, 900.0).buffer(250.0).area, rel=0.01)
    assert ring.centroid.distance(Point(900.0, 900.0)) < 0.1


def fleet() -> Plan:
    plan = make_plan()
    second = replace(plan.vehicles[0], name="uav-2")
    path = replace(plan.paths[0], vehicle="uav-2")
    return replace(plan, vehicles=(*plan.vehicles, second), paths=(*plan.paths, path))


def test_one_vehicle_or_all() -> None:
    """Without a name every path is drawn, with one only its own; an unknown name is refused."""
    assert {"path of uav-1", "path of uav-2"} <= placemarks(write_kml(fleet())).keys()
    assert "path of uav-1" not in placemarks(write_kml(fleet(), "uav-2"))
    with pytest.raises(ValueError, match="uav-3"):
        write_kml(fleet(), "uav-3")


def test_the_same_plan_gives_the_same_file() -> None:
    """Nothing in the file counts up from one export to the next."""
    assert write_kml(make_plan()) == write_kml(make_plan())
