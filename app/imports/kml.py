"""KML (OGC 12-007r2, and 2.0 to 2.1) and KMZ: placemarks in folders, of all documents of an archive."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from urllib.parse import unquote
from xml.etree.ElementTree import Element

from app.imports.archive import unpack
from app.imports.errors import file_error
from app.imports.notes import Notes
from app.imports.placemark import shapes_of
from app.imports.shapes import LonLat, Shape, line_of
from app.imports.xml import child_text, children, local_name, parse

_CONTAINERS = ("kml", "Document", "Folder", "NetworkLinkControl", "Update", "Create")
_MOST_LINKS = 20
_IMAGES = ("GroundOverlay", "PhotoOverlay", "ScreenOverlay")


@dataclass
class _Archive:
    """Documents of an archive by path, and which of them have been read."""

    documents: Mapping[str, bytes] = field(default_factory=dict)
    at: str = ""
    read: set[str] = field(default_factory=set)
    depth: int = 0

    def linked(self, address: str) -> str | None:
        """The document that a link of the present one leads to; None for one outside."""
        path = unquote(address.split("#")[0].split("?")[0]).strip().replace("\\", "/")
        if not path or "://" in path:
            return None
        wanted = _flat((PurePosixPath(self.at).parent / path).parts), _flat(PurePosixPath(path).parts)
        return next((name for name in self.documents if name.casefold() in wanted), None)


def _flat(parts: tuple[str, ...]) -> str:
    kept: list[str] = []
    for part in parts:
        if part == "..":
            del kept[-1:]
        elif part not in (".", "/"):
            kept.append(part)
    return "/".join(kept).casefold()


def read_kml(data: bytes, notes: Notes) -> list[Shape]:
    """The shapes of a KML document; heights are left out.

    Raises
    ------
    RegionFileError
        Where it is no KML, or a coordinate is none.
    """
    return _read(data, (), _Archive(), notes)


def read_kmz(data: bytes, notes: Notes) -> list[Shape]:
    """The shapes of every KML document in an archive."""
    documents = {
        name: content
        for name, content in unpack(data, (".kml", ".wpml")).items()
        if "__MACOSX" not in name and not PurePosixPath(name).name.startswith("._")
    }
    if not documents:
        raise file_error("no-kml", "the archive holds no .kml file", "pack a doc.kml")
    return read_documents(documents, notes)


def read_documents(documents: Mapping[str, bytes], notes: Notes) -> list[Shape]:
    """The shapes of documents that lie together.

    ``doc.kml`` first, or else the first; a document that another links to stands where the link does; those
    that nothing links to follow. Their paths are their folders, but for the name ``doc``.
    """
    archive = _Archive(documents)
    # what an aircraft of DJI flies is made of the template beside it
    order = sorted(documents, key=lambda name: (name.lower().endswith(".wpml"), name.lower() != "doc.kml"))
    main = order[0]
    shapes: list[Shape] = []
    for name in order:
        if name.lower().endswith(".wpml") and shapes:
            notes.append(f"{name} is the route made of the others and is left out")
        elif name not in archive.read:
            path = PurePosixPath(name)
            stem = () if name == main and path.stem.lower() == "doc" else (path.stem,)
            folders = (*path.parent.parts, *stem)
            archive.at = name
            archive.read.add(name)
            shapes += _read(documents[name], folders, archive, notes)
    return shapes


def _read(data: bytes, folders: tuple[str, ...], archive: _Archive, notes: Notes) -> list[Shape]:
    root = parse(data, notes)
    if local_name(root) not in ("kml", "Document", "Folder", "Placemark"):
        raise file_error("not-kml", f"the file is a <{local_name(root)[:40]}>, not KML", "send KML")
    own = _own_kinds(root)
    shapes = _take_off(root)
    ways: dict[tuple[str, ...], list[LonLat]] = {}
    for element, inside in _walk([root], folders, own):
        if local_name(element) == "NetworkLink":
            shapes += _followed(element, inside, archive, notes)
        elif local_name(element) in _IMAGES:
            notes.append(f"{child_text(element, 'name') or 'an overlay'} is an image and is left out")
        else:
            found: list[Shape] = []
            faults = len(notes.faults)
            with notes.one_shape(child_text(element, "name")):
                found = shapes_of(element, inside, own.get(local_name(element), {}), notes)
            is_waypoint = next(children(element, "index"), None) is not None
            if is_waypoint and len(found) == 1 and found[0].kind == "point":
                ways.setdefault(inside, []).append(found.pop().parts[0][0][0])
            elif not found and len(notes.faults) == faults:
                notes.append(
                    f"{child_text(element, 'name') or 'a placemark'} has no geometry and is left out"
                )
            shapes += found
    for folders, places in ways.items():
        notes.append(f"{len(places)} waypoints of a route are one line")
        shapes.append(line_of(tuple(places), "waypoints", folders))
    return shapes


def _take_off(root: Element) -> list[Shape]:
    """The place of DJI's take-off, latitude first."""
    for element in root.iter():
        if local_name(element) == "takeOffRefPoint":
            words = (element.text or "").split(",")
            try:
                return [line_of(((float(words[1]), float(words[0])),), "take-off")]
            except (ValueError, IndexError):
                raise file_error(
                    "kml-coordinates", f"takeOffRefPoint is {element.text!r:.40}", "write latitude,longitude"
                ) from None
    return []


def _walk(
    elements: list[Element], folders: tuple[str, ...], own: Mapping[str, object]
) -> Iterator[tuple[Element, tuple[str, ...]]]:
    for element in elements:
        kind = local_name(element)
        if kind == "Placemark" or kind in own or kind == "NetworkLink" or kind in _IMAGES:
            yield element, folders
        elif kind in _CONTAINERS:
            said = [child_text(element, key) for key in ("name", "description")]
            yield from _walk(list(element), (*folders, *(text for text in said if text)), own)


def _followed(link: Element, folders: tuple[str, ...], archive: _Archive, notes: Notes) -> list[Shape]:
    name = child_text(link, "name")
    inside = (*folders, name) if name else folders
    address = next(
        (
            child_text(holder, "href")
            for holder in children(link, "Link", "Url")
            if child_text(holder, "href")
        ),
        "",
    )
    target = archive.linked(address)
    if target is None:
        notes.append(f"the network link {(name or address)[:80]!r} leads elsewhere and is not followed")
        return []
    if target in archive.read:
        return []
    if archive.depth >= _MOST_LINKS:
        raise file_error(
            "kml-links", f"links lead over {_MOST_LINKS} documents down", "save it as one document"
        )
    archive.read.add(target)
    before, archive.at = archive.at, target
    archive.depth += 1
    shapes = _read(archive.documents[target], inside, archive, notes)
    archive.at = before
    archive.depth -= 1
    return shapes


def _own_kinds(root: Element) -> dict[str, dict[str, str]]:
    """Elements that a schema makes placemarks (KML 2.0 and 2.1): fields by the name of the element."""
    kinds: dict[str, dict[str, str]] = {}
    for element in root.iter():
        if local_name(element) != "Schema":
            continue
        parent = element.get("parent") or child_text(element, "parent")
        name = element.get("name") or child_text(element, "name")
        if parent == "Placemark" and name and name not in _CONTAINERS:
            fields = [field.get("name", "") or child_text(field, "name") for field in element]
            kinds[name] = {one: one for one in fields if one}
    return kinds
