"""Which role a shape of a file has, and why. In doubt it forbids flying, and its role is to be asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from shapely import Polygon, contains_xy, prepare, union_all
from shapely.geometry.base import BaseGeometry

from app.imports.airspace import airspace_of
from app.imports.buildings import standing
from app.imports.options import NONE, ROLES, Choices, ImportOptions, RoleChoice
from app.imports.rings import encloses
from app.imports.shapes import Shape
from app.imports.words import (
    forbids,
    is_false,
    keeps_inside,
    permits_not,
    plain,
    role_of,
    says_either,
    threatens,
)

KINDS: dict[str, tuple[str, ...]] = {
    "roi": ("polygon", "line", "point"),
    "threat": ("point",),
    "no_fly": ("polygon", "point"),
    "obstacle": ("polygon",),
    "area": ("polygon",),
    "start": ("point",),
    "end": ("point",),
    "base": ("point",),
    "importance": ("polygon",),
}
#: Roles that keep the aircraft away; a shape that cannot have its own of them forbids all the same.
KEEP_AWAY = ("threat", "no_fly", "obstacle")
_TERMINALS = ("start", "end", "base")
#: Values that say what a thing is.
_SAYING = (
    "type", "kind", "class", "category", "zone_type", "zonetype", "area_type", "fence_type", "fencetype",
    "layer", "purpose", "usage", "restriction",
    "limite", "remarque",
    # of OpenStreetMap
    "aeroway", "landuse", "military", "amenity", "leisure", "boundary",
)  # fmt: skip
#: Kinds of airspace by their letters.
_LETTERS = frozenset(("P", "R", "D", "Q", "W"))
#: Values of ours: their names hold no words of others.
_OURS = frozenset(
    ("role", "width_m", "radius_m", "priority", "min_resolution_m", "intensity_m", "height_m", "floor_m",
     "ceiling_m", "base_m", "score", "heading_deg", "model")
)  # fmt: skip


#: What says so, the word, and whether it says little else.
_Forbidden = tuple[str, str, bool]
#: Characters of a text that is no name or value any more.
_PROSE = 80


@dataclass(frozen=True, slots=True)
class Verdict:
    """A shape's role.

    Parameters
    ----------
    role
        One of ``ROLES``, or ``none`` where the shape takes no part.
    why
        What says so, in words.
    doubt
        Whether it has to be settled before anything is planned: ``open`` where ``role`` of the options
        settles it, ``contradiction`` where only a choice for the shape itself does.
    """

    role: str
    why: str
    doubt: Literal["", "open", "contradiction"] = ""


def verdicts(shapes: Sequence[Shape], options: ImportOptions) -> list[Verdict]:
    """The role of each shape, in order."""
    named = _named_polygons(shapes)
    choices = Choices(options, shapes)
    found = [
        _verdict(shape, options, choices.of(shape, number), named) for number, shape in enumerate(shapes, 1)
    ]
    seen_start = False
    for index, verdict in enumerate(found):
        if verdict.role == "start" and shapes[index].kind == "point":
            if seen_start:
                found[index] = Verdict("base", f"{verdict.why}, and there is a start already")
            seen_start = True
    return found


def _verdict(
    shape: Shape, options: ImportOptions, choice: RoleChoice | None, named: Mapping[str, BaseGeometry]
) -> Verdict:
    if choice is not None:
        return Verdict(choice.role, f"chosen for {choice.which!r}")
    if shape.label or _labels(shape, named):
        return Verdict(NONE, "it only labels the polygon of its name")
    told = _told(shape, options)
    if told is not None and (not told.doubt or (told.doubt == "contradiction" and options.role != "no_fly")):
        return told
    if options.role is not None:
        return Verdict(options.role, "role of the import")
    if told is not None:
        return told
    if shape.kind == "point":
        return Verdict(NONE, "nothing says what this point is")
    return Verdict("roi", "nothing says otherwise")


def _told(shape: Shape, options: ImportOptions) -> Verdict | None:
    """What the file says, by its words."""
    texts = list(_texts(shape, options))
    own = shape.properties.get("role", "").strip()
    forbidden = _forbidden(texts, shape)
    if own:
        return _by_own_role(own, shape, forbidden if forbidden is not None and forbidden[2] else None)
    said = _built(shape, options) or _said(texts, shape)
    if forbidden is not None:
        where, word, plainly = forbidden
        why = f"{where} says {word!r}"
        if not plainly:
            return _by_prose(shape, said, why)
        if said is None or said.role in KEEP_AWAY:
            # over an obstacle and through a threat one may fly
            return Verdict("no_fly", why)
        if shape.kind == "point" and said.role in _TERMINALS:
            return said
        return Verdict("no_fly", f"{why}, but {said.why}", "contradiction")
    if said is not None:
        return said
    if shape.kind == "point" and "radius_m" not in shape.properties:
        return None
    for where, text in texts:
        if inside := keeps_inside(text):
            doubt: Literal["", "open"] = "open" if shape.kind == "point" else ""
            return Verdict("no_fly" if doubt else "area", f"{where} says {inside!r}", doubt)
    letter = next((key for key in _SAYING if shape.properties.get(key, "").upper() in _LETTERS), None)
    if letter is not None:
        return Verdict(
            "no_fly", f"its {letter} is {shape.properties[letter]!r}, as of a restricted area", "open"
        )
    column = airspace_of(shape.properties, _OURS)
    if column is not None:
        return Verdict("no_fly", f"its {column[:40]} is a column of airspace", "open")
    for where, text in texts:
        if either := says_either(text):
            return Verdict("no_fly", f"{where} says {either!r}, which can mean either side", "open")
    return None


def _built(shape: Shape, options: ImportOptions) -> Verdict | None:
    """What a building is: an obstacle, or where its height is not known a zone at every height."""
    building = standing(shape)
    if building is None or (shape.kind != "polygon" and not _closable(shape, "obstacle")):
        return None
    if building.height_m is None and options.height_m is None:
        return Verdict("no_fly", f"{building.why}, and its height is not known: it forbids at every height")
    return Verdict("obstacle", building.why)


def _by_prose(shape: Shape, said: Verdict | None, why: str) -> Verdict | None:
    """Where a longer text speaks of a restriction, it may be another place's: to be asked for."""
    if said is not None and (said.role in KEEP_AWAY or shape.kind == "point"):
        return said
    return None if shape.kind == "point" else Verdict("no_fly", f"{why}, in a longer text", "open")


