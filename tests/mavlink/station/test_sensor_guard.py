"""The guard orders a sensor off whenever it is left on outside a pass, and at no other time."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import pytest

from mavlink.encoding.payload import RelayPayload
from mavlink.state.telemetry import VehicleState
from mavlink.station.sensor_guard import AGAIN_S, ITEM_S, MOST_TRIES, SEEMS_S, SensorGuard

#: Item 7 of the mission lies in its only pass, item 9 behind it.
IN_PASS = VehicleState(
    connected=True,
    armed=True,
    autopilot="ardupilot",
    type="fixed_wing",
    mode="AUTO",
    mission_current=7,
    mission_total=12,
    mission_state="active",
    output_on=True,
)
BEHIND = replace(IN_PASS, mission_current=9)


def guard_at_work(*states: VehicleState) -> SensorGuard:
    """A guard that knows the mission and has seen these states, a tenth of a second apart."""
    guard = SensorGuard()
    guard.hold(RelayPayload(), (range(5, 9),), 12)
    for number, state in enumerate(states):
        assert guard.look(state, number * 0.1) is None
    return guard


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"mode": "RTL"}, "mode RTL"),
        ({"mode": "AUTO.RTL"}, "mode AUTO.RTL"),
        ({"mode": "LOITER"}, "mode LOITER"),
        ({"mode": "CIRCLE"}, "mode CIRCLE"),
        ({"mode": "MODE 77"}, "mode MODE 77"),
        ({"mode": "MANUAL"}, "mode MANUAL"),
        ({"mission_state": "paused"}, "paused"),
        ({"armed": False}, "disarmed"),
        ({"mission_total": 4}, "another mission"),
    ],
)
@pytest.mark.parametrize("shown", [True, None])
def test_a_pass_broken_off_has_the_sensor_off_at_once(
    change: dict[str, object], says: str, shown: bool | None
) -> None:
    """Return, failsafe, pause, disarming, another mission: at once, also where nothing shows the sensor."""
    guard = guard_at_work(replace(IN_PASS, output_on=shown))
    state = replace(IN_PASS, output_on=shown, **change)  # type: ignore[arg-type]
    assert says in (guard.look(state, 1.0) or "")


def test_a_mission_replaced_or_cleared_in_a_pass_has_it_off() -> None:
    """From the moment the change begins, by us or by what the vehicle's ids tell."""
    guard = guard_at_work(IN_PASS)
    guard.release()
    assert "replaced or cleared" in (guard.look(IN_PASS, 1.0) or "")
    guard = guard_at_work(IN_PASS)
    assert "another mission" in (guard.look(IN_PASS, 1.0, replaced=True) or "")


def test_in_a_pass_and_at_its_end_the_mission_is_left_alone() -> None:
    """The mission's own switching is seen a little late: no order as long as it comes."""
    guard = guard_at_work(IN_PASS, IN_PASS, BEHIND)
    assert guard.look(BEHIND, ITEM_S - 0.1) is None
    assert guard.look(replace(BEHIND, output_on=False), ITEM_S) is None
    assert guard.look(IN_PASS, ITEM_S + 5.0) is None
    assert guard.look(BEHIND, ITEM_S + 6.0) is None
    # Nothing shows it: the mission's own order at the pass's end is believed.
    unseen = guard_at_work(replace(IN_PASS, output_on=None), replace(BEHIND, output_on=None))
    assert unseen.look(replace(BEHIND, output_on=None, mode="RTL"), 60.0) is None


def test_an_order_of_the_mission_that_was_lost_is_made_good() -> None:
    """Still on well behind the pass: the mission's order to switch off did not work."""
    guard = guard_at_work(IN_PASS, BEHIND)
    assert "item 9 is in no pass" in (guard.look(BEHIND, 0.1 + ITEM_S) or "")


def test_a_sensor_found_on_outside_a_pass_is_switched_off_after_a_moment() -> None:
    """Reports overtake each other: what only seems on is waited for, what stays on is not."""
    away = replace(IN_PASS, mode="LOITER")
    guard = guard_at_work(replace(away, output_on=False), away)
    assert guard.look(away, SEEMS_S) is None
    assert guard.look(away, 0.1 + SEEMS_S) is not None


