"""The simulated aircraft takes and keeps what the dialects say of the real one, command by command."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType, dialect_for
from mavlink.sim.acceptance import refusal
from mavlink.sim.modes import Flavour
from mavlink.sim.storage import as_stored
from mavlink.wire.items import Command, Frame, MissionItem, MissionResult
from tests.mavlink.sim.helpers import HOME

KINDS: list[tuple[Autopilot, VehicleType]] = [
    ("ardupilot", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("px4", "fixed_wing"),
    ("px4", "multirotor"),
]
IN_LISTS_OF_THEIR_OWN = {each for each in Command if 5000 <= each <= 5100}
numbers = st.one_of(
    st.integers(-400, 400).map(float), st.floats(-3000.0, 3000.0, width=32), st.sampled_from([0.5, -1.0, 0.0])
)


@given(
    kind=st.sampled_from(KINDS),
    command=st.sampled_from(sorted(set(Command) - IN_LISTS_OF_THEIR_OWN)),
    frame=st.sampled_from(sorted(Frame)),
    parameters=st.tuples(numbers, numbers, numbers, numbers),
    place=st.tuples(st.integers(-899_999_999, 899_999_999), st.integers(-1_799_999_999, 1_799_999_999)),
    altitude_m=st.integers(-50_000, 800_000).map(lambda centimetres: centimetres / 100.0),
)
def test_two_tables_written_apart_agree(
    kind: tuple[Autopilot, VehicleType],
    command: Command,
    frame: Frame,
    parameters: tuple[float, float, float, float],
    place: tuple[int, int],
    altitude_m: float,
) -> None:
    """Answer and read-back of any item that a dialect knows are the same on both sides."""
    dialect = dialect_for(*kind)
    if not dialect.knows(command) or command == Command.DO_JUMP:
        # Of a jump the length of the list decides.
        return
    flavour, hovers = Flavour(kind[0]), kind[1] == "multirotor"
    sent = MissionItem(1, frame, command, *parameters, *place, altitude_m)
    answer = refusal(flavour, sent, 10, hovers=hovers) or MissionResult.ACCEPTED
    assert answer == dialect.answer(sent)
    if answer == MissionResult.ACCEPTED:
        (expected,) = dialect.expected_readback((sent,))
        assert as_stored(flavour, sent, HOME, hovers=hovers) == expected
