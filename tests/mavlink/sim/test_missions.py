"""The vehicle's side of the mission protocol, each flavour."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.modes import Flavour, Mode
from mavlink.sim.settings import SimSettings
from mavlink.sim.storage import as_stored
from mavlink.wire.items import Command, Frame, MissionItem, MissionType
from mavlink.wire.messages import Message
from tests.mavlink.sim.helpers import (
    HOME,
    Station,
    east_north_m,
    from_ground,
    item,
    item_message,
    landing_mission,
    numbered,
    place_at,
    waypoint,
)

OTHER = (254, 190)
FLAVOURS = list(Flavour)


def station(flavour: Flavour, *faults: str, **options: float) -> Station:
    return Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=flavour, faults=faults, **options)))


def sample(flavour: Flavour, points: int = 5) -> list[MissionItem]:
    body = [waypoint(100.0 * n, 1000.0) for n in range(points)]
    return landing_mission(body, home_row=flavour is Flavour.ARDUPILOT)


def acks(messages: Sequence[Message]) -> list[int]:
    return [message.integer("type") for message in messages if message.name == "MISSION_ACK"]


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_upload_and_download_give_the_items_back(flavour: Flavour) -> None:
    """What is uploaded reads back, rounded the flavour's way."""
    s = station(flavour)
    sent = sample(flavour)
    assert s.upload(sent) == 0
    assert s.download() == [as_stored(flavour, each, HOME) for each in numbered(sent)]


@pytest.mark.parametrize(
    ("flavour", "name"), [(Flavour.ARDUPILOT, "MISSION_REQUEST"), (Flavour.PX4, "MISSION_REQUEST_INT")]
)
def test_each_flavour_asks_in_its_own_words(flavour: Flavour, name: str) -> None:
    """ArduPilot asks with MISSION_REQUEST, PX4 with MISSION_REQUEST_INT."""
    answers = station(flavour).say(from_ground("MISSION_COUNT", count=3, mission_type=0))
    assert [message.name for message in answers] == [name]


@settings(max_examples=30, deadline=None)
@given(
    st.sampled_from(FLAVOURS),
    st.lists(
        st.tuples(st.floats(-5000.0, 5000.0), st.floats(-5000.0, 5000.0), st.floats(0.0, 900.0)),
        min_size=1,
        max_size=20,
    ),
    st.sampled_from([(), ("lost_items",), ("lost_requests",), ("lost_items", "lost_requests")]),
)
def test_any_list_survives_loss(
    flavour: Flavour, points: list[tuple[float, float, float]], faults: tuple[str, ...]
) -> None:
    """Any waypoints arrive whole even when every third message is lost."""
    s = station(flavour, *faults)
    sent = landing_mission([waypoint(*point) for point in points], home_row=flavour is Flavour.ARDUPILOT)
    assert s.upload(sent, patience_s=60.0) == 0
    assert s.download() == [as_stored(flavour, each, HOME) for each in numbered(sent)]


@pytest.mark.parametrize(
    ("flavour", "period_s", "gives_up_s"), [(Flavour.ARDUPILOT, 1.0, 8.0), (Flavour.PX4, 0.25, 5.0)]
)
def test_it_asks_again_and_gives_up(flavour: Flavour, period_s: float, gives_up_s: float) -> None:
    """Without items it repeats its request at the flavour's pace, then stops; only ArduPilot says so."""
    s = station(flavour)
    s.say(from_ground("MISSION_COUNT", count=3, mission_type=0))
    asked: list[float] = []
    while s.now_s < 20.0:
        if any(m.name.startswith("MISSION_REQUEST") for m in s.wait(0.01)):
            asked.append(s.now_s)
    assert asked[0] == pytest.approx(period_s, abs=0.1)
    assert max(asked) < gives_up_s + 0.1
    assert len(asked) == pytest.approx(gives_up_s / period_s, abs=2)
    assert acks(s.heard) == ([15] if flavour is Flavour.ARDUPILOT else [])


def test_a_failed_upload_leaves_ardupilot_mixed_and_px4_whole() -> None:
    """After a time-out ArduPilot has new items in front and old ones behind, cut to the new count."""
    for flavour in FLAVOURS:
        s = station(flavour)
        old = sample(flavour, 6)
        assert s.upload(old) == 0
        before = s.download()
        new = numbered([replace(each, z=each.z + 7.0) for each in old[:8]])
        s.say(from_ground("MISSION_COUNT", count=len(new), mission_type=0))
        for each in new[:4]:
            s.say(item_message(each))
        s.wait(10.0)
        after = s.download()
        if flavour is Flavour.PX4:
            assert after == before
        else:
            assert len(after) == 8
            assert after[:4] == [as_stored(flavour, each, HOME) for each in new[:4]]
            assert after[4:] == before[4:8]


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_refused_item_ends_the_upload(flavour: Flavour) -> None:
    """An unsupported item draws MISSION_ACK UNSUPPORTED and a STATUSTEXT naming it."""
    s = station(flavour)
    sent = sample(flavour)
    sent.insert(4, item(2501 if flavour is Flavour.PX4 else 2003, HOME))
    assert s.upload(sent) == 3
    assert any("item 4" in text for text in s.texts())