def test_an_order_without_effect_is_given_again_some_times() -> None:
    """No more often than it can have an effect, and not for ever."""
    guard = guard_at_work(IN_PASS)
    away = replace(IN_PASS, mode="RTL")
    orders = [now_s * 0.1 for now_s in range(10, 600) if guard.look(away, now_s * 0.1) is not None]
    assert len(orders) == MOST_TRIES
    assert min(after - before for before, after in pairwise(orders)) >= AGAIN_S - 1e-6
    assert guard.given_up
    # Once it was off, all begins anew.
    assert guard.look(replace(away, output_on=False), 61.0) is None
    assert not guard.given_up


@pytest.mark.parametrize("armed", [True, False])
@pytest.mark.parametrize("before", ["in a pass", "between passes"])
def test_a_vehicle_back_after_a_loss_with_the_sensor_on(armed: bool, before: str) -> None:
    """Heard again outside a pass, in flight or landed meanwhile: off, and the reason says so."""
    first = IN_PASS if before == "in a pass" else replace(BEHIND, output_on=False)
    guard = guard_at_work(first, replace(first, connected=False, output_on=None))
    back = replace(IN_PASS, mode="RTL", armed=armed)
    assert "heard again" in (guard.look(back, 30.0) or "")


def test_a_vehicle_back_within_its_pass_goes_on() -> None:
    """The aircraft flies its mission without us: nothing is switched."""
    guard = guard_at_work(IN_PASS, replace(IN_PASS, connected=False, output_on=None))
    assert guard.look(IN_PASS, 30.0) is None


def test_what_was_not_flown_from_here_is_left_alone() -> None:
    """No mission from here; or an aircraft on the ground whose sensor somebody tries out."""
    assert SensorGuard().look(replace(IN_PASS, mode="RTL"), 0.0) is None
    on_ground = replace(IN_PASS, armed=False)
    guard = guard_at_work(on_ground)
    assert guard.look(on_ground, 60.0) is None
    # After a landing with the sensor off it is as before.
    guard = guard_at_work(IN_PASS, replace(on_ground, output_on=False))
    assert guard.look(on_ground, 60.0) is None


def test_a_first_photo_told_of_before_its_item_is_left_alone() -> None:
    """Photos tell of a camera once it takes one: how long nothing showed it before is no time it was on."""
    before = replace(IN_PASS, mission_current=4, output_on=None)
    guard = guard_at_work(IN_PASS, *[before] * 100)
    photo = replace(before, output_on=True)
    assert guard.look(photo, 11.0) is None
    assert guard.look(IN_PASS, 11.5) is None
    assert guard.look(photo, 12.0) is None
    assert guard.look(photo, 12.1 + ITEM_S) is not None


@pytest.mark.parametrize("mode_first", [True, False], ids=["mode first", "item first"])
def test_what_a_return_to_the_missions_landing_leaves_out_is_known(mode_first: bool) -> None:
    """PX4's Return takes up the landing, item 40: the pass broken off and those behind it."""
    guard = SensorGuard()
    passes = (range(5, 9), range(15, 19), range(25, 29))
    guard.hold(RelayPayload(), passes, 42)
    flown = replace(IN_PASS, mission_total=42, output_on=False)
    told = [replace(flown, mission_current=12), replace(flown, mission_current=16)]
    returned = replace(flown, mode="AUTO.RTL", mission_current=40)
    late = replace(flown, mode="AUTO.RTL", mission_current=16)
    told += [late if mode_first else replace(flown, mission_current=40), returned]
    for number, state in enumerate(told):
        guard.look(state, 10.0 * min(number, 1) + 0.5 * number)
    assert guard.left_out(returned.mission_current) == passes[1:]
    guard.look(replace(returned, mode="AUTO.MISSION"), 20.0)
    assert guard.left_out(40) == ()


@pytest.mark.parametrize("item", [16, 19])
def test_a_return_that_keeps_its_item_leaves_nothing_out(item: int) -> None:
    """ArduPilot goes on at the item it left, also where it had just come to that."""
    guard = SensorGuard()
    guard.hold(RelayPayload(), (range(5, 9), range(15, 19)), 42)
    flown = replace(IN_PASS, mission_total=42, output_on=False)
    for number, current in enumerate((15, item)):
        guard.look(replace(flown, mission_current=current), 0.5 * number)
    back = replace(flown, mode="RTL", mission_current=item)
    guard.look(back, 1.0)
    assert guard.left_out(item) == ()