def _by_own_role(own: str, shape: Shape, forbidden: _Forbidden | None) -> Verdict:
    why = f"its role is {own[:40]!r}"
    role = own.lower() if own.lower() in ROLES else role_of(own)
    if role is None and forbids(own):
        role = "no_fly"
    if role is None and keeps_inside(own):
        role = "area"
    if role is None:
        return Verdict("no_fly", f"{why}, which is none of ours", "open")
    if forbidden is None or role in KEEP_AWAY or (role in _TERMINALS and shape.kind == "point"):
        return Verdict(role, why)
    return Verdict("no_fly", f"{forbidden[0]} says {forbidden[1]!r}, but {why}", "contradiction")


def _texts(shape: Shape, options: ImportOptions) -> Iterator[tuple[str, str]]:
    """What says something of the shape, from within, each with how to name it."""
    yield "its name", shape.name
    for key in _SAYING:
        if key in shape.properties:
            yield f"its {key}", shape.properties[key]
    for folder in reversed(shape.folders):
        yield f"the folder {folder[:60]!r}", folder
    # the ending is none of its words
    yield "the file's name", options.file_name.rpartition(".")[0] or options.file_name


def _forbidden(texts: Sequence[tuple[str, str]], shape: Shape) -> _Forbidden | None:
    """What forbids flying, what says so plainly first."""
    found = [(where, word, len(text) <= _PROSE) for where, text in texts if (word := forbids(text))]
    found += _forbidden_by_value(shape)
    return next((one for one in found if one[2]), found[0] if found else None)


def _forbidden_by_value(shape: Shape) -> Iterator[_Forbidden]:
    for key, value in shape.properties.items():
        if key in _OURS:
            continue
        if is_false(value):
            # inclusion=false and allowed=no forbid, exclusion=false says nothing
            if (keeps_inside(key) and plain(value)) or permits_not(key, value):
                yield f"its {key[:40]}", value, True
            continue
        word = forbids(value) or (None if says_either(value) else forbids(key))
        if word is not None:
            yield f"its {key[:40]}", word, len(value) <= _PROSE


def _said(texts: Sequence[tuple[str, str]], shape: Shape) -> Verdict | None:
    """The innermost text that means a role and nothing else, or speaks of threats."""
    model = shape.properties.get("model", "").lower()
    if shape.kind == "point" and model in ("missile", "radar"):
        return Verdict("threat", f"its model is {model!r}")
    for where, text in texts:
        role = role_of(text)
        vague = role is None and where != "the file's name" and threatens(text)
        if vague:
            role = "threat"
        if role is None:
            continue
        why = f"{where} says {text[:40]!r}"
        if shape.kind in KINDS[role] or _closable(shape, role):
            return Verdict(role, why)
        if role in KEEP_AWAY:
            why += f", which a {shape.kind} cannot be: it is kept clear of"
            return Verdict("no_fly", why, "open" if vague else "")
    return None


def _closable(shape: Shape, role: str) -> bool:
    line = shape.parts[0][0]
    return shape.kind == "line" and "polygon" in KINDS[role] and len(line) > 3 and line[0] == line[-1]


def _labels(shape: Shape, named: Mapping[str, BaseGeometry]) -> bool:
    """Whether it is a point within a polygon of its name that says nothing of its own."""
    if shape.kind != "point" or not shape.name or {"role", "radius_m"} & shape.properties.keys():
        return False
    area = named.get(shape.name.casefold())
    return area is not None and bool(contains_xy(area, *shape.parts[0][0][0]))


def _named_polygons(shapes: Sequence[Shape]) -> dict[str, BaseGeometry]:
    """The polygons of every name that a point has as well."""
    points = {shape.name.casefold() for shape in shapes if shape.kind == "point"}
    found: dict[str, list[Polygon]] = {}
    for shape in shapes:
        if shape.kind == "polygon" and shape.name.casefold() in points:
            rings = [Polygon(part[0]) for part in shape.parts if encloses(part[0])]
            found.setdefault(shape.name.casefold(), []).extend(ring for ring in rings if ring.is_valid)
    areas = {name: union_all(polygons) for name, polygons in found.items()}
    for area in areas.values():
        prepare(area)
    return areas
