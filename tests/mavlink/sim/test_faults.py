"""Each fault shows what its docstring says, and nothing shows without one."""

from __future__ import annotations

import pytest

from mavlink.sim.autopilot import SimulatedAircraft
from mavlink.sim.faults import Fault, parse_faults
from mavlink.sim.modes import Flavour
from mavlink.sim.settings import SimSettings
from mavlink.sim.storage import as_stored
from mavlink.wire.items import Command
from tests.mavlink.sim.helpers import (
    HOME,
    Station,
    from_ground,
    item_message,
    landing_mission,
    numbered,
    waypoint,
)

FLAVOURS = list(Flavour)
pytestmark = pytest.mark.parametrize("flavour", FLAVOURS)


def station(flavour: Flavour, fault: Fault) -> Station:
    settings = SimSettings(home=HOME, autopilot=flavour, faults=(fault.value,), vanish_for_s=10.0)
    return Station(SimulatedAircraft(settings))


def sample(flavour: Flavour) -> list:
    return landing_mission([waypoint(0.0, 1000.0)] * 3, home_row=flavour is Flavour.ARDUPILOT)


def test_no_response_to_count(flavour: Flavour) -> None:
    """Nothing answers the count, and nothing is stored."""
    s = station(flavour, Fault.NO_RESPONSE_TO_COUNT)
    assert s.upload(sample(flavour)) is None
    assert not [m for m in s.heard if m.name.startswith("MISSION_REQUEST")]
    assert s.download() == []


def test_wrong_sequence_request(flavour: Flavour) -> None:
    """Item 2 is asked for instead of 1, refused, then the upload goes through."""
    s = station(flavour, Fault.WRONG_SEQUENCE_REQUEST)
    assert s.upload(sample(flavour)) == 0
    asked = [m.integer("seq") for m in s.heard if m.name.startswith("MISSION_REQUEST")]
    assert asked[:3] == [0, 2, 1]
    assert len(s.download()) == len(sample(flavour))


@pytest.mark.parametrize(("fault", "asked"), [(Fault.ERROR_ACK_AT_0, []), (Fault.ERROR_ACK_AT_1, [0])])
def test_error_ack(flavour: Flavour, fault: Fault, asked: list[int]) -> None:
    """The upload ends with ERROR before item 0, or right after it."""
    s = station(flavour, fault)
    assert s.upload(sample(flavour)) == 1
    assert [m.integer("seq") for m in s.heard if m.name.startswith("MISSION_REQUEST")] == asked


def test_no_final_ack(flavour: Flavour) -> None:
    """All is stored, the acknowledgement never comes."""
    s = station(flavour, Fault.NO_FINAL_ACK)
    sent = sample(flavour)
    assert s.upload(sent) is None
    assert s.download() == [as_stored(flavour, each, HOME) for each in numbered(sent)]


def test_early_ack(flavour: Flavour) -> None:
    """ACCEPTED comes after one item, and one item is what is stored."""
    s = station(flavour, Fault.EARLY_ACK)
    assert s.upload(sample(flavour)) == 0
    assert len(s.download()) == 1


@pytest.mark.parametrize("fault", [Fault.LOST_ITEMS, Fault.LOST_REQUESTS])
def test_lost_messages_are_asked_for_again(flavour: Flavour, fault: Fault) -> None:
    """Loss makes the upload longer, not different."""
    s = station(flavour, fault)
    sent = sample(flavour)
    assert s.upload(sent, patience_s=40.0) == 0
    assert s.now_s > 0.2
    assert s.download() == [as_stored(flavour, each, HOME) for each in numbered(sent)]


def test_vanish_mid_upload(flavour: Flavour) -> None:
    """After three items it is silent for ten seconds, then back with the upload given up."""
    s = station(flavour, Fault.VANISH_MID_UPLOAD)
    sent = sample(flavour)
    rows = numbered(sent)
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    for each in rows[:3]:
        answers = s.say(item_message(each))
    assert answers == []
    assert s.wait(9.0) == []
    assert s.say(from_ground("MISSION_REQUEST_LIST", mission_type=0)) == []
    back = s.wait(2.0)
    assert any(m.name == "HEARTBEAT" for m in back)
    assert any("timeout" in text for text in s.texts())
    assert len(s.download()) == (3 if flavour is Flavour.ARDUPILOT else 0)
    assert s.upload(sent) == 0
    assert len(s.download()) == len(sent)


