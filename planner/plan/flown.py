"""What is flown: the line of one aircraft, its pieces and phases, its collects and the transits between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from planner.plan.words import LonLat, LonLatAlt, PhaseKind, SegmentKind


@dataclass(frozen=True, slots=True)
class PathSegment:
    """A straight, a circular arc or a climb on the spot: a piece of a path whose slope is even.

    Parameters
    ----------
    kind
        ``left`` and ``right`` are arcs; ``vertical`` is flown by what hovers.
    start, end
        Longitude, latitude in degrees.
    start_m, length_m
        Along the path, in three dimensions.
    radius_m, centre, turn_deg
        Of an arc: radius, centre, and degrees turned (> 0; more than 360 where it climbs or descends in
        circles); None for a straight.
    start_altitude_m, end_altitude_m
        Over the plan's ``altitude_reference``.
    """

    kind: SegmentKind
    start: LonLat
    end: LonLat
    start_m: float
    length_m: float
    radius_m: float | None = None
    centre: LonLat | None = None
    turn_deg: float | None = None
    start_altitude_m: float = 0.0
    end_altitude_m: float = 0.0


@dataclass(frozen=True, slots=True)
class Phase:
    """A part of a flight: where and when it begins and ends, counted along the path from lift-off."""

    kind: PhaseKind
    start_m: float
    end_m: float
    start_s: float
    end_s: float


@dataclass(frozen=True, slots=True)
class FlownPath:
    """The whole line one vehicle flies, from lift-off to landing or to the circle that its return ends in.

    ``line`` has vertices at most 10 m apart on arcs; straights need only their ends. Altitudes are over the
    plan's ``altitude_reference``; distances along it are in three dimensions. ``phases`` follow each other
    without gaps; ``take_off_heading_deg`` is where the aircraft must point at lift-off, None for what hovers.
    It lifts off ``start_s`` after the plan's start; ``sortie`` counts the flights of one aircraft from 1.
    Times of phases and collects are those of the plan's clock.
    """

    vehicle: str
    line: tuple[LonLatAlt, ...]
    segments: tuple[PathSegment, ...]
    length_m: float
    duration_s: float
    energy_wh: float | None
    min_turn_radius_m: float | None
    phases: tuple[Phase, ...] = ()
    take_off_heading_deg: float | None = None
    sortie: int = 1
    start_s: float = 0.0

    @property
    def end_s(self) -> float:
        """When it has ended, on the plan's clock."""
        return self.start_s + self.duration_s

    def phase(self, kind: PhaseKind) -> Phase | None:
        """The phase of a kind; None where the flight has none."""
        return next((phase for phase in self.phases if phase.kind == kind), None)


@dataclass(frozen=True, slots=True)
class Collect:
    """Sensor on from the first to the last point of a straight line, in flight direction.

    ``speed_m_s`` is what it is flown no faster than over the ground; None: as the vehicle flies.
    """

    vehicle: str
    seq: int
    roi: str
    regions: tuple[str, ...]
    sensor: str
    look: Literal["left", "right", "down"]
    line: tuple[LonLatAlt, LonLatAlt]
    heading_deg: float
    start_m: float
    end_m: float
    start_s: float
    end_s: float
    sortie: int = 1
    speed_m_s: float | None = None


@dataclass(frozen=True, slots=True)
class Transit:
    """The line between two collects, or from the start, or to the end.

    ``clearance_m`` is proven: the line comes no nearer to anything hard at its level; None where there is
    none.
    """

    vehicle: str
    seq: int
    from_name: str
    to_name: str
    line: tuple[LonLatAlt, ...]
    length_m: float
    risk_missile: float
    risk_radar: float
    method: str
    clearance_m: float | None = None
    sortie: int = 1
