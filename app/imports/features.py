"""Shapes of a file as features of a scenario: each gets a role, its own name, and what the role needs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from app.imports.drawing import closed, forbidden_area, geometry, mended, on_earth
from app.imports.errors import RegionFileError, file_error
from app.imports.options import NONE, ImportOptions
from app.imports.roles import KEEP_AWAY, KINDS, Verdict, verdicts
from app.imports.shapes import MAX_POSITIONS, MAX_SHAPES, Shape
from app.imports.values import add_values
from planner.errors import Finding

MAX_FINDINGS = 20
#: Characters of a folder's text in the account of a shape; all of it counts.
_MOST_SHOWN = 200


@dataclass(frozen=True, slots=True)
class Account:
    """What one shape of the file became.

    Parameters
    ----------
    number
        Its place in the file, from 1.
    name
        As in the file.
    folders
        What it lies in, outermost first.
    kind
        ``polygon``, ``line`` or ``point``.
    role
        Its role; ``none`` where it is left out.
    why
        What says so.
    in_doubt
        Whether its role has to be settled before anything is planned.
    features
        Names of the features made of it.
    """

    number: int
    name: str
    folders: tuple[str, ...]
    kind: str
    role: str
    why: str
    in_doubt: bool
    features: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Made:
    """Features, what each shape became, and what could not be taken or lacks something."""

    features: list[dict[str, Any]] = field(default_factory=list)
    accounts: list[Account] = field(default_factory=list)
    findings: list[Finding] = field(default_factory=list)


def features(shapes: Sequence[Shape], options: ImportOptions, notes: list[str]) -> Made:
    """The features, in the file's order.

    A shape that can take no part is left out and found; one that keeps the aircraft away and lacks something
    stays as it is, to be refused with the scenario until it is mended.

    Raises
    ------
    RegionFileError
        With a finding for each shape, where none can take a part as it is.
    """
    if not shapes:
        raise file_error("no-shapes", "the file holds no polygon, line or point", "draw some")
    if len(shapes) > MAX_SHAPES or sum(shape.positions for shape in shapes) > MAX_POSITIONS:
        raise file_error(
            "too-many-shapes",
            f"the file holds {len(shapes)} shapes with {sum(s.positions for s in shapes)} positions",
            f"keep to {MAX_SHAPES} shapes and {MAX_POSITIONS} positions",
        )
    made = Made()
    given = _Names()
    whole = 0
    for number, (shape, verdict) in enumerate(zip(shapes, verdicts(shapes, options), strict=True), 1):
        names: list[str] = []
        why = verdict.why
        for piece in _pieces(shape, verdict.role, options, notes):
            name = given.free(piece.name or verdict.role, numbered=not piece.name)
            wrong, feature = _feature(name, piece, verdict, options, notes)
            made.findings.extend(wrong)
            if feature is None:
                why = f"{verdict.why}: {verdict.role}, but it {wrong[0].message}"
            else:
                made.features.append(feature)
                names.append(name)
                whole += not wrong
        made.accounts.append(
            Account(
                number,
                shape.name,
                tuple(folder[:_MOST_SHOWN] for folder in shape.folders),
                shape.kind,
                verdict.role if names else NONE,
                why,
                bool(verdict.doubt),
                tuple(names),
            )
        )
    if not whole:
        _refuse(made)
    return made


def _refuse(made: Made) -> None:
    findings = list(made.findings) or [
        Finding(
            account.name or f"#{account.number}",
            "role-unknown",
            f"is left out: {account.why}",
            f"give the import a role, or one for this {account.kind}, e.g. #{account.number}=roi",
        )
        for account in made.accounts
    ]
    more = len(findings) - MAX_FINDINGS
    detail = f"{findings[0].feature}: {findings[0].message}"
    if more > 0:
        findings = findings[:MAX_FINDINGS]
        detail += f" (and {more} findings more than listed)"
    raise RegionFileError(detail, tuple(findings))


def _pieces(shape: Shape, role: str, options: ImportOptions, notes: list[str]) -> list[Shape]:
    """The shape as so many as its role wants."""
    if role == NONE:
        return []
    shape = _without_bad_holes(shape, notes)
    if role == "roi":
        return [shape]
    shape = closed(shape, role)
    pieces = [replace(shape, parts=(part,)) for part in shape.parts]
    return [_enclosing(piece, options, notes) for piece in pieces] if role == "no_fly" else pieces


def _without_bad_holes(shape: Shape, notes: list[str]) -> Shape:
    if shape.kind != "polygon" or all(len(set(hole)) > 2 for part in shape.parts for hole in part[1:]):
        return shape
    notes.append(f"{shape.name or 'a polygon'} has holes of less than three corners, which are left out")
    parts = tuple((part[0], *(hole for hole in part[1:] if len(set(hole)) > 2)) for part in shape.parts)
    return replace(shape, parts=parts)


def _enclosing(piece: Shape, options: ImportOptions, notes: list[str]) -> Shape:
    """A no-fly shape that is no outline yet."""
    outer = piece.parts[0][0]
    if piece.kind == "point" or not all(on_earth(place) for ring in piece.parts[0] for place in ring):
        return piece
    if piece.kind == "polygon" and len(set(outer)) > 2:
        area = mended(piece)
        if area is not None:
            notes.append(f"{piece.name or 'a no-fly zone'} crosses itself: all that it encloses is forbidden")
        return area or piece
    width_m = options.width_m
    own = piece.properties.get("width_m", "")
    try:
        width_m = float(own) if own else width_m
    except ValueError:
        notes.append(f"{piece.name or 'a line'}: width_m is {own[:40]!r} and is not used")
    area = forbidden_area(piece, width_m if width_m is not None and 0.0 < width_m < 1e6 else None)
    if area is None:
        return piece
    notes.append(f"{piece.name or 'a no-fly line'} is an open line: what it encloses closed is forbidden")
    return area


def _feature(
    name: str, shape: Shape, verdict: Verdict, options: ImportOptions, notes: list[str]
) -> tuple[list[Finding], dict[str, Any] | None]:
    """What is wrong, and the feature; None where it can take no part."""
    role = verdict.role
    wrong, fatal = _judge(name, role, shape)
    properties: dict[str, Any] = {"role": role, "name": name}
    if role == "roi":
        properties |= shape.wishes
    wrong += add_values(properties, name, role, shape, options, notes)
    if fatal or (wrong and role not in KEEP_AWAY):
        return wrong, None
    if verdict.doubt:
        properties["role_in_doubt"] = verdict.why
    return wrong, {"type": "Feature", "id": name, "geometry": geometry(shape), "properties": properties}


class _Names:
    """Names given so far; each feature has one of its own."""

    def __init__(self) -> None:
        self._taken: set[str] = set()
        self._counts: dict[str, int] = {}

    def free(self, name: str, *, numbered: bool) -> str:
        """The name, or else with the next number that nothing has."""
        count = self._counts.get(name, 1)
        candidate = f"{name} {count}" if numbered else name
        while candidate in self._taken:
            count += 1
            candidate = f"{name} {count}"
        self._counts[name] = count
        self._taken.add(candidate)
        return candidate


def _judge(name: str, role: str, shape: Shape) -> tuple[list[Finding], bool]:
    """What is wrong, and whether nothing can be drawn of it."""
    found: list[Finding] = []
    if shape.kind not in KINDS[role]:
        message = f"is a {shape.kind}, which cannot be a {role}"
        fix = f"draw a {' or '.join(KINDS[role])}, or choose another role"
        found.append(Finding(name, "wrong-geometry", message, fix))
    for part in shape.parts:
        for positions in part:
            wrong = next((p for p in positions if not on_earth(p)), None)
            if wrong is not None:
                lon, lat = wrong
                message = f"has longitude {lon:g}, latitude {lat:g}"
                swapped = abs(lat) <= 180.0 and abs(lon) <= 90.0
                fix = (
                    "the two seem to be swapped"
                    if swapped
                    else "give degrees, or the file's reference system"
                )
                return [*found, Finding(name, "latitude-out-of-range", message, fix)], True
            if shape.kind == "polygon" and len(set(positions)) < 3:
                message = f"has a ring of {len(set(positions))} corners"
                found.append(Finding(name, "ring-too-short", message, "give three or more"))
                return found, True
            if shape.kind == "line" and len(set(positions)) < 2:
                return [*found, Finding(name, "line-too-short", "has no length", "give two places")], True
    return found, False
