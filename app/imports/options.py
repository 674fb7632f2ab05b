"""What an import is told beside the file, and the words for it."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

from app.imports.errors import file_error
from app.imports.shapes import MAX_SHAPES, Shape

ROLES = ("roi", "threat", "no_fly", "area", "obstacle", "start", "end", "base", "importance")
_LIST = re.compile(r"#\d{1,6}(?:-\d{1,6})?(?:,\d{1,6}(?:-\d{1,6})?)*")
#: In place of a role: the shape takes no part.
NONE = "none"


@dataclass(frozen=True, slots=True)
class RoleChoice:
    """The role of one shape, or of all in a folder.

    Parameters
    ----------
    which
        ``#3`` for the third shape of the file, ``#3-5,8`` for several; else a shape's name, or the name of a
        folder, layer, document or file it lies in, in any case.
    role
        One of ``ROLES``, or ``none``.
    """

    which: str
    role: str


@dataclass(frozen=True, slots=True)
class ImportOptions:
    """What the file does not say.

    Parameters
    ----------
    role
        Role of the shapes that no folder, name or value gives one; None: polygons and lines are ``roi``,
        points are left out.
    width_m
        Width of corridors.
    radius_m
        Radius of threats and no-fly circles.
    height_m
        Height of obstacles.
    crs
        Reference system of the coordinates, ``EPSG:32611``; None for the one that the file names.
    roles
        Roles of single shapes and folders; they go before everything that the file says.
    file_name
        The file's name, whose words count like a folder's.
    """

    role: str | None = None
    width_m: float | None = None
    radius_m: float | None = None
    height_m: float | None = None
    crs: str | None = None
    roles: tuple[RoleChoice, ...] = ()
    file_name: str = ""


def read_choices(texts: Sequence[str]) -> tuple[RoleChoice, ...]:
    """Choices as they are written, ``NFZ north=roi``.

    Raises
    ------
    RegionFileError
        Rule ``bad-option``.
    """
    found: list[RoleChoice] = []
    for text in texts:
        which, sign, role = text.rpartition("=")
        if not sign or not which.strip():
            raise file_error(
                "bad-option", f"{text[:60]!r} names no shape and role", "write NAME=ROLE or #3=ROLE"
            )
        found.append(RoleChoice(which.strip(), role.strip().lower().replace("-", "_")))
    return tuple(found)


def check_options(options: ImportOptions) -> None:
    """Refuse an unknown role and lengths that are none (rule ``bad-option``)."""
    for role in (options.role, *(choice.role for choice in options.roles)):
        if role is not None and role not in ROLES and role != NONE:
            raise file_error(
                "bad-option", f"there is no role {role[:40]!r}", f"use {', '.join(ROLES)} or {NONE}"
            )
    for name in ("width_m", "radius_m", "height_m"):
        value = getattr(options, name)
        if value is not None and not 0.0 < value < math.inf:
            raise file_error("bad-option", f"{name} is {value}", "give a positive number of metres")


class Choices:
    """Choices by number and by name.

    Raises
    ------
    RegionFileError
        Rule ``bad-option``, where a choice concerns no shape: a slip of the pen would leave a zone to be
        flown over.
    """

    def __init__(self, options: ImportOptions, shapes: Sequence[Shape]) -> None:
        self._file_name = options.file_name
        self._by_number: dict[int, RoleChoice] = {}
        self._by_name: dict[str, RoleChoice] = {}
        names = {name.casefold() for shape in shapes for name in (shape.name, *shape.folders)}
        names.add(options.file_name.casefold())
        for choice in options.roles:
            numbers = _numbers(choice.which)
            if choice.which.casefold() in names:
                self._by_name[choice.which.casefold()] = choice
            elif numbers and numbers[0] >= 1 and numbers[-1] <= len(shapes):
                self._by_number.update(dict.fromkeys(numbers, choice))
            else:
                raise file_error(
                    "bad-option",
                    f"no shape or folder of the file is called {choice.which[:60]!r}",
                    "give a name as it stands in the file, or #1 for the first shape",
                )

    def of(self, shape: Shape, number: int) -> RoleChoice | None:
        """The choice that concerns a shape: by number, by name, by folder from within."""
        if number in self._by_number:
            return self._by_number[number]
        names = (shape.name, *reversed(shape.folders), self._file_name)
        return next(
            (self._by_name[name.casefold()] for name in names if name.casefold() in self._by_name), None
        )


def _numbers(which: str) -> list[int]:
    """``#3-5,8`` as 3, 4, 5, 8; empty where it is no list of numbers."""
    if not _LIST.fullmatch(which):
        return []
    found: set[int] = set()
    for part in which[1:].split(","):
        first, _, last = part.partition("-")
        found.update(range(int(first), min(int(last or first), MAX_SHAPES + 1) + 1))
    return sorted(found)
