"""What a simulator's gimbal does in flight, by the messages it sends: pymavlink reads them off the link."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

from pymavlink.dialects.v20 import ardupilotmega
from pymavlink.quaternion import Quaternion

from mavlink.wire.items import Command, MissionItem
from planner.plan import Plan
from tests.mavlink.plans import Leg, make_plan

#: GIMBAL_DEVICE_ATTITUDE_STATUS, ten times a second of the simulator's time.
STATUS, EVERY_US, SET_INTERVAL = 285, 100_000.0, 511
#: A quarter of a kilometre between passes: time to turn from side to side.
LEGS = (
    Leg(length_m=1500.0, collect_m=(500.0, 1200.0)),
    Leg(turn_deg=30.0, radius_m=150.0),
    Leg(length_m=1500.0, collect_m=(500.0, 1000.0)),
    Leg(turn_deg=-90.0, radius_m=150.0),
    Leg(length_m=1500.0, collect_m=(500.0, 1000.0)),
)


def two_sided(autopilot: str) -> Plan:
    """Three passes: two to the right, one to the left."""
    plan = make_plan(LEGS, autopilot="px4" if autopilot == "px4" else "ardupilot")
    *first, last = plan.collects
    return replace(plan, collects=(*first, replace(last, look="left")))


@dataclass(slots=True)
class Watch:
    """Pitch and yaw of the gimbal in whole degrees, by the item being flown to.

    Use ``frame`` as the client's tap.
    """

    seen: list[tuple[int, tuple[int, int]]] = field(default_factory=list)
    _current: int = 0
    _reader: ardupilotmega.MAVLink = field(default_factory=lambda: ardupilotmega.MAVLink(None))

    def __post_init__(self) -> None:
        self._reader.robust_parsing = True

    def frame(self, data: bytes) -> None:
        """Take a frame of the link."""
        for message in self._reader.parse_buffer(bytes(data)) or []:
            if message.get_type() == "MISSION_CURRENT":
                self._current = message.seq
            elif message.get_type() == "GIMBAL_DEVICE_ATTITUDE_STATUS":
                _, pitch_rad, yaw_rad = Quaternion(message.q).euler
                angles = round(math.degrees(pitch_rad)), round(math.degrees(yaw_rad))
                self.seen.append((self._current, angles))

    def on_the_way_to(self, seq: int) -> tuple[int, int] | None:
        """Where it pointed when an item was first said to be flown to: that is said late, if at all."""
        return next((angles for current, angles in self.seen if current == seq), None)

    def in_turn(self, first: tuple[int, int]) -> list[tuple[int, int]]:
        """Where it pointed, one after the other, from when it first pointed so."""
        angles = [each for _, each in self.seen]
        angles = angles[angles.index(first) :]
        return [first, *(after for before, after in pairwise(angles) if after != before)]


def ends_of_passes(items: Sequence[MissionItem], off: int) -> list[int]:
    """Numbers of the waypoints behind which the sensor goes off, by a command whose value is 0 or less."""
    value = "param1" if off == Command.DO_SET_ACTUATOR else "param2"
    return [
        before.seq
        for before, item in pairwise(items)
        if item.command == off and getattr(item, value) <= 0.0 and before.command == Command.NAV_WAYPOINT
    ]
