"""Missions of every supported command through every format and back: item by item the same, or told."""

from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest

from mavlink.dialects import Autopilot, VehicleType, dialect_for
from mavlink.dialects.base import GLOBAL_FRAMES, PARAMETERS
from mavlink.dialects.mission import Mission, declared_by, home_item, numbered
from mavlink.formats import losses, read_mission, write_plan, write_waypoints
from mavlink.formats.columns import NUMBERS_FOR_PLACE
from mavlink.wire.items import Command, MissionItem
from tests.mavlink.strategies import same

FRAMES = [0, 2, 3, 5, 6, 10, 11]
WRITERS = {"plan": write_plan, "waypoints": write_waypoints}


def supported(autopilot: Autopilot, vehicle_type: VehicleType) -> list[int]:
    """Every command that a table knows, jumps aside: they name items of their own."""
    dialect = dialect_for(autopilot, vehicle_type)
    known = [command for command in range(65536) if dialect.knows(command)]
    return [command for command in known if command != Command.DO_JUMP]


def item(command: int, chance: random.Random) -> MissionItem:
    frame = chance.choice(FRAMES)
    if frame in GLOBAL_FRAMES:
        x, y = chance.randrange(-900_000_000, 900_000_001), chance.randrange(-1_800_000_000, 1_800_000_001)
    else:
        x, y = chance.randrange(-(2**31) + 1, 2**31), chance.randrange(-5, 6)
    if command in NUMBERS_FOR_PLACE and frame in GLOBAL_FRAMES:
        x = y = 0
    values = {
        name: math.nan if chance.random() < 0.2 else chance.uniform(-1e5, 1e5) for name in (*PARAMETERS, "z")
    }
    return MissionItem(0, frame, command, x=x, y=y, autocontinue=chance.random() < 0.5, **values)


def mission_of(
    commands: list[int], autopilot: Autopilot, kind: VehicleType, chance: random.Random
) -> Mission:
    items = [item(command, chance) for command in commands]
    home = (chance.uniform(-180.0, 180.0), chance.uniform(-90.0, 90.0))
    altitude_m = chance.uniform(-100.0, 4000.0)
    first = 1 if autopilot == "ardupilot" else 0
    target = float(chance.randrange(first, first + len(items)))
    items.append(MissionItem(0, 2, int(Command.DO_JUMP), param1=target, param2=2.0))
    row = replace(home_item(home, altitude_m), written=(home[1], home[0]))
    rows = [row] if autopilot == "ardupilot" else []
    return Mission(
        numbered([*rows, *items]),
        (),
        (),
        autopilot,
        "",
        kind,
        home,
        home_altitude_m=altitude_m,
        declared=declared_by(autopilot, kind),
    )


@pytest.mark.parametrize("form", ["plan", "waypoints"])
@pytest.mark.parametrize("kind", ["fixed_wing", "multirotor", "vtol"])
@pytest.mark.parametrize("autopilot", ["ardupilot", "px4"])
def test_every_supported_item_comes_back(autopilot: Autopilot, kind: VehicleType, form: str) -> None:
    """All commands of the tables in all frames, five times over; what differs is told with its number."""
    chance = random.Random(f"{autopilot} {kind} {form}")
    commands = supported(autopilot, kind) * 5
    chance.shuffle(commands)
    mission = mission_of(commands, autopilot, kind, chance)
    read = read_mission(WRITERS[form](mission), autopilot, kind)
    told = losses(mission, "plan" if form == "plan" else "waypoints")
    closed = [n for n, items in enumerate(zip(mission.mission, read.mission, strict=True)) if differ(*items)]
    assert set(closed) == numbers_in(told)
    assert (form, autopilot) == ("waypoints", "ardupilot") or not closed
    assert (read.home, read.home_altitude_m) == (mission.home, mission.home_altitude_m)
    # and what was read comes back unchanged
    assert same(read_mission(WRITERS[form](read), autopilot, kind).mission, read.mission)


def differ(meant: MissionItem, read: MissionItem) -> bool:
    return not same((meant,), (read,))


def numbers_in(told: tuple[str, ...]) -> set[int]:
    """The numbers in front of notes about items."""
    numbers: set[int] = set()
    for note in told:
        if note.startswith("item"):
            ranges = note.partition(":")[0].split(" ", 1)[1].split(", ")
            for bounds in (entry.split("–") for entry in ranges):
                numbers |= set(range(int(bounds[0]), int(bounds[-1]) + 1))
    return numbers
