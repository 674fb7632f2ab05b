"""What a dialect is, and the findings that no autopilot makes by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol

from mavlink.dialects.stores import FenceStore
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult, MissionType

Autopilot = Literal["ardupilot", "px4"]
VehicleType = Literal["fixed_wing", "multirotor", "vtol"]

PARAMETERS = ("param1", "param2", "param3", "param4")
GLOBAL_FRAMES = frozenset(
    {
        Frame.GLOBAL,
        Frame.GLOBAL_RELATIVE_ALT,
        Frame.GLOBAL_INT,
        Frame.GLOBAL_RELATIVE_ALT_INT,
        Frame.GLOBAL_TERRAIN_ALT,
        Frame.GLOBAL_TERRAIN_ALT_INT,
    }
)
POLYGON_COMMANDS = frozenset(
    {Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION, Command.NAV_FENCE_POLYGON_VERTEX_EXCLUSION}
)
CIRCLE_COMMANDS = frozenset({Command.NAV_FENCE_CIRCLE_INCLUSION, Command.NAV_FENCE_CIRCLE_EXCLUSION})


@dataclass(frozen=True, slots=True)
class DialectFinding:
    """One thing an autopilot would refuse, lose or fly otherwise than meant.

    Parameters
    ----------
    rule
        Machine-readable name, e.g. ``"unsupported-command"``.
    message
        What is wrong, with the offending value.
    seq
        The item; None for the list as a whole.
    severity
        ``"error"`` findings must not be uploaded, ``"warning"`` findings may.
    fix
        What to do about it, where that is not "plan for this autopilot".
    """

    rule: str
    message: str
    seq: int | None = None
    severity: Literal["error", "warning"] = "error"
    fix: str | None = None

    def __str__(self) -> str:
        where = "mission" if self.seq is None else f"item {self.seq}"
        return f"{where}: {self.message} ({self.rule})"


class Dialect(Protocol):
    """What one autopilot on one type of vehicle takes, alters and refuses."""

    @property
    def name(self) -> str:
        """For people, e.g. ``"ArduPlane"``."""

    @property
    def autopilot(self) -> Autopilot:
        """The family."""

    @property
    def vehicle_type(self) -> VehicleType:
        """The type of vehicle."""

    @property
    def firmware_type(self) -> int:
        """MAV_AUTOPILOT."""

    @property
    def mav_type(self) -> int:
        """MAV_TYPE."""

    @property
    def home_row(self) -> bool:
        """Whether item 0 of a mission is the home position and no item of the mission."""

    @property
    def limits(self) -> Mapping[MissionType, int]:
        """Most items of a list, home row included; a type that is absent has no known limit."""

    @property
    def fence_store(self) -> FenceStore:
        """Room for a fence on the boards that are common."""

    def knows(self, command: int) -> bool:
        """Whether a table says if the command is taken in missions."""

    def answer(self, item: MissionItem) -> MissionResult:
        """What the autopilot answers to one item, looked at by itself; ACCEPTED to commands in no table."""

    def check(self, items: tuple[MissionItem, ...]) -> tuple[DialectFinding, ...]:
        """Everything wrong with a list; empty when it may be uploaded. No items mean "clear"."""

    def expected_readback(self, items: tuple[MissionItem, ...]) -> tuple[MissionItem, ...]:
        """The items as they come back after an upload, without the home row."""


def mission_type_of(items: tuple[MissionItem, ...]) -> MissionType:
    """The type of a list; that of a mission when it is empty."""
    return items[0].mission_type if items else MissionType.MISSION


def is_polygon(command: int) -> bool:
    """Whether the command is a vertex of a fence polygon."""
    return command in POLYGON_COMMANDS


def fence_shapes(items: tuple[MissionItem, ...]) -> Iterator[tuple[int, tuple[MissionItem, ...]]]:
    """The shapes of a fence: the command, and the vertices or the one circle or point.

    A polygon takes as many items of its command as the first says in param 1, or as there are.
    """
    index = 0
    while index < len(items):
        first = items[index]
        count = 1
        if is_polygon(first.command) and math.isfinite(first.param1):
            wanted = max(1, round(first.param1))
            while (
                count < wanted
                and index + count < len(items)
                and items[index + count].command == first.command
                and items[index + count].param1 == first.param1
            ):
                count += 1
        yield first.command, items[index : index + count]
        index += count


def list_findings(
    items: tuple[MissionItem, ...], limits: Mapping[MissionType, int]
) -> Iterator[DialectFinding]:
    """Numbering, size and mixed types: the same for every autopilot."""
    kind = mission_type_of(items)
    limit = limits.get(kind)
    if limit is not None and len(items) > limit:
        yield DialectFinding(
            "too-many-items",
            f"{len(items)} items, the vehicle holds {limit}",
            fix=_fewer(kind, len(items), limit),
        )
    for index, item in enumerate(items):
        if item.seq != index:
            yield DialectFinding("sequence", f"numbered {item.seq}, stands at {index}", item.seq)
        if item.mission_type != kind:
            yield DialectFinding(
                "mixed-types", f"of type {item.mission_type.name} in a {kind.name} list", item.seq
            )


def _fewer(kind: MissionType, count: int, limit: int) -> str:
    if kind is MissionType.MISSION:
        sorties = math.ceil(count / limit)
        return f"split it into at least {sorties} sorties: plan each with a part of the regions"
    if kind is MissionType.FENCE:
        return f"draw no-fly zones and the area with {count - limit} corners less, or leave zones out"
    return f"leave out {count - limit} rally points"


def unlisted_finding(name: str, item: MissionItem) -> DialectFinding:
    """A command in no table: somebody's own firmware may take it."""
    return DialectFinding(
        "unlisted-command",
        f"it is not known whether {name} takes command {item.command}: its answer will tell",
        item.seq,
        severity="warning",
    )


