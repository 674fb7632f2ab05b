"""What of other stations' frames goes on to the vehicle, without sockets."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.errors import BusyError
from mavlink.state.telemetry import TWO_AIRCRAFT, Doubt, VehicleState
from mavlink.station.forward.guard import EXCHANGE_OVER_S, Guard, Verdict, flies_mission
from mavlink.wire.messages import Message

VEHICLE = VehicleState(system_id=1, component_id=1, connected=True, autopilot="ardupilot", type="fixed_wing")
PX4 = VehicleState(system_id=1, component_id=1, connected=True, autopilot="px4", type="fixed_wing")
STATION = (245, 190)
LISTS = ["MISSION_COUNT", "MISSION_CLEAR_ALL", "MISSION_SET_CURRENT", "MISSION_REQUEST_LIST", "FENCE_POINT"]
ANY_NAME = st.sampled_from(
    [*LISTS, "MISSION_ITEM_INT", "MISSION_ACK", "HEARTBEAT", "PARAM_SET", "COMMAND_LONG", "MANUAL_CONTROL"]
)


def said(name: str, sender: tuple[int, int] = STATION, target: int = 1, **fields: float) -> Message:
    """A station's message to the vehicle."""
    names = ("command", *(f"param{number}" for number in range(1, 8)))
    parameters: dict[str, float] = dict.fromkeys(names, 0.0) if name.startswith("COMMAND") else {}
    return Message(name, parameters | {"target_system": target, **fields}, *sender)


def answer(name: str, **fields: float) -> Message:
    """The vehicle's message to the station."""
    to = {"target_system": STATION[0], "target_component": STATION[1], **fields}
    return Message(name, to, 1, 1)


@given(ANY_NAME, st.integers(1, 255), st.integers(0, 255), st.booleans(), st.floats(0, 1e6))
def test_a_watcher_is_heard_by_nobody(name: str, system: int, target: int, known: bool, now_s: float) -> None:
    """Read-only, whatever is sent by whomever is refused, and nothing here waits for it."""
    guard = Guard()
    message = said(name, (system, 1), target)
    state = VEHICLE if known else VehicleState()
    assert guard.judge(message, state, False, now_s) is Verdict.REFUSED
    assert guard.exchanging(now_s) is None


@given(ANY_NAME, st.integers(2, 255), st.booleans())
def test_lists_are_held_back_while_they_are_reserved(name: str, system: int, changes: bool) -> None:
    """No frame of the mission protocol passes meanwhile, all others do, and afterwards these too."""
    guard = Guard()
    guard.reserve(0.0, changes=changes)
    verdict = guard.judge(said(name, (system, 190)), VEHICLE, True, 0.0)
    of_lists = name.startswith("MISSION_") or name == "FENCE_POINT"
    assert verdict is (Verdict.HELD_BACK if of_lists else Verdict.PASSED)
    guard.release(changes=changes)
    assert guard.judge(said(name, (system, 190)), VEHICLE, True, 0.0) is Verdict.PASSED


@pytest.mark.parametrize(
    ("sender", "target", "passes"),
    [(STATION, 1, True), (STATION, 0, True), (STATION, 2, False), ((1, 1), 1, False), ((1, 191), 1, True)],
    ids=["to it", "to all", "to another", "in its own name", "a companion of its system"],
)
def test_only_what_is_meant_for_the_vehicle(sender: tuple[int, int], target: int, passes: bool) -> None:
    """Other aircraft on the same radio are not reached, and nobody speaks in the vehicle's name."""
    verdict = Guard().judge(said("COMMAND_LONG", sender, target), VEHICLE, True, 0.0)
    assert verdict is (Verdict.PASSED if passes else Verdict.REFUSED)


@pytest.mark.parametrize("beginning", ["MISSION_COUNT", "MISSION_REQUEST_LIST", "MISSION_WRITE_PARTIAL_LIST"])
def test_a_station_at_the_lists_has_them_to_itself(beginning: str) -> None:
    """Nothing is begun here until the vehicle's last word, or long silence; what was begun goes on."""
    guard = Guard()
    guard.judge(said(beginning), VEHICLE, True, 0.0)
    with pytest.raises(BusyError, match="system 245"):
        guard.reserve(1.0, changes=True)
    guard.heard(answer("MISSION_REQUEST", seq=0), 5.0)
    guard.judge(said("MISSION_ITEM_INT", seq=0), VEHICLE, True, 6.0)
    guard.heard(answer("MISSION_ACK", type=13), 7.0)
    assert guard.exchanging(7.0 + EXCHANGE_OVER_S - 0.1) == 245
    assert guard.exchanging(7.0 + EXCHANGE_OVER_S) is None
    guard.judge(said(beginning), VEHICLE, True, 20.0)
    guard.heard(answer("MISSION_ACK", type=0) if beginning != "MISSION_REQUEST_LIST" else said("X"), 21.0)
    if beginning == "MISSION_REQUEST_LIST":
        guard.judge(said("MISSION_ACK", type=0), VEHICLE, True, 21.0)
    guard.reserve(21.0, changes=True)
    guard.reserve(21.0, changes=False)


