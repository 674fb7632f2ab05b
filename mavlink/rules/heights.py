"""What a flight needs of its vehicle's climbs, descents and returns."""

from __future__ import annotations

from dataclasses import dataclass

from mavlink.rules.wind import fastest_m_s, is_whole_turn
from planner.plan import PathSegment, Plan, PlanWind, ZoneCircle, ZonePolygon

_NOTHING_BELOW = (0.0, "")


@dataclass(frozen=True, slots=True)
class HeightNeeds:
    """Heights are over home.

    Parameters
    ----------
    climb_m_s, sink_m_s
        Fastest that the plan climbs and descends on wings, in its wind; 0 where it does not.
    turning_up_m_s, turning_down_m_s
        Of its whole turns alone, where the wind is behind for as long as it is ahead.
    wind_m_s
        That it is planned for.
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
    turning_up_m_s: float = 0.0
    turning_down_m_s: float = 0.0
    lowest_m: float = 0.0
    ground_rises: bool = False
    return_m: float | None = None
    circle_m: float | None = None
    flown_over: tuple[float, str] = _NOTHING_BELOW
    wind_m_s: float = 0.0


def heights_of(plan: Plan, name: str) -> HeightNeeds:
    """Of one vehicle's flight."""
    vehicle = next(vehicle for vehicle in plan.vehicles if vehicle.name == name)
    path = next(path for path in plan.paths if path.vehicle == name)
    home_m = plan.home_altitude_m(name, path.sortie)
    passes_m = [place[2] for collect in plan.collects_of(name) for place in collect.line]
    returns = vehicle.finish == "return" and vehicle.type != "multirotor"
    zones: list[ZonePolygon | ZoneCircle] = [*plan.fence.exclusion, *plan.fence.exclusion_circles]
    # Of several bases that at the scenario's start may be higher, or lower, than this vehicle's.
    zones_m = home_m if plan.fence.home_altitude_m is None else plan.fence.home_altitude_m
    tops = [(each.ceiling_m + zones_m - home_m, each.name) for each in zones if each.ceiling_m is not None]
    wind = PlanWind() if vehicle.type == "multirotor" else plan.wind  # what hovers gains nothing by it
    rates_m_s = [
        (_sine(s) * fastest_m_s(s, vehicle.airspeed_m_s, wind), is_whole_turn(s))
        for s in path.segments
        if s.kind != "vertical" and s.length_m > 0.0
    ]
    turns_m_s = [rate_m_s for rate_m_s, turns in rates_m_s if turns]
    return HeightNeeds(
        max(0.0, *(rate_m_s for rate_m_s, _ in rates_m_s), 0.0),
        max(0.0, *(-rate_m_s for rate_m_s, _ in rates_m_s), 0.0),
        max(0.0, *turns_m_s, 0.0),
        max(0.0, *(-rate_m_s for rate_m_s in turns_m_s), 0.0),
        min(passes_m or [max(place[2] for place in path.line)]) - home_m,
        plan.altitude_reference == "amsl",
        path.line[-1][2] - home_m if returns else None,
        path.segments[-1].radius_m if returns else None,
        max(_NOTHING_BELOW, *tops, key=lambda top: top[0]) if tops else _NOTHING_BELOW,
        wind.speed_m_s,
    )


def _sine(segment: PathSegment) -> float:
    """Of its slope, > 0 up."""
    return (segment.end_altitude_m - segment.start_altitude_m) / segment.length_m
