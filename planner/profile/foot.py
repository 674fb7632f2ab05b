"""How a flight leaves the ground, or, flown backwards, comes to it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from planner.route import Anchor

Point = tuple[float, float]

#: Headings of a take-off or an approach that are tried beside the way the line goes.
HEADINGS = 24


@dataclass(frozen=True, slots=True)
class Foot:
    """One end of a flight on the ground.

    Parameters
    ----------
    position
        East and north in metres.
    angle_rad
        Direction flown there, away from the ground; None for any.
    ground_m
        Altitude of the ground over the flight's datum.
    lift_m
        Flown straight up first: all of it by multirotors, the hover of a VTOL, nothing by other wings.
    run_m, run_rise_m
        Flown straight ahead then, and how much of the height is won meanwhile.
    into_rad
        Direction the wind comes from, where a take-off or landing with the wind behind is to be avoided.
    likely_rad
        Direction of the run behind which the line would be shortest if there were no zones.
    slow_behind
        Part of the wind that may be from behind where no other way leads: that is still slow.
    behind
        Part of the wind that may be from behind.
    """

    position: Point
    angle_rad: float | None
    ground_m: float
    lift_m: float = 0.0
    run_m: float = 0.0
    run_rise_m: float = 0.0
    into_rad: float | None = None
    likely_rad: float | None = None
    slow_behind: float = 0.0
    behind: float = 0.0

    @property
    def altitude_m(self) -> float:
        """At the end of the run."""
        return self.ground_m + self.lift_m + self.run_rise_m

    def headings(self, natural_rad: float) -> list[float | None]:
        """Directions to try: the given one, else the natural one first and others round the compass.

        With wind those alone that do not have it from behind. Where nothing is flown straight any direction
        does, and the line chooses.
        """
        if self.angle_rad is not None:
            return [self.angle_rad]
        if self.run_m <= 0.0:
            return [None]
        every = [natural_rad + k * math.tau / HEADINGS for k in range(HEADINGS)]
        into_rad = self.into_rad
        every += [angle for angle in (into_rad, self.likely_rad) if angle is not None]
        if into_rad is not None and self.behind > 0.0:
            farthest_rad = math.pi / 2.0 + math.asin(self.behind)
            every += [into_rad + farthest_rad, into_rad - farthest_rad]
        return [h for h in every if self.allows(h)]

    def allows(self, angle_rad: float) -> bool:
        """Whether a direction does not have the wind from behind, where that is to be avoided."""
        return self.into_rad is None or math.cos(angle_rad - self.into_rad) >= -self.behind - 1e-9

    def with_wind_behind(self) -> Foot | None:
        """The same with as much wind from behind as is still slow; None where that is no more."""
        if self.into_rad is None or self.slow_behind <= self.behind:
            return None
        return replace(self, behind=self.slow_behind)

    def run_end(self, angle_rad: float | None) -> Anchor:
        """Where the run ends, and the direction there."""
        if angle_rad is None:
            return Anchor(*self.position, None)
        return Anchor(
            self.position[0] + self.run_m * math.cos(angle_rad),
            self.position[1] + self.run_m * math.sin(angle_rad),
            angle_rad,
        )