def test_duplicates_are_not_the_end_on_ardupilot() -> None:
    """A repeated item draws INVALID_SEQUENCE while the upload goes on to its end."""
    s = station(Flavour.ARDUPILOT)
    rows = numbered(sample(Flavour.ARDUPILOT))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    for each in rows[:-1]:
        s.say(item_message(each))
        assert acks(s.say(item_message(each))) == [13]
    assert acks(s.say(item_message(rows[-1]))) == [0]


def test_px4_repeats_its_request_for_an_item_out_of_order() -> None:
    """PX4 answers a wrong item by asking for the right one, and a repeated last item by accepting again."""
    s = station(Flavour.PX4)
    rows = numbered(sample(Flavour.PX4))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    (answer,) = s.say(item_message(rows[2]))
    assert (answer.name, answer.integer("seq")) == ("MISSION_REQUEST_INT", 0)
    for each in rows:
        s.say(item_message(each))
    assert acks(s.say(item_message(rows[-1]))) == [0]


def test_px4_accepts_the_last_item_after_an_abort_without_storing() -> None:
    """The trap: after a time-out the last item alone draws ACCEPTED, and nothing is stored."""
    s = station(Flavour.PX4)
    rows = numbered(sample(Flavour.PX4))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    s.say(item_message(rows[0]))
    s.wait(6.0)
    assert acks(s.say(item_message(rows[-1]))) == [0]
    assert s.download() == []


def test_a_second_station_is_denied_during_an_upload() -> None:
    """While one ground station uploads, another's upload and download are denied and a clear fails."""
    s = station(Flavour.ARDUPILOT)
    s.say(from_ground("MISSION_COUNT", count=3, mission_type=0))
    assert acks(s.say(from_ground("MISSION_COUNT", OTHER, count=3, mission_type=0))) == [14]
    assert acks(s.say(from_ground("MISSION_REQUEST_LIST", OTHER, mission_type=0))) == [14]
    assert acks(s.say(from_ground("MISSION_CLEAR_ALL", OTHER, mission_type=0))) == [1]


def test_px4_wants_the_end_of_a_download_said() -> None:
    """An upload during an unfinished download draws ERROR on PX4 until 5 s have passed."""
    s = station(Flavour.PX4)
    assert s.upload(sample(Flavour.PX4)) == 0
    s.say(from_ground("MISSION_REQUEST_LIST", mission_type=0))
    assert s.upload(sample(Flavour.PX4)) == 1
    s.wait(6.0)
    assert s.upload(sample(Flavour.PX4)) == 0


@pytest.mark.parametrize(("flavour", "most"), [(Flavour.ARDUPILOT, 655), (Flavour.PX4, 1000)])
def test_too_many_items_find_no_space(flavour: Flavour, most: int) -> None:
    """One item more than the capacity is refused and the old mission kept."""
    s = station(flavour)
    assert s.upload(sample(flavour)) == 0
    before = s.download()
    assert acks(s.say(from_ground("MISSION_COUNT", count=most + 1, mission_type=0))) == [4]
    assert s.download() == before


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_clearing_empties_the_stores(flavour: Flavour) -> None:
    """A clear of all types empties mission and rally points alike."""
    s = station(flavour)
    rally = [replace(waypoint(0.0, 100.0), command=Command.NAV_RALLY_POINT)]
    assert s.upload(sample(flavour)) == 0
    assert s.upload(rally, MissionType.RALLY) == 0
    assert len(s.download(MissionType.RALLY)) == 1
    assert acks(s.say(from_ground("MISSION_CLEAR_ALL", mission_type=255))) == [0]
    assert s.download() == []
    assert s.download(MissionType.RALLY) == []