def test_altered_item(flavour: Flavour) -> None:
    """The upload is accepted, and one altitude is not what was sent."""
    s = station(flavour, Fault.ALTERED_ITEM)
    sent = sample(flavour)
    assert s.upload(sent) == 0
    wanted = [as_stored(flavour, each, HOME) for each in numbered(sent)]
    different = [(a, b) for a, b in zip(s.download(), wanted, strict=True) if a != b]
    assert len(different) == 1
    assert different[0][0].z == different[0][1].z + 10.0


def test_no_response_to_list(flavour: Flavour) -> None:
    """Nothing can be read back."""
    s = station(flavour, Fault.NO_RESPONSE_TO_LIST)
    assert s.upload(sample(flavour)) == 0
    assert s.say(from_ground("MISSION_REQUEST_LIST", mission_type=0)) == []


def test_lost_download_items(flavour: Flavour) -> None:
    """Every third item has to be asked for twice; the list is whole all the same."""
    s = station(flavour, Fault.LOST_DOWNLOAD_ITEMS)
    sent = sample(flavour)
    assert s.upload(sent) == 0
    first = [s.say(from_ground("MISSION_REQUEST_INT", seq=n, mission_type=0)) for n in range(len(sent))]
    assert [n for n, answers in enumerate(first) if not answers] == list(range(2, len(sent), 3))
    assert len(s.download()) == len(sent)


def test_no_command_ack(flavour: Flavour) -> None:
    """An order is carried out and not acknowledged."""
    s = station(flavour, Fault.NO_COMMAND_ACK)
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) is None
    assert s.aircraft.armed


def test_deny_arm(flavour: Flavour) -> None:
    """Arming is denied with a reason, and nothing moves."""
    s = station(flavour, Fault.DENY_ARM)
    assert s.upload(sample(flavour)) == 0
    assert s.command(Command.COMPONENT_ARM_DISARM, 1.0) == 2
    assert any("pre-arm" in text for text in s.texts())
    assert s.command(Command.MISSION_START) == (2 if flavour is Flavour.PX4 else 0)
    s.wait(60.0)
    assert s.aircraft.state.on_ground


def test_sensor_dead(flavour: Flavour) -> None:
    """The sensor's order is acknowledged and the sensor stays off."""
    s = station(flavour, Fault.SENSOR_DEAD)
    assert s.command(Command.DO_SET_RELAY, 0.0, 1.0) == 0
    assert not s.aircraft.payload.sensor_on


@pytest.mark.parametrize(
    ("fault", "opening"),
    [
        (Fault.NO_RESPONSE_TO_FIRST_COUNT, "MISSION_COUNT"),
        (Fault.NO_RESPONSE_TO_FIRST_LIST, "MISSION_REQUEST_LIST"),
    ],
)
def test_no_response_the_first_time(flavour: Flavour, fault: Fault, opening: str) -> None:
    """The first opening of a transfer is lost, the second answered."""
    s = station(flavour, fault)
    message = from_ground(opening, count=3, mission_type=0)
    assert s.say(message) == []
    assert s.say(message) != []


@pytest.mark.parametrize(
    ("fault", "asked"),
    [
        (Fault.NO_REQUEST_0, []),
        (Fault.NO_REQUEST_1, [0]),
        (Fault.WRONG_REQUEST_AT_0, [60_000]),
        (Fault.WRONG_REQUEST_AT_1, [0, 60_001]),
    ],
)
def test_requests_missing_or_misnumbered(flavour: Flavour, fault: Fault, asked: list[int]) -> None:
    """What is asked for before the upload comes to a halt, and that it is given up by the clock."""
    s = station(flavour, fault)
    rows = numbered(sample(flavour))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    if 0 in asked:
        s.say(item_message(rows[0]))
    assert [m.integer("seq") for m in s.heard if m.name.startswith("MISSION_REQUEST")] == asked
    s.wait(9.0)
    assert any("timeout" in text for text in s.texts())


