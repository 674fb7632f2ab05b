"""Plans in a real PX4 aeroplane: stored as meant, flown as planned, the regions seen; refusals in words.

Skipped unless ``SWATHPLAN_PX4`` names the simulator's binary and ``SWATHPLAN_PX4_ROMFS`` its ``etc`` folder;
see ``px4.py``.
"""

from __future__ import annotations

import json
import lzma
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from mavlink.dialects import dialect_for
from mavlink.dialects.compare import Difference, differences
from mavlink.dialects.mission import numbered, unplaced
from mavlink.encoding.encode import encode
from mavlink.encoding.payload import ActuatorPayload
from mavlink.rules.table import judge_parameters, names_to_read, needs_of
from mavlink.state.events import KNOWN_EVENTS, event_id
from mavlink.wire.items import Command, MissionItem, MissionType
from planner.geojson import read_scenario
from planner.pipeline import make_plan
from planner.plan import Plan
from planner.scenario import Scenario
from tests.flows.flying import CASES, Figures, case_document, figures, from_end_m, inside_fence, store
from tests.flows.px4 import BINARY, ROMFS, fly, simulated

pytestmark = [
    pytest.mark.px4,
    pytest.mark.skipif(
        not (BINARY and ROMFS), reason="SWATHPLAN_PX4 and SWATHPLAN_PX4_ROMFS name no simulator"
    ),
]

AEROPLANE = dialect_for("px4", "fixed_wing")
SPEEDUP = 12.0


#: What the simulator's aeroplane is; margins for one that rolls by 1° (standard deviation): docs/px4.md.
VEHICLE = {"autopilot": "px4", "airspeed_m_s": 14.0, "min_turn_radius_m": 100.0}
MARGINS = {"pointing_margin_deg": 3.0, "position_margin_m": 5.0}


@cache
def planned(case: int = 1, settle_m: float = 100.0, *, margins: bool = False) -> tuple[Scenario, Plan]:
    """A shared case for the simulator's small aeroplane, which flies at 14 m/s."""
    document = case_document(case, {**VEHICLE, "settle_m": settle_m}, MARGINS if margins else None)
    scenario = read_scenario(document)
    return scenario, make_plan(scenario)


def compare(meant: tuple[MissionItem, ...], held: tuple[MissionItem, ...]) -> Sequence[Difference]:
    """As every upload compares."""
    return differences(meant, held, AEROPLANE)


async def flown(folder: Path, scenario: Scenario, plan: Plan) -> Figures:
    """Store a plan, fly it, and judge it: inside the fence, at its height, sensor on, landed at its end."""
    mission = encode(plan, autopilot="px4")
    async with simulated(folder, plan.home, SPEEDUP) as client:
        await store(client, mission)
        flight = await fly(client)
    samples = flight.samples()
    assert inside_fence(scenario, plan, samples)
    # It rolls out along the runway that the land item stands for.
    assert from_end_m(scenario, plan, flight.final) < 200.0
    judged = figures(scenario, plan, mission, samples)
    assert plan.altitude_m - 5.0 < judged.heights_m[0] < judged.heights_m[1] < plan.altitude_m + 5.0
    for collect, one in zip(plan.collects, judged.ground.passes, strict=True):
        assert one.sensor_on_m > collect.end_m - collect.start_m - 10.0
    return judged


async def test_without_margins_its_rolling_costs_ground(tmp_path: Path) -> None:
    """What is missing is the small aeroplane's rolling by 2°: a beam held level sees all."""
    flight = await flown(tmp_path, *planned())
    flight.tell("1", "PX4", "none", "no margins, 100 m")
    assert max(flight.cross_track_p95_m) < 3.0
    assert 0.8 < flight.least_seen < 0.995
    assert min(flight.level.fraction.values()) > 0.995


@pytest.mark.parametrize("case", CASES)
async def test_every_shared_case_is_stored_flown_and_seen(tmp_path: Path, case: int) -> None:
    """Read back equal; every pass flown near its line, inside the fence; every region seen; landed."""
    flight = await flown(tmp_path, *planned(case, 150.0, margins=True))
    flight.tell(str(case), "PX4", "none")
    assert max(flight.cross_track_p95_m) < 5.0
    assert flight.least_seen > 0.995


async def test_its_parameters_are_judged_by_what_it_holds(tmp_path: Path) -> None:
    """Every name asked for exists on it or on a board with other outputs; its set-up draws no error."""
    _, plan = planned()
    mission = encode(plan, autopilot="px4")
    needs = needs_of(plan, mission, ActuatorPayload(1), 100.0)
    names = names_to_read("px4", "fixed_wing", needs)
    async with simulated(tmp_path, plan.home, 1.0) as client:
        values = {name: read.value for name, read in (await client.read_parameters(names)).items()}
    assert {name for name in names if not name.startswith("PWM_AUX")} <= values.keys()
    assert values["PWM_MAIN_FUNC5"] == 301.0
    found = judge_parameters("px4", "fixed_wing", needs, values)
    assert [finding for finding in found if finding.severity == "error"] == []


def without(mission: tuple[MissionItem, ...], *commands: int) -> tuple[MissionItem, ...]:
    """A mission with some of its items left out."""
    return numbered([item for item in mission if item.command not in commands])


async def test_an_infeasible_mission_is_told_in_words(tmp_path: Path) -> None:
    """PX4 acknowledges it all the same; its reason is told, also when the same list is sent again."""
    _, plan = planned()
    good = encode(plan, autopilot="px4").mission
    no_landing = without(good, Command.NAV_LAND, Command.DO_LAND_START)
    steep = tuple(
        replace(item, z=400.0) if before.command == Command.NAV_LOITER_TO_ALT and item.z < 100.0 else item
        for before, item in zip((good[0], *good), good, strict=False)
    )
    late_takeoff = numbered([replace(good[1], seq=0), replace(good[0], seq=1), *good[2:]])
    early_return = numbered([*good, unplaced(Command.NAV_RETURN_TO_LAUNCH)])
    cases = {
        "a landing is required": no_landing,
        "steeper": steep,
        "the take-off is not its first place": late_takeoff,
        "a return stands behind": early_return,
    }
    async with simulated(tmp_path, plan.home, 2.0) as client:
        for words, items in cases.items():
            # Our own check foretells it; what counts here is what the vehicle says.
            assert AEROPLANE.check(items)
            for _ in range(2):
                result = await client.upload_verified(items, MissionType.MISSION, compare)
                assert result.outcome.kind == "accepted"
                assert result.status == "rejected", (words, [text.text for text in client.state.texts])
                assert any(words in objection for objection in result.objections), result.objections
        result = await client.upload_verified(good, MissionType.MISSION, compare)
        assert (result.status, result.objections) == ("stored", ())


def test_names_and_arguments_of_events_are_those_of_its_metadata() -> None:
    """What PX4 ships about its events knows each of ours, by number and by the types of its arguments."""
    metadata = json.loads(lzma.decompress((Path(ROMFS) / "extras/all_events.json.xz").read_bytes()))
    listed = {
        int(component) << 24 | int(number): event
        for component, groups in metadata["components"].items()
        for group in groups.get("event_groups", {}).values()
        for number, event in group["events"].items()
    }
    letters = {"int16_t": "h", "uint8_t": "B", "uint16_t": "H", "uint32_t": "I", "float": "f"}
    for name, known in KNOWN_EVENTS.items():
        event = listed[event_id(name)]
        assert event["name"] == name
        assert "".join(letters[one["type"]] for one in event.get("arguments", [])) == known.layout