def fence_polygon(count: int, says: int | None = None) -> list[MissionItem]:
    corners = [(-500.0, -500.0), (500.0, -500.0), (500.0, 500.0), (-500.0, 500.0), (-700.0, 0.0)][:count]
    command = Command.NAV_FENCE_POLYGON_VERTEX_INCLUSION
    return [
        replace(item(command, place_at(*c), (float(says or count),)), frame=Frame.GLOBAL) for c in corners
    ]


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_fences_are_stored_whole_or_not_at_all(flavour: Flavour) -> None:
    """A polygon of two points is an ERROR and leaves the old fence; a good one reads back."""
    s = station(flavour)
    assert s.upload(fence_polygon(4), MissionType.FENCE) == 0
    before = s.download(MissionType.FENCE)
    assert len(before) == 4
    assert {each.frame for each in before} == {0 if flavour is Flavour.ARDUPILOT else 5}
    assert s.upload(fence_polygon(2), MissionType.FENCE) == 1
    assert s.download(MissionType.FENCE) == before


def test_circles_over_a_polygon_empty_ardupilots_fence() -> None:
    """The trap: circles uploaded over a stored polygon are accepted and the fence is then empty."""
    s = station(Flavour.ARDUPILOT)
    circle = [item(Command.NAV_FENCE_CIRCLE_EXCLUSION, place_at(0.0, 0.0), (50.0,))]
    assert s.upload(fence_polygon(4), MissionType.FENCE) == 0
    assert s.upload(circle, MissionType.FENCE) == 0
    assert s.download(MissionType.FENCE) == []
    assert s.upload(circle, MissionType.FENCE) == 0
    assert len(s.download(MissionType.FENCE)) == 1


def test_an_unknown_mission_type_is_unsupported() -> None:
    """A mission type that nobody defines is answered, not dropped."""
    assert acks(station(Flavour.PX4).say(from_ground("MISSION_COUNT", count=1, mission_type=9))) == [3]


def test_messages_to_others_are_left_alone() -> None:
    """A count meant for another system draws no answer."""
    s = station(Flavour.PX4)
    message = Message("MISSION_COUNT", {"target_system": 2, "target_component": 1, "count": 1}, 255, 190)
    assert s.say(message) == []


def test_items_in_floating_point_are_understood() -> None:
    """MISSION_ITEM, its degrees in floating point, is stored like MISSION_ITEM_INT, and given back so too."""
    s = station(Flavour.ARDUPILOT)
    rows = numbered(sample(Flavour.ARDUPILOT, 1))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    for each in rows:
        exact = item_message(each)
        fields = {**exact.fields, "x": each.x / 1e7, "y": each.y / 1e7}
        s.say(Message("MISSION_ITEM", fields, *(255, 190)))
    assert s.download() == [as_stored(Flavour.ARDUPILOT, each, HOME) for each in rows]
    (answer,) = s.say(from_ground("MISSION_REQUEST", seq=2, mission_type=0))
    assert answer.name == "MISSION_ITEM"
    assert answer.number("x") == pytest.approx(rows[2].x / 1e7)


def partial(s: Station, first: int, last: int, kind: int = 0) -> list[Message]:
    return s.say(
        from_ground("MISSION_WRITE_PARTIAL_LIST", start_index=first, end_index=last, mission_type=kind)
    )


def test_ardupilot_takes_items_in_their_places() -> None:
    """It asks for the range alone, stores each as it comes, and leaves the others as they were."""
    s = station(Flavour.ARDUPILOT)
    rows = numbered(sample(Flavour.ARDUPILOT))
    assert s.upload(rows) == 0
    before = s.download()
    moved = [replace(each, z=33.0) for each in rows]
    (request,) = partial(s, 3, 4)
    assert (request.name, request.integer("seq")) == ("MISSION_REQUEST", 3)
    (request,) = s.say(item_message(moved[3]))
    assert request.integer("seq") == 4
    assert s.aircraft.missions.items()[3].z == 33.0
    assert acks(s.say(item_message(moved[4]))) == [0]
    held = s.download()
    assert [each.z for each in held[3:5]] == [33.0, 33.0]
    assert [*held[:3], *held[5:]] == [*before[:3], *before[5:]]


def test_ardupilot_refuses_ranges_it_does_not_hold() -> None:
    """ERROR and a text for a range past the end or the wrong way round; one past the end itself appends."""
    s = station(Flavour.ARDUPILOT)
    rows = numbered(sample(Flavour.ARDUPILOT))
    assert s.upload(rows) == 0
    count = len(rows)
    for first, last in ((count + 1, count + 1), (4, 3), (-1, 2), (2, count + 1)):
        assert acks(partial(s, first, last)) == [1]
    assert s.texts().count("Flight plan update rejected") == 4
    partial(s, count, count)
    assert acks(s.say(item_message(replace(rows[-1], seq=count)))) == [0]
    assert len(s.download()) == count + 1


