"""Plans of single flights put together to one plan on one clock."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from planner.plan import (
    Collect,
    Fence,
    Footprint,
    Metrics,
    Photos,
    Plan,
    PlanVehicle,
    Transit,
    VehicleMetrics,
)


@dataclass(frozen=True, slots=True)
class Part:
    """The plan of one flight, when it lifts off, and which of its vehicle's flights it is."""

    plan: Plan
    start_s: float
    sortie: int

    @property
    def vehicle(self) -> str:
        """Whose flight it is."""
        return self.plan.vehicles[0].name


def together(parts: Sequence[Part], fence: Fence, altitude_m: float, priorities: dict[str, float]) -> Plan:
    """One plan of several flights, numbered through for each vehicle; not yet judged.

    Parameters
    ----------
    parts
        By vehicle, in flight order.
    fence
        Round all of them.
    altitude_m
        Of the whole.
    priorities
        Of each region.
    """
    first = parts[0].plan
    collects: list[Collect] = []
    transits: list[Transit] = []
    footprints: list[Footprint] = []
    photos: list[Photos] = []
    counts: dict[str, tuple[int, int]] = {}
    for part in parts:
        own = part.plan
        seq, leg = counts.get(part.vehicle, (0, 0))
        collects += [
            replace(
                each,
                seq=each.seq + seq,
                sortie=part.sortie,
                start_s=each.start_s + part.start_s,
                end_s=each.end_s + part.start_s,
            )
            for each in own.collects
        ]
        transits += [replace(each, seq=each.seq + leg, sortie=part.sortie) for each in own.transits]
        footprints += [replace(each, seq=each.seq + seq) for each in own.footprints]
        photos += [replace(each, seq=each.seq + seq) for each in own.photos]
        counts[part.vehicle] = (seq + len(own.collects), leg + len(own.transits))
    paths = tuple(
        replace(
            path,
            sortie=part.sortie,
            start_s=part.start_s,
            phases=tuple(
                replace(phase, start_s=phase.start_s + part.start_s, end_s=phase.end_s + part.start_s)
                for phase in path.phases
            ),
        )
        for part in parts
        for path in part.plan.paths
    )
    warnings = tuple(dict.fromkeys(warning for part in parts for warning in part.plan.warnings))
    cameras = {camera.name: camera for part in parts for camera in part.plan.cameras}
    whole = replace(
        first,
        vehicles=_vehicles(parts),
        altitude_m=altitude_m,
        paths=paths,
        collects=tuple(collects),
        transits=tuple(transits),
        footprints=tuple(footprints),
        photos=tuple(photos),
        fence=fence,
        warnings=warnings,
        cameras=tuple(cameras.values()),
    )
    return replace(whole, metrics=_metrics(parts, priorities))


def _vehicles(parts: Iterable[Part]) -> tuple[PlanVehicle, ...]:
    """One value for each vehicle, with its own home and end."""
    found: dict[str, PlanVehicle] = {}
    for part in parts:
        value = replace(part.plan.vehicles[0], home=part.plan.home, end=part.plan.end)
        first = found.setdefault(part.vehicle, value)
        # It starts where its first flight does, and ends where its last does.
        found[part.vehicle] = replace(first, end=value.end)
    return tuple(found.values())


def _metrics(parts: Sequence[Part], priorities: dict[str, float]) -> Metrics:
    each = [part.plan.metrics for part in parts]
    length_m = math.fsum(m.length_m for m in each)
    collection_m = math.fsum(m.collection_length_m for m in each)
    vehicles = {name: _of_vehicle(own, priorities, parts) for name, own in _by_vehicle(parts).items()}
    return Metrics(
        length_m=length_m,
        collection_length_m=collection_m,
        duty_cycle=collection_m / length_m,
        path_length_ratio=None,
        risk_missile=math.fsum(m.risk_missile for m in each),
        risk_radar=math.fsum(m.risk_radar for m in each),
        turns=sum(m.turns for m in each),
        duration_s=math.fsum(m.duration_s for m in each),
        energy_wh=_sum(m.energy_wh for m in each),
        coverage={},
        planning_time_s={},
        flight_length_m=_sum(m.flight_length_m for m in each),
        flight_duration_s=_sum(m.flight_duration_s for m in each),
        route_length_m=_sum(m.route_length_m for m in each),
        photos=None if all(m.photos is None for m in each) else sum(m.photos or 0 for m in each),
        photos_mb=None
        if all(m.photos_mb is None for m in each)
        else math.fsum(m.photos_mb or 0.0 for m in each),
        vehicles=vehicles,
        last_landing_s=max(one.landing_s for one in vehicles.values()),
    )


def _by_vehicle(parts: Iterable[Part]) -> dict[str, list[Part]]:
    found: dict[str, list[Part]] = {}
    for part in parts:
        found.setdefault(part.vehicle, []).append(part)
    return found


def _of_vehicle(own: Sequence[Part], priorities: dict[str, float], parts: Sequence[Part]) -> VehicleMetrics:
    """Of a region that several vehicles see each counts by its part of the passes."""
    passes: dict[str, int] = {}
    for part in parts:
        for collect in part.plan.collects:
            for name in collect.regions:
                passes[name] = passes.get(name, 0) + 1
    priority = math.fsum(
        priorities.get(name, 0.0) / passes[name]
        for part in own
        for collect in part.plan.collects
        for name in collect.regions
    )
    paths = [(part, path) for part in own for path in part.plan.paths]
    return VehicleMetrics(
        math.fsum(path.length_m for _, path in paths),
        math.fsum(path.duration_s for _, path in paths),
        _sum(path.energy_wh for _, path in paths),
        round(priority, 6),
        len(own),
        min(part.start_s for part in own),
        max(part.start_s + path.duration_s for part, path in paths),
    )


def _sum(values: Iterable[float | None]) -> float | None:
    """The sum; None where one is not known."""
    listed = list(values)
    known = [value for value in listed if value is not None]
    return math.fsum(known) if len(known) == len(listed) else None
