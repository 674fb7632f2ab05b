"""Mission files of every format, spoiled in their structure: read, or refused by name, and nothing else."""

from __future__ import annotations

import copy
import json
import math
import random
from pathlib import Path
from typing import Any

import pytest

from mavlink.dialects.mission import Mission
from mavlink.formats import FormatError, losses, read_mission, write_plan, write_waypoints
from mavlink.wire.items import MissionType

FAULTS = Path(__file__).parents[2] / "faults"
RUNS = 500
RUBBISH: list[Any] = [
    None, True, -1, 0, 3, 99999, 1e300, -0.5, "", "x", "nan", [], {}, [[]], [None] * 7, [1, 2], {"type": 1},
    math.nan, math.inf, 1e39, 1e-45, 10**20, 10**400, "1e400", "1_000", "٣", "５", "−5", "1,5", "0x10",
    "\ufeff", [[[[[[[[1]]]]]]]],
]  # fmt: skip
ROWS = (FAULTS / "04-fence-file.waypoints").read_text() + "6\t0\t3\t16\t0\t0\t0\t0\t47.1\t8.2\t40\t1\n"
PARTS = ("command", "frame", "param1", "param2", "param3", "param4", "x", "y", "z", "autocontinue")
PAIRS = "47.1 8.2\n47.0 8.1\n47.2 8.1\n47.2 8.3\n47.0 8.1\n"


def plan() -> dict[str, Any]:
    document: dict[str, Any] = json.loads((FAULTS / "landing-speed.plan").read_text())
    corners = [[47.0, 8.1], [47.2, 8.1], [47.2, 8.3]]
    document["geoFence"]["polygons"] = [{"polygon": corners, "inclusion": True, "version": 1}]
    document["geoFence"]["circles"] = [{"circle": {"center": [47.1, 8.2], "radius": 50}, "inclusion": False}]
    document["rallyPoints"]["points"] = [[47.1, 8.2, 30]]
    jump = {"type": "SimpleItem", "command": 177, "frame": 2, "params": [1, 2, 0, 0, 0, 0, 0]}
    document["mission"]["items"].append(jump)
    return document


def old() -> dict[str, Any]:
    item = {"command": 16, "frame": 3, "id": 1, "coordinate": [47.1, 8.2, 30], "type": "missionItem"}
    item |= {f"param{n}": 0 for n in range(1, 5)}
    head = {"MAV_AUTOPILOT": 3, "complexItems": [], "version": "1.0", "plannedHomePosition": dict(item)}
    return {**head, "items": [dict(item), {**item, "id": 2}]}


def places(value: Any) -> list[tuple[Any, Any]]:
    """Every member and entry of a document: its holder and its key."""
    if isinstance(value, dict):
        found = [(value, key) for key in value]
    elif isinstance(value, list):
        found = [(value, index) for index in range(len(value))]
    else:
        return []
    return [*found, *(place for holder, key in found for place in places(holder[key]))]


def spoiled_json(document: dict[str, Any], chance: random.Random) -> str:
    document = copy.deepcopy(document)
    for _ in range(chance.randint(1, 3)):
        holder, key = chance.choice(places(document))
        match chance.randrange(4):
            case 0:
                del holder[key]
            case 1:
                holder[key] = copy.deepcopy(chance.choice(RUBBISH))
            case 2:
                other, name = chance.choice(places(document))
                holder[key] = copy.deepcopy(other[name])
            case _ if isinstance(holder, list):
                holder.insert(key, copy.deepcopy(holder[key]))
        if not places(document):
            break
    text = json.dumps(document)
    if chance.random() < 0.2:
        # A member that stands twice: what comes first is what most readers do not see.
        name = chance.choice(["items", "params", "geoFence", "command", "frame", "inclusion"])
        text = text.replace(f'"{name}":', f'"{name}": {json.dumps(chance.choice(RUBBISH))}, "{name}":', 1)
    return chance.choice(["", "", "\ufeff"]) + text


def spoiled_text(text: str, chance: random.Random) -> str:
    lines = text.splitlines()
    for _ in range(chance.randint(1, 3)):
        number = chance.randrange(len(lines))
        words = lines[number].replace(" ", "\t").split("\t")
        match chance.randrange(5):
            case 0:
                words[chance.randrange(len(words))] = str(chance.choice(RUBBISH))
            case 1:
                words.pop(chance.randrange(len(words)))
            case 2:
                words.insert(chance.randrange(len(words)), chance.choice(["7", "", "#", "5001", "1e9"]))
            case 3:
                lines.insert(number, lines[chance.randrange(len(lines))])
            case _:
                lines[number] = ""
                continue
        lines[number] = "\t".join(words)
    return chance.choice(["", "\ufeff"]) + "".join(line + chance.choice(["\n", "\r\n"]) for line in lines)


def listed(mission: Mission) -> list[str]:
    """Every number of every list, not a number as a word."""
    return [
        f"{kind.name} {[float(getattr(item, part)) for part in PARTS]} {item.written}"
        for kind in MissionType
        for item in mission.items_of(kind)
    ]


@pytest.mark.parametrize("name", ["plan", "mission", "waypoints", "fence"])
def test_spoiled_files_are_read_or_refused(name: str) -> None:
    """FormatError at most; what is read is written and read back the same, or the loss is told."""
    chance = random.Random(name)
    refused = 0
    for _ in range(RUNS):
        text = {
            "plan": lambda: spoiled_json(plan(), chance),
            "mission": lambda: spoiled_json(old(), chance),
            "waypoints": lambda: spoiled_text(ROWS, chance),
            "fence": lambda: spoiled_text(PAIRS, chance),
        }[name]()
        try:
            mission = read_mission(text)
        except FormatError:
            refused += 1
            continue
        for form, write in (("plan", write_plan), ("waypoints", write_waypoints)):
            lost = losses(mission, "plan" if form == "plan" else "waypoints")
            try:
                written = write(mission)
            except FormatError:
                # A circle without a radius: it was told, and bars the upload.
                assert mission.unread
                continue
            again = read_mission(written, mission.autopilot, mission.vehicle_type)
            assert lost or listed(again) == listed(mission), (text, written)
    assert 0 < refused < RUNS