def test_ardupilot_denies_a_partial_update_while_it_receives() -> None:
    """Another's, and a repetition of our own; it goes on asking, and gives up by the clock."""
    s = station(Flavour.ARDUPILOT)
    assert s.upload(sample(Flavour.ARDUPILOT)) == 0
    partial(s, 2, 3)
    assert acks(partial(s, 2, 3)) == [14]
    asked = [m.integer("seq") for m in s.wait(1.0) if m.name == "MISSION_REQUEST"]
    assert asked == [2]
    s.wait(8.0)
    assert acks(s.heard)[-1] == 15


def test_a_partial_update_in_flight_leaves_the_aircraft_on_its_way() -> None:
    """The item flown stays the one flown, AUTO stays on, and the waypoint ahead is flown where it now is."""
    s = Station(SimulatedAircraft(SimSettings(home=HOME, autopilot=Flavour.ARDUPILOT)))
    body = [waypoint(0.0, 1000.0), waypoint(0.0, 2000.0), waypoint(0.0, 2500.0)]
    rows = numbered(landing_mission(body, home_row=True))
    assert s.upload(rows) == 0
    s.start()
    while 2 not in s.reached():
        s.fly(1.0)
    flown = s.aircraft.pilot.current
    moved = numbered(landing_mission([*body[:2], waypoint(600.0, 2300.0)], home_row=True))[4]
    partial(s, 4, 4)
    assert acks(s.say(item_message(moved))) == [0]
    s.wait(0.1)
    assert (s.aircraft.pilot.current, s.aircraft.mode) == (flown, Mode.AUTO)
    while 4 not in s.reached():
        s.fly(1.0)
    east_m, north_m = east_north_m(s.aircraft.state.lat_deg, s.aircraft.state.lon_deg)
    assert (east_m, north_m) == pytest.approx((600.0, 2300.0), abs=150.0)


def test_px4_is_deaf_to_partial_updates() -> None:
    """No answer at all, and the mission stays."""
    s = station(Flavour.PX4)
    assert s.upload(sample(Flavour.PX4)) == 0
    before = s.download()
    assert partial(s, 1, 2) == []
    assert s.download() == before


@pytest.mark.parametrize("kind", MissionType)
def test_px4_numbers_its_lists(kind: MissionType) -> None:
    """The same id in acknowledgement, count and MISSION_CURRENT; another for other items, 0 for none."""
    s = station(Flavour.PX4)
    rally = item(Command.NAV_RALLY_POINT, place_at(0.0, 100.0))
    circle = item(Command.NAV_FENCE_CIRCLE_INCLUSION, place_at(0.0, 0.0), (500.0,))
    items = {0: sample(Flavour.PX4), 1: [circle], 2: [rally]}[kind]
    field = ("mission_id", "fence_id", "rally_points_id")[kind]

    def told() -> set[int]:
        (count,) = s.say(from_ground("MISSION_REQUEST_LIST", mission_type=int(kind)))
        s.say(from_ground("MISSION_ACK", type=0, mission_type=int(kind)))
        current = s.aircraft.message("MISSION_CURRENT")
        assert current is not None
        return {count.integer("opaque_id"), current.integer(field)}

    assert told() == {0}
    assert s.upload(items, kind) == 0
    first = [m for m in s.heard if m.name == "MISSION_ACK"][-1].integer("opaque_id")
    assert first != 0
    assert told() == {first}
    assert s.upload([*items[:-1], replace(items[-1], z=44.0)], kind) == 0
    assert told().isdisjoint({0, first})
    assert s.upload(items, kind) == 0
    assert told() == {first}
    s.say(from_ground("MISSION_CLEAR_ALL", mission_type=int(kind)))
    assert told() == {0}


def test_px4s_trap_shows_in_the_id() -> None:
    """ACCEPTED to the last item after an abort carries the id of a list that is not stored."""
    s = station(Flavour.PX4)
    rows = numbered(sample(Flavour.PX4))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    s.say(item_message(rows[0]))
    s.wait(6.0)
    (answer,) = s.say(item_message(rows[-1]))
    assert answer.integer("type") == 0
    (count,) = s.say(from_ground("MISSION_REQUEST_LIST", mission_type=0))
    assert answer.integer("opaque_id") != count.integer("opaque_id") == 0


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_a_station_that_cancels_ends_its_upload(flavour: Flavour) -> None:
    """OPERATION_CANCELLED stops the requests, and another station may begin at once."""
    s = station(flavour)
    s.say(from_ground("MISSION_COUNT", count=5, mission_type=0))
    s.say(from_ground("MISSION_ACK", type=15, mission_type=0))
    assert [m for m in s.wait(3.0) if m.name.startswith("MISSION_REQUEST")] == []
    (request,) = s.say(from_ground("MISSION_COUNT", OTHER, count=2, mission_type=0))
    assert request.name.startswith("MISSION_REQUEST")
