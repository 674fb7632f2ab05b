"""Plans made by hand whose sensors are cameras."""

from __future__ import annotations

from dataclasses import replace

from planner.plan import LonLatAlt, Photos, Plan, PlanCamera, Trigger

CAMERA = PlanCamera("eye", 0.035, 4.5e-6, 7952, 5304, 0.75, 0.65, min_interval_s=0.7)


def with_photos(
    plan: Plan, wanted_m: float = 41.0, trigger: Trigger = "distance", collects: int | None = None
) -> Plan:
    """A plan whose first collects, all where None, are a camera's: photos evenly, at most so far apart."""
    camera = replace(CAMERA, trigger=trigger)
    count = len(plan.collects) if collects is None else collects
    made = tuple(
        replace(collect, sensor=camera.name, look="down") if number < count else collect
        for number, collect in enumerate(plan.collects)
    )
    photos = []
    for collect in made[:count]:
        length_m = collect.end_m - collect.start_m
        gaps = max(1, -int(-length_m // wanted_m))
        first, last = collect.line
        steps = [(a, b - a) for a, b in zip(first, last, strict=True)]
        places = tuple(_place([a + way * k / gaps for a, way in steps]) for k in range(gaps + 1))
        interval_s = (collect.end_s - collect.start_s) / gaps
        photos.append(Photos(collect.vehicle, collect.seq, camera.name, places, length_m / gaps, interval_s))
    return replace(plan, collects=made, photos=tuple(photos), cameras=(camera,))


def _place(parts: list[float]) -> LonLatAlt:
    lon_deg, lat_deg, altitude_m = parts
    return lon_deg, lat_deg, altitude_m
