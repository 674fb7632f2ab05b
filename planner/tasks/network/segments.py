"""Values of the network: segments, what rules them out, sensors that were looked at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from planner.dubins.path import Path, Segment
from planner.errors import Finding
from planner.route import Look, Pose
from planner.sensors.worth import Worth

Line = tuple[tuple[float, float], tuple[float, float]]
State = Literal["chosen", "open", "ruled_out"]


@dataclass(frozen=True, slots=True)
class RecognitionSegment:
    """One way to see a target with one sensor: passes from an ingress to an egress point.

    Parameters
    ----------
    target
        The regions it is for, as the plan names them.
    lines
        Passes with the sensor on, in flight order: east and north, metres.
    ingress, egress
        Where the straight flight before the first pass begins, and where the last ends.
    vehicles
        Who can fly it; of a chosen one who does.
    stand_off_m
        From the target's middle to the nearest pass, over the ground.
    seen
        Part of the target that its passes see, line of sight over terrain counted; None where passes follow
        the ground.
    worth
        What its images are worth at worst.
    risk_missile, risk_radar
        Of its passes and the straight flight before each: equations 12 and 14 of Li et al. (2018).
    turns
        Whether a full turn has room at both ends.
    longer_m
        By how much, by estimate, the flight would be longer (threats, turns and wind priced) with it in the
        place of what was chosen.
    ruled_out
        Why it cannot be taken; empty where it can.
    """

    target: str
    sensor: str
    look: Look
    lines: tuple[Line, ...]
    altitude_m: float
    ingress: Pose
    egress: Pose
    vehicles: tuple[str, ...]
    stand_off_m: float
    length_m: float
    seen: float | None
    worth: Worth
    resolution_m: float | None
    risk_missile: float
    risk_radar: float
    turns: bool
    state: State
    ruled_out: tuple[Finding, ...] = ()
    longer_m: float | None = None
    sortie: int | None = None

    @property
    def angle_rad(self) -> float:
        """Flight direction of its first pass."""
        return angle_of(self.lines[0])


@dataclass(frozen=True, slots=True)
class Looked:
    """A sensor that was looked at for a target, on board of whom; why it is not good enough, if it is not."""

    target: str
    sensor: str
    vehicles: tuple[str, ...]
    asked: bool
    refused: Finding | None = None


@dataclass(frozen=True, slots=True)
class Network:
    """All segments of a plan's targets.

    ``step_rad`` is between the headings, and ``stand_offs`` how many offsets were looked at of each.
    """

    segments: tuple[RecognitionSegment, ...]
    looked: tuple[Looked, ...]
    step_rad: float
    stand_offs: int


def angle_of(line: Line) -> float:
    """Flight direction of a line."""
    (east0, north0), (east1, north1) = line
    return math.atan2(north1 - north0, east1 - east0)


def straights(lines: Sequence[Line], settle_m: float) -> list[Path]:
    """What is flown straight for passes: the settling run and the pass."""
    found = []
    for line in lines:
        angle_rad = angle_of(line)
        (east_m, north_m), _ = line
        start = Pose(
            east_m - settle_m * math.cos(angle_rad), north_m - settle_m * math.sin(angle_rad), angle_rad
        )
        found.append(Path((Segment("straight", start, math.dist(*line) + settle_m),)))
    return found
