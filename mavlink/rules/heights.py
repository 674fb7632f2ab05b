"""What a flight needs of its vehicle's climbs, descents and returns."""

from __future__ import annotations

from dataclasses import dataclass

from planner.plan import FlownPath, Plan, ZoneCircle, ZonePolygon

_NOTHING_BELOW = (0.0, "")


@dataclass(frozen=True, slots=True)
class HeightNeeds:
    """Heights are over home.

    Parameters
    ----------
    climb_m_s, sink_m_s
        Fastest that the plan climbs and descends on wings, at its airspeed; 0 where it does not.
    lowest_m
        Of its passes; of its highest place where it has none.
    ground_rises
        Whether the plan knows the ground, and stays clear of it.
    return_m, circle_m
        Height and radius of the circle that its return ends in; None where it does not return to one.
    flown_over
        Top and name of the highest hard zone that it flies over; 0 and no name without any.
    """

    climb_m_s: float = 0.0
    sink_m_s: float = 0.0
    lowest_m: float = 0.0
    ground_rises: bool = False
    return_m: float | None = None
    circle_m: float | None = None
    flown_over: tuple[float, str] = _NOTHING_BELOW


def heights_of(plan: Plan, name: str) -> HeightNeeds:
    """Of one vehicle's flight."""
    vehicle = next(vehicle for vehicle in plan.vehicles if vehicle.name == name)
    path = next(path for path in plan.paths if path.vehicle == name)
    home_m = path.line[0][2]
    passes_m = [place[2] for collect in plan.collects_of(name) for place in collect.line]
    returns = vehicle.finish == "return" and vehicle.type != "multirotor"
    zones: list[ZonePolygon | ZoneCircle] = [*plan.fence.exclusion, *plan.fence.exclusion_circles]
    return HeightNeeds(
        vehicle.airspeed_m_s * _steepest(path, 1.0),
        vehicle.airspeed_m_s * _steepest(path, -1.0),
        min(passes_m or [max(place[2] for place in path.line)]) - home_m,
        plan.altitude_reference == "amsl",
        path.line[-1][2] - home_m if returns else None,
        path.segments[-1].radius_m if returns else None,
        max(((zone.ceiling_m, zone.name) for zone in zones if zone.ceiling_m), default=_NOTHING_BELOW),
    )


def _steepest(path: FlownPath, sign: float) -> float:
    """Sine of the steepest slope up (1) or down (-1) that is not flown on the spot."""
    return max(
        0.0,
        *(
            sign * (segment.end_altitude_m - segment.start_altitude_m) / segment.length_m
            for segment in path.segments
            if segment.kind != "vertical" and segment.length_m > 0.0
        ),
    )
