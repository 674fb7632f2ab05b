"""GML 2 and 3 (simple features, and circles): the features of a collection with their values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from app.imports.crs import ToWgs84, mover, written_crs
from app.imports.errors import file_error
from app.imports.gml_geometry import GEOMETRIES, Positions, shapes_in
from app.imports.notes import Notes
from app.imports.shapes import Shape, labelled, moved
from app.imports.xml import child_text, children, local_name, parse

_MEMBERS = ("featureMember", "featureMembers", "member", "hasMember")
_NAMES = ("name", "title", "label", "bezeichnung", "nom", "fieldname", "id")
_MAX_TEXT = 20_000


@dataclass(frozen=True, slots=True)
class _Given:
    """What the elements about a geometry say of its coordinates."""

    system: str | None = None
    dimension: int | None = None


def is_gml(root: Element) -> bool:
    """Whether a document of no other format holds geometry of GML."""
    return any("opengis.net/gml" in element.tag for element in root.iter() if isinstance(element.tag, str))


def read_gml(data: bytes, crs: str | None, notes: Notes) -> list[Shape]:
    """The shapes of a GML document.

    Raises
    ------
    RegionFileError
        Where a geometry cannot be read, or names no reference system and none is given.
    """
    root = parse(data, notes)
    shapes: list[Shape] = []
    above = tuple(text for key in ("name", "description") if (text := child_text(root, key)))
    for feature, given in _features(root, _given(root, _Given())):
        folders = (local_name(feature),) if feature is root else (*above, local_name(feature))
        shapes += _of_feature(feature, folders, given, crs, notes)
    return shapes


def _features(element: Element, given: _Given) -> Iterator[tuple[Element, _Given]]:
    """Features of collections, in collections too; the document itself where it is none."""
    members = [child for member in children(element, *_MEMBERS) for child in member]
    if not members:
        yield element, given
    for member in members:
        yield from _features(member, _given(member, given))


def _given(element: Element, above: _Given) -> _Given:
    """The reference system of the element or of its box, else the one above."""
    holders = [element]
    for box in children(element, "boundedBy"):
        holders += [inner for inner in box if local_name(inner) in ("Envelope", "Box")]
    system = next((holder.get("srsName") for holder in holders if holder.get("srsName")), above.system)
    dimension = next((holder.get("srsDimension") for holder in holders if holder.get("srsDimension")), None)
    if dimension is None:
        return replace(above, system=system)
    if dimension not in ("2", "3"):
        raise file_error("gml", f"srsDimension is {dimension[:20]!r}", "write 2 or 3")
    return _Given(system, int(dimension))


def _of_feature(
    feature: Element, folders: tuple[str, ...], given: _Given, crs: str | None, notes: Notes
) -> list[Shape]:
    texts = dict(_texts(feature))
    name = next((texts[key] for key in _NAMES if texts.get(key)), "")
    if not name:
        name = next(
            (value for key, value in feature.attrib.items() if key.rpartition("}")[2] in ("id", "fid")), ""
        )
    found: list[Shape] = []
    faults = len(notes.faults)
    for geometry, about in _geometries(feature, given):
        system = crs or about.system
        if system is None:
            raise file_error(
                "crs-missing",
                f"{name or 'a geometry'} has no srsName: what its coordinates mean is not known",
                "give crs, e.g. EPSG:4326",
            )
        move, north_first = _mover(system, crs, notes)
        positions = Positions(about.dimension or 2, north_first, name)
        with notes.one_shape(name):
            for shape in shapes_in(geometry, positions):
                found.append(moved(Shape(shape.kind, shape.parts, name, folders, texts), move))
    if not found and len(notes.faults) == faults:
        notes.append(f"{name or local_name(feature)} has no geometry and is left out")
    return labelled(found)


def _geometries(element: Element, given: _Given) -> Iterator[tuple[Element, _Given]]:
    for child in element:
        about = _given(child, given)
        if local_name(child) in GEOMETRIES:
            yield child, about
        elif local_name(child) != "boundedBy":
            yield from _geometries(child, about)


def _mover(system: str, crs: str | None, notes: Notes) -> tuple[ToWgs84 | None, bool]:
    """What brings places to WGS 84, and whether the file writes north before east.

    URNs and addresses of OGC mean the order of the authority; short codes, as GDAL reads them, east first.
    """
    found = written_crs(system)
    ordered = (
        crs is None and system.strip().lower().startswith(("urn:", "http")) and "/gml/srs/" not in system
    )
    first = found.axis_info[0].direction.lower() if found.axis_info else ""
    crs84 = "crs84" in system.lower()
    return mover(found, notes), ordered and not crs84 and first in ("north", "south")


def _texts(feature: Element) -> Iterator[tuple[str, str]]:
    """Values of the feature: elements without any of their own, by names in lower case."""
    yield "element", local_name(feature)
    for element in feature.iter():
        if len(element) == 0 and element is not feature and local_name(element) not in _COORDINATES:
            text = (element.text or "").strip()
            if text:
                yield local_name(element).lower(), text[:_MAX_TEXT]


_COORDINATES = ("pos", "posList", "coordinates", "X", "Y", "Z", "lowerCorner", "upperCorner")
