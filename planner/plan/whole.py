"""The plan itself."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from planner.plan.aboard import STILL_AIR, PlanCamera, PlanVehicle, PlanWind
from planner.plan.fence import Fence
from planner.plan.flown import Collect, FlownPath, Transit
from planner.plan.metrics import Metrics, Violation
from planner.plan.seen import Footprint, Photos, Uncovered
from planner.plan.words import AltitudeReference, LonLat

#: A line begins or ends at a known place if it is no further from it; and a degree of latitude in metres.
ONE_PLACE_M, DEGREE_M = 1.0, 111_000.0


@dataclass(frozen=True, slots=True)
class Plan:
    """Checked and measured; see contract role by role.

    ``home`` is where the vehicles take off (the scenario's start), ``end`` where they finish; both on the
    ground.
    """

    name: str
    vehicles: tuple[PlanVehicle, ...]
    altitude_m: float
    altitude_reference: AltitudeReference
    home: LonLat
    end: LonLat
    paths: tuple[FlownPath, ...]
    collects: tuple[Collect, ...]
    transits: tuple[Transit, ...]
    footprints: tuple[Footprint, ...]
    uncovered: tuple[Uncovered, ...]
    fence: Fence
    metrics: Metrics
    violations: tuple[Violation, ...]
    methods: dict[str, str]
    scenario_hash: str
    planner_version: str
    seed: int
    warnings: tuple[str, ...] = ()
    photos: tuple[Photos, ...] = ()
    cameras: tuple[PlanCamera, ...] = ()
    wind: PlanWind = STILL_AIR

    def path_of(self, vehicle: str, sortie: int = 1) -> FlownPath:
        """The path of one sortie of a vehicle."""
        return next(path for path in self.paths if (path.vehicle, path.sortie) == (vehicle, sortie))

    def home_altitude_m(self, vehicle: str, sortie: int = 1) -> float:
        """Altitude over the plan's datum of the home that an autopilot has on one sortie.

        Where that takes off, which over terrain is another height for each base; told besides of one that
        the plan begins with in the air.
        """
        told_m = next(each.home_altitude_m for each in self.vehicles if each.name == vehicle)
        return self.path_of(vehicle, sortie).line[0][2] if told_m is None else told_m

    def sorties_of(self, vehicle: str) -> tuple[int, ...]:
        """The numbers of a vehicle's sorties, in flight order."""
        return tuple(sorted(path.sortie for path in self.paths if path.vehicle == vehicle))

    @property
    def is_fleet(self) -> bool:
        """Whether there is more than one flight that begins with the plan."""
        return len(self.paths) > 1 or any(path.start_s > 0.0 for path in self.paths)

    def of(self, vehicle: str, sortie: int = 1) -> Plan:
        """One flight of one vehicle as a plan of its own: its home and end, its times from lift-off.

        Metrics, warnings and violations stay those of the whole.
        """
        if not self.is_fleet:
            return self
        path = self.path_of(vehicle, sortie)
        value = next(each for each in self.vehicles if each.name == vehicle)
        collects = tuple(
            replace(each, start_s=each.start_s - path.start_s, end_s=each.end_s - path.start_s)
            for each in self.collects
            if (each.vehicle, each.sortie) == (vehicle, sortie)
        )
        seqs = {each.seq for each in collects}
        phases = tuple(
            replace(each, start_s=each.start_s - path.start_s, end_s=each.end_s - path.start_s)
            for each in path.phases
        )
        home, end = value.home or self.home, value.end or self.end
        if sortie > 1:
            # It starts where the flight before has landed, which may be elsewhere.
            home = _same_or(home, path.line[0])
        if value.finish == "land":
            end = _same_or(end, path.line[-1])
        return replace(
            self,
            vehicles=(value,),
            home=home,
            end=end,
            paths=(replace(path, start_s=0.0, phases=phases),),
            collects=collects,
            transits=tuple(t for t in self.transits if (t.vehicle, t.sortie) == (vehicle, sortie)),
            footprints=tuple(f for f in self.footprints if f.vehicle == vehicle and f.seq in seqs),
            photos=tuple(p for p in self.photos if p.vehicle == vehicle and p.seq in seqs),
        )

    def collects_of(self, vehicle: str) -> tuple[Collect, ...]:
        """The collects of one vehicle in flight order."""
        return tuple(sorted((c for c in self.collects if c.vehicle == vehicle), key=lambda c: c.seq))

    def photos_of(self, vehicle: str) -> tuple[Photos, ...]:
        """The photos of one vehicle, those of each collect together, in flight order."""
        return tuple(sorted((p for p in self.photos if p.vehicle == vehicle), key=lambda p: p.seq))

    def camera(self, sensor: str) -> PlanCamera | None:
        """The camera of a name; None where that sensor is none."""
        return next((camera for camera in self.cameras if camera.name == sensor), None)

    @property
    def hard_violations(self) -> tuple[Violation, ...]:
        """Violations that forbid an upload without an explicit override."""
        return tuple(violation for violation in self.violations if violation.hard)


def _same_or(known: LonLat, place: tuple[float, float, float]) -> LonLat:
    """A known place where a line begins or ends there, else that place of the line."""
    east_deg = math.remainder(place[0] - known[0], 360.0) * math.cos(math.radians(known[1]))
    off_m = DEGREE_M * math.hypot(east_deg, place[1] - known[1])
    return known if off_m <= ONE_PLACE_M else (place[0], place[1])