def test_error_ack_at_end(flavour: Flavour) -> None:
    """All is taken, ERROR is said; ArduPilot has written it all the same."""
    s = station(flavour, Fault.ERROR_ACK_AT_END)
    sent = sample(flavour)
    assert s.upload(sent) == 1
    assert len(s.download()) == (len(sent) if flavour is Flavour.ARDUPILOT else 0)


@pytest.mark.parametrize(
    ("fault", "said"),
    [
        (Fault.NO_ITEM_0, {0: []}),
        (Fault.NO_ITEM_1, {1: []}),
        (Fault.WRONG_ITEM_AT_0, {0: [("MISSION_ITEM_INT", 60_000)]}),
        (Fault.WRONG_ITEM_AT_1, {1: [("MISSION_ITEM_INT", 60_001)]}),
        (Fault.ERROR_ACK_FOR_ITEM_0, {0: [("MISSION_ACK", 1)]}),
        (Fault.ERROR_ACK_FOR_ITEM_1, {1: [("MISSION_ACK", 1)]}),
    ],
)
def test_items_missing_or_misnumbered(
    flavour: Flavour, fault: Fault, said: dict[int, list[tuple[str, int]]]
) -> None:
    """The one item is not given, given with another number, or refused; all others are given."""
    s = station(flavour, fault)
    assert s.upload(sample(flavour)) == 0
    for seq in range(3):
        answers = s.say(from_ground("MISSION_REQUEST_INT", seq=seq, mission_type=0))
        words = [(m.name, m.integer("seq" if "seq" in m.fields else "type")) for m in answers]
        assert words == said.get(seq, [("MISSION_ITEM_INT", seq)])


@pytest.mark.parametrize("fault", [Fault.WRONG_TYPE_ACK, Fault.FOREIGN_ACK])
def test_stray_acknowledgements(flavour: Flavour, fault: Fault) -> None:
    """A refusal of another list, or of another system, comes in the middle; the upload goes on."""
    s = station(flavour, fault)
    rows = numbered(sample(flavour))
    s.say(from_ground("MISSION_COUNT", count=len(rows), mission_type=0))
    stray, request = s.say(item_message(rows[0]))
    assert (stray.name, stray.integer("type"), request.integer("seq")) == ("MISSION_ACK", 14, 1)
    foreign = fault is Fault.FOREIGN_ACK
    assert (stray.system_id, stray.integer("mission_type")) == ((99, 0) if foreign else (0, 1))
    for each in rows[1:]:
        (last, *_) = s.say(item_message(each))
    assert (last.name, last.integer("type")) == ("MISSION_ACK", 0)


def test_competing_station(flavour: Flavour) -> None:
    """Somebody else is uploading: nothing of ours begins."""
    s = station(flavour, Fault.COMPETING_STATION)
    assert s.upload(sample(flavour)) == 14
    (answer,) = s.say(from_ground("MISSION_REQUEST_LIST", mission_type=0))
    assert answer.integer("type") == 14
    (answer,) = s.say(from_ground("MISSION_CLEAR_ALL", mission_type=0))
    assert answer.integer("type") == 1


def test_wrong_opaque_id(flavour: Flavour) -> None:
    """PX4's acknowledgement names another list than its count does; ArduPilot names none."""
    s = station(flavour, Fault.WRONG_OPAQUE_ID)
    assert s.upload(sample(flavour)) == 0
    said = [m for m in s.heard if m.name == "MISSION_ACK"][-1].integer("opaque_id")
    (count,) = s.say(from_ground("MISSION_REQUEST_LIST", mission_type=0))
    assert (said == count.integer("opaque_id") == 0) is (flavour is Flavour.ARDUPILOT)
    assert (said != count.integer("opaque_id")) is (flavour is Flavour.PX4)


def test_unknown_faults_are_refused(flavour: Flavour) -> None:
    """A misspelt fault names those there are."""
    with pytest.raises(ValueError, match="no_final_ack"):
        parse_faults(["no_finalack"])
    with pytest.raises(ValueError, match="unknown fault"):
        SimSettings(autopilot=flavour, faults=("nonsense",))