def place_findings(item: MissionItem, zero_means_here: bool) -> Iterator[DialectFinding]:
    """Places no autopilot complains about: outside the globe, or at latitude 0, longitude 0."""
    if abs(item.x) > 900_000_000 or abs(item.y) > 1_800_000_000:
        yield DialectFinding(
            "place-out-of-range", f"latitude {item.x / 1e7}, longitude {item.y / 1e7}", item.seq
        )
    elif item.x == 0 and item.y == 0 and not zero_means_here:
        yield DialectFinding("place-zero", "latitude 0, longitude 0 is in the Gulf of Guinea", item.seq)
    if not math.isfinite(item.z):
        yield DialectFinding("altitude", f"altitude is {item.z}", item.seq)


def jump_findings(items: tuple[MissionItem, ...], first: int) -> Iterator[DialectFinding]:
    """DO_JUMP to items that are not there; PX4 does not complain about them."""
    for item in items:
        if item.command != Command.DO_JUMP:
            continue
        target = item.param1
        if not (math.isfinite(target) and first <= target < len(items)):
            yield DialectFinding("jump-target", f"jumps to {target:g} of {len(items)} items", item.seq)


def fence_findings(items: tuple[MissionItem, ...], store: FenceStore) -> Iterator[DialectFinding]:
    """Size, vertex counts and radii; a NaN radius stops some autopilots altogether."""
    shapes = list(fence_shapes(items))
    polygons = [len(shape) for command, shape in shapes if is_polygon(command)]
    lacks = store.lacks(polygons, len(shapes) - len(polygons))
    if lacks and store.size_bytes is not None:
        fix = "draw no-fly zones and the area with fewer corners, leave zones out, or store fences on a card"
        yield DialectFinding("fence-storage", lacks, fix=f"{fix} (BRD_SD_FENCE)")
    for command, shape in shapes:
        first = shape[0]
        if is_polygon(command):
            if not math.isfinite(first.param1) or len(shape) != round(first.param1):
                yield DialectFinding(
                    "fence-vertices",
                    f"the polygon says {first.param1:g} vertices and has {len(shape)}",
                    first.seq,
                )
            elif len(shape) < 3:
                yield DialectFinding("fence-vertices", f"a polygon of {len(shape)} vertices", first.seq)
        elif command in CIRCLE_COMMANDS:
            if not (math.isfinite(first.param1) and first.param1 > 0.0):
                yield DialectFinding("fence-radius", f"a circle of radius {first.param1}", first.seq)
        elif command != Command.NAV_FENCE_RETURN_POINT:
            yield DialectFinding("unsupported-command", f"command {command} in a fence", first.seq)
        for item in shape:
            yield from place_findings(item, zero_means_here=False)


def finite(item: MissionItem) -> bool:
    """Whether all four parameters are numbers."""
    return all(math.isfinite(getattr(item, name)) for name in PARAMETERS)
