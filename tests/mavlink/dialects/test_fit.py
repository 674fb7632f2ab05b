"""Missions from elsewhere, fitted to an autopilot: what could be said otherwise is, and told."""

from __future__ import annotations

import math
from dataclasses import replace

from hypothesis import given, settings

from mavlink.dialects.fit import fitted
from mavlink.dialects.mission import Declared, Mission, home_item, numbered, placed, unplaced
from mavlink.wire.items import Command, Frame, MissionResult
from tests.mavlink.strategies import missions, same


def foreign(mission: Mission) -> Mission:
    return replace(mission, declared=Declared())


@given(missions())
@settings(max_examples=100, deadline=None)
def test_no_open_number_is_refused(mission: Mission) -> None:
    """Whatever is open, ArduPilot takes it; what was changed has a note, the rest is as it was."""
    fit = fitted(foreign(mission))
    for before, behind in zip(mission.mission, fit.mission, strict=True):
        answer = fit.dialect.answer(behind)
        if mission.autopilot == "ardupilot":
            assert not MissionResult.INVALID_PARAM1 <= answer <= MissionResult.INVALID_PARAM4
        noted = any(note.startswith(f"item {before.seq}:") for note in fit.notes)
        assert noted or same((before,), (behind,))


def test_items_without_a_place_go_to_px4_in_the_frame_it_takes() -> None:
    """DO_CHANGE_SPEED of Mission Planner stands in frame 3; PX4 takes it in frame 2 alone."""
    items = [
        placed(Command.NAV_WAYPOINT, (8.2, 47.1), 40.0, Frame.GLOBAL_RELATIVE_ALT),
        unplaced(Command.DO_CHANGE_SPEED, (1.0, 9.0, -1.0, 0.0)),
    ]
    items[1] = replace(items[1], frame=3)
    mission = Mission(numbered(items), (), (), "px4", "", "multirotor", (8.2, 47.1), declared=Declared())
    fit = fitted(mission)
    assert [int(item.frame) for item in fit.mission] == [3, 2]
    assert [note for note in fit.notes if "frame 2" in note] == [fit.notes[-1]]
    assert fit.dialect.answer(fit.mission[1]) == MissionResult.ACCEPTED


def test_missions_of_our_own_are_left_alone() -> None:
    """What was encoded here fits already: not an item is looked at."""
    rows = numbered([home_item((8.2, 47.1), 400.0), unplaced(Command.DO_CHANGE_SPEED, (math.nan,) * 4)])
    mission = Mission(rows, (), (), "ardupilot", "", "fixed_wing", (8.2, 47.1))
    assert fitted(mission) is mission