def test_an_empty_list_is_soon_read() -> None:
    """Told that there is nothing, a station may say no more (as MAVProxy): it is done."""
    guard = Guard()
    guard.judge(said("MISSION_REQUEST_LIST"), VEHICLE, True, 0.0)
    guard.heard(answer("MISSION_COUNT", count=1), 0.1)
    assert guard.exchanging(0.1) == 245
    guard.heard(answer("MISSION_COUNT", count=0), 0.2)
    assert guard.exchanging(0.2) is None


def test_another_stations_last_word_ends_nothing() -> None:
    """An acknowledgement to somebody else leaves the exchange as it is."""
    guard = Guard()
    guard.judge(said("MISSION_COUNT"), VEHICLE, True, 0.0)
    guard.heard(Message("MISSION_ACK", {"target_system": 255, "target_component": 190, "type": 0}, 1, 1), 1.0)
    assert guard.exchanging(1.0) == 245


@pytest.mark.parametrize(
    ("state", "message", "flies"),
    [
        (VEHICLE, said("COMMAND_LONG", command=400, param1=1.0), True),
        (VEHICLE, said("COMMAND_LONG", command=400, param1=0.0), False),
        (VEHICLE, said("COMMAND_INT", command=300), True),
        (VEHICLE, said("COMMAND_LONG", command=224, param1=3.0), True),
        (VEHICLE, said("COMMAND_LONG", command=193, param1=1.0), True),
        (VEHICLE, said("COMMAND_LONG", command=193, param1=0.0), False),
        (VEHICLE, said("COMMAND_LONG", command=20), False),
        (VEHICLE, said("COMMAND_LONG", command=176, param1=1.0, param2=10.0), True),
        (VEHICLE, said("COMMAND_LONG", command=176, param1=1.0, param2=11.0), False),
        (VEHICLE, said("COMMAND_LONG", command=176, param1=1.0, param2=math.nan), False),
        (VEHICLE, said("SET_MODE", custom_mode=10), True),
        (VEHICLE, said("SET_MODE", custom_mode=12), False),
        (PX4, said("COMMAND_LONG", command=176, param1=1.0, param2=4.0, param3=4.0), True),
        (PX4, said("COMMAND_LONG", command=176, param1=1.0, param2=4.0, param3=5.0), False),
        (PX4, said("COMMAND_LONG", command=176, param1=1.0, param2=4.0, param3=math.inf), False),
        (PX4, said("SET_MODE", custom_mode=4 << 16 | 4 << 24), True),
        (PX4, said("PARAM_SET"), False),
    ],
)
def test_orders_to_fly_wait_while_the_mission_is_changed(
    state: VehicleState, message: Message, flies: bool
) -> None:
    """Arming, starting, resuming and jumping are held back; pausing, returning and disarming never are."""
    assert flies_mission(message, state) is flies
    guard = Guard()
    guard.reserve(0.0, changes=False)
    assert guard.judge(message, state, True, 0.0) is Verdict.PASSED
    guard.reserve(0.0, changes=True)
    assert guard.judge(message, state, True, 0.0) is (Verdict.HELD_BACK if flies else Verdict.PASSED)


DOUBLED = replace(VEHICLE, doubt=Doubt(TWO_AIRCRAFT, "two speak", "switch one off"))
FOR_ONE = [
    said("COMMAND_LONG", command=400, param1=1.0),
    said("COMMAND_LONG", command=22),
    said("COMMAND_INT", command=192),
    said("COMMAND_LONG", command=300),
    said("MISSION_COUNT", count=3),
    said("MISSION_CLEAR_ALL"),
    said("PARAM_SET"),
    said("SET_POSITION_TARGET_GLOBAL_INT"),
]
FOR_ALL = [
    said("COMMAND_LONG", command=20),
    said("COMMAND_LONG", command=400, param1=0.0),
    said("COMMAND_LONG", command=21),
    said("HEARTBEAT"),
    said("MANUAL_CONTROL"),
    said("PARAM_REQUEST_LIST"),
]


@pytest.mark.parametrize("doubled", [True, False], ids=["two on its link", "two forwarded"])
def test_what_two_aircraft_would_do_is_refused(doubled: bool) -> None:
    """Arming, leading, uploads and settings do not pass where two may hear them; stops and sticks do."""
    guard = Guard()
    guard.shared = not doubled
    state = DOUBLED if doubled else VEHICLE
    assert {guard.judge(message, state, True, 0.0) for message in FOR_ONE} == {Verdict.REFUSED}
    assert {guard.judge(message, state, True, 0.0) for message in FOR_ALL} == {Verdict.PASSED}
    assert guard.exchanging(0.0) is None
    guard.shared = False
    assert {guard.judge(message, VEHICLE, True, 0.0) for message in FOR_ONE} == {Verdict.PASSED}
