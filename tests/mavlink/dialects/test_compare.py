"""What counts as the same mission after a read-back."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mavlink.dialects import Autopilot, VehicleType, dialect_for
from mavlink.dialects.compare import differences
from mavlink.encoding.encode import EncodeOptions, encode
from mavlink.sim.acceptance import refusal
from mavlink.sim.geodesy import Place
from mavlink.sim.modes import Flavour
from mavlink.sim.storage import as_stored
from mavlink.wire.items import MissionItem
from tests.mavlink.plans import make_plan

KINDS: list[tuple[Autopilot, VehicleType]] = [
    ("ardupilot", "fixed_wing"),
    ("ardupilot", "multirotor"),
    ("px4", "fixed_wing"),
    ("px4", "multirotor"),
]


def as_vehicle(
    items: tuple[MissionItem, ...], autopilot: Autopilot, kind: VehicleType
) -> tuple[MissionItem, ...]:
    """What the vehicle sends: its own version of the items through 32-bit floats, its own home in front."""
    dialect = dialect_for(autopilot, kind)

    def f32(value: float) -> float:
        return float(np.float32(value))

    held = tuple(
        replace(
            item,
            param1=f32(item.param1),
            param2=f32(item.param2),
            param3=f32(item.param3),
            param4=f32(item.param4),
            z=f32(item.z),
            current=item.seq == 3,
        )
        for item in dialect.expected_readback(items)
    )
    if not dialect.home_row:
        return held
    return (replace(items[0], x=items[0].x + 2, y=items[0].y - 1, z=584.09), *held)


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_what_the_vehicle_is_known_to_alter_is_no_difference(autopilot: Autopilot, kind: VehicleType) -> None:
    """A mission read back with the autopilot's roundings, its home and its current flag is equal."""
    mission = encode(make_plan(autopilot=autopilot, vehicle_type=kind, altitude_m=123.45))
    assert differences(mission.mission, as_vehicle(mission.mission, autopilot, kind), mission.dialect) == ()
    held = mission.dialect.expected_readback(mission.fence)
    assert differences(mission.fence, held, mission.dialect) == ()


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
@given(data=st.data())
def test_every_other_change_is_a_difference(
    autopilot: Autopilot, kind: VehicleType, data: st.DataObject
) -> None:
    """A place moved by 1e-7 degrees, an altitude by 2 cm, a command or a parameter are all reported."""
    mission = encode(make_plan(autopilot=autopilot, vehicle_type=kind))
    held = list(as_vehicle(mission.mission, autopilot, kind))
    index = data.draw(st.integers(1 if mission.dialect.home_row else 0, len(held) - 1))
    field = data.draw(st.sampled_from(["x", "y", "z", "command", "frame", "param1", "param4"]))
    value = getattr(held[index], field)
    step = 0.02 if field == "z" else 1
    changed = 7.0 if isinstance(value, float) and math.isnan(value) else value + step
    held[index] = replace(held[index], **{field: changed})
    found = differences(mission.mission, tuple(held), mission.dialect)
    assert [(difference.seq, difference.field) for difference in found] == [(held[index].seq, field)]


@pytest.mark.parametrize(("autopilot", "kind"), KINDS)
def test_the_simulated_vehicle_stores_what_the_dialect_expects(
    autopilot: Autopilot, kind: VehicleType
) -> None:
    """The simulator's tables were written apart from the dialects: both agree on every list of a mission."""
    options = EncodeOptions(rally_at_home=True)
    mission = encode(make_plan(autopilot=autopilot, vehicle_type=kind, altitude_m=123.45), options=options)
    flavour = Flavour.ARDUPILOT if autopilot == "ardupilot" else Flavour.PX4
    home = Place(33.5, -117.7, 20.0)
    for items in (mission.mission, mission.fence, mission.rally):
        assert [item for item in items if refusal(flavour, item, len(items)) is not None] == []
        held = tuple(as_stored(flavour, item, home) for item in items)
        assert differences(items, held, mission.dialect) == ()


@pytest.mark.parametrize(("frame", "same"), [(0, False), (3, True), (6, True), (10, False)])
def test_integer_frames_mean_the_same(frame: int, same: bool) -> None:
    """Frame 6 for 3 is no difference, a frame with another datum is."""
    mission = encode(make_plan())
    held = list(as_vehicle(mission.mission, "ardupilot", "fixed_wing"))
    held[-1] = replace(held[-1], frame=frame)
    found = differences(mission.mission, tuple(held), mission.dialect)
    assert [difference.field for difference in found] == ([] if same else ["frame"])


def test_nan_equals_nan_and_nothing_else() -> None:
    """An open yaw read back open is equal, read back as 0 it is not."""
    mission = encode(make_plan(autopilot="px4"))
    held = mission.dialect.expected_readback(mission.mission)
    assert math.isnan(held[0].param4)
    assert differences(mission.mission, held, mission.dialect) == ()
    found = differences(mission.mission, (replace(held[0], param4=0.0), *held[1:]), mission.dialect)
    assert [difference.field for difference in found] == ["param4"]


def test_missing_and_surplus_items_are_told() -> None:
    """A list cut short, or one with an item too many, differs in count and by the item."""
    mission = encode(make_plan())
    held = as_vehicle(mission.mission, "ardupilot", "fixed_wing")
    last = held[-1]
    short = differences(mission.mission, held[:-1], mission.dialect)
    assert [(d.seq, d.field) for d in short] == [(None, "count"), (last.seq, "item")]
    surplus = differences(mission.mission, (*held, replace(last, seq=last.seq + 1)), mission.dialect)
    assert [(d.seq, d.field) for d in surplus] == [(None, "count"), (last.seq + 1, "item")]


def test_nothing_meant_and_nothing_held_is_equal() -> None:
    """A cleared ArduPilot may hold its home row alone, or nothing."""
    dialect = dialect_for("ardupilot", "fixed_wing")
    home = encode(make_plan()).mission[:1]
    assert differences((), (), dialect) == ()
    assert differences((), home, dialect) == ()
    assert differences(home, (), dialect) == ()
